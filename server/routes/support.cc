#include "server/routes/support.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "engine/admission/mesh_reader.h"
#include "server/codec/input_json.h"
#include "server/http/multipart.h"
#include "server/ids.h"

namespace graspdb {
namespace {

constexpr std::chrono::seconds kLongestWait{600};
constexpr char kReplayed[] = "Idempotent-Replayed";

/** The items between separators, without blanks around them. */
std::vector<std::string_view> Split(std::string_view text,
                                    std::string_view separators) {
  std::vector<std::string_view> items;
  while (!text.empty()) {
    const size_t end = std::min(text.find_first_of(separators), text.size());
    std::string_view item = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (item.starts_with(' ')) item.remove_prefix(1);
    while (item.ends_with(' ')) item.remove_suffix(1);
    if (!item.empty()) items.push_back(item);
  }
  return items;
}

/** What a second request must have in common with the first under a key. */
std::string CalcRequestSha256(const HttpRequest& request) {
  std::string content = request.method + '\0' + request.path;
  for (const auto& [name, value] : request.query) {
    content += '\0' + name + '\0' + value;
  }
  content += '\0' + CalcSha256(request.body);
  for (const FormPart& file : request.files) {
    content += '\0' + file.name + '\0' + file.filename + '\0' +
               CalcSha256(file.content);
  }
  return CalcSha256(content);
}

// The content of the form's file of that name, or null.
const std::string* FindFile(const HttpRequest& request,
                            const std::string& name) {
  for (const FormPart& file : request.files) {
    if (file.name == name) return &file.content;
  }
  return nullptr;
}

}  // namespace

HttpResponse MakeJsonResponse(int status, std::string json) {
  HttpResponse response;
  response.status = status;
  response.body = std::move(json);
  if (!response.body.ends_with('\n')) response.body += '\n';
  return response;
}

HttpResponse MakeFileResponse(std::string bytes, const std::string& name,
                              const std::string& format) {
  HttpResponse response;
  response.content_type = format == "obj"   ? "model/obj"
                          : format == "stl" ? "model/stl"
                          : format == "glb" ? "model/gltf-binary"
                                            : "application/octet-stream";
  response.headers.emplace_back(
      "Content-Disposition",
      fmt::format("attachment; filename=\"{}.{}\"", name, format));
  response.body = std::move(bytes);
  return response;
}

Error MakeMissingMesh() {
  return {ErrorCode::kInvalidArgument, "There is no mesh in the request.",
          "Send it as the body (curl --data-binary @FILE) or as the form's "
          "part mesh (curl -F mesh=@FILE).",
          "mesh"};
}

std::string BodyOrEmptyObject(const HttpRequest& request) {
  return request.body.empty() ? "{}" : request.body;
}

Result<HttpResponse> DescribeObject(const Service& service, int status,
                                    const std::string& id) {
  GRASPDB_TRY(object, service.store().FindObject(id));
  GRASPDB_TRY(parts, service.store().ListParts(id));
  return MakeJsonResponse(status, ToJson(object, parts));
}

PageRequest ReadPage(QueryReader& query) {
  PageRequest page;
  page.limit = static_cast<int>(query.Integer("limit", 1, 1000).value_or(100));
  page.cursor = query.Text("cursor").value_or("");
  return page;
}

std::optional<double> ReadDeadline(QueryReader& query) {
  constexpr double kDay = 86400.0;
  return query.Number("deadline", 0.1, kDay);
}

uint64_t ReadSeed(QueryReader& query) {
  return static_cast<uint64_t>(query.Integer("seed", 0).value_or(1));
}

std::vector<std::string> ReadList(QueryReader& query, const std::string& name) {
  std::vector<std::string> list;
  const std::string text = query.Text(name).value_or("");
  for (const std::string_view item : Split(text, ",")) list.emplace_back(item);
  return list;
}

Result<std::optional<ImportOrder>> ReadUpload(
    const HttpRequest& request, QueryReader& query,
    const std::vector<std::string>& others) {
  ImportOrder order;
  order.format = query
                     .Choice("format", {"obj", "stl", "ply", "off", "glb",
                                        "gltf", "dae", "pcd", "xyz"})
                     .value_or("");
  order.units = query.Choice("units", {"m", "mm", "cm", "in"}).value_or("");
  std::string type;
  bool found = !request.body.empty();
  if (found) {
    order.bytes = request.body;
    type = request.FindHeader("content-type");
    order.file_name = FindFieldParameter(
        request.FindHeader("content-disposition"), "filename");
  }
  for (const FormPart& file : request.files) {
    if (file.name == "mesh" && !found) {
      order.bytes = file.content;
      order.file_name = file.filename;
      type = file.content_type;
      found = true;
    } else if (file.name == "mesh" || std::find(others.begin(), others.end(),
                                                file.name) == others.end()) {
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("The form has an unexpected file \"{}\".",
                               file.name.substr(0, 64)),
                   "Send one file, as the form's part mesh.", "mesh"};
    }
  }
  if (!found) return std::optional<ImportOrder>();
  if (order.format.empty() && ParseMeshFormat(type)) order.format = type;
  return std::optional<ImportOrder>(std::move(order));
}

Result<std::shared_ptr<void>> TakeToParse(size_t bytes, WorkSlots& slots,
                                          const HttpRequest& request) {
  constexpr size_t kFew = 64 << 10;
  if (bytes <= kFew) return std::shared_ptr<void>();
  return slots.Take(request.stop);
}

Result<std::vector<std::string>> ReadLabels(const HttpRequest& request,
                                            WorkSlots& slots) {
  const std::string* const file = FindFile(request, "labels");
  if (file == nullptr) return std::vector<std::string>();
  const auto slot = TakeToParse(file->size(), slots, request);
  if (!slot) return slot.error();
  return FaceLabelsFromJson(*file);
}

std::chrono::seconds ReadPreferredWait(const HttpRequest& request,
                                       std::chrono::seconds otherwise) {
  const std::string prefer(request.FindHeader("prefer"));
  std::optional<int64_t> wait;
  bool asynchronous = false;
  for (const std::string_view item : Split(prefer, ",;")) {
    if (item == "respond-async") asynchronous = true;
    if (!item.starts_with("wait=")) continue;
    int64_t seconds = 0;
    const char* end = item.data() + item.size();
    const auto [stop, error] = std::from_chars(item.data() + 5, end, seconds);
    if (error == std::errc() && stop == end && seconds >= 0) wait = seconds;
  }
  if (wait) return std::min(std::chrono::seconds(*wait), kLongestWait);
  return asynchronous ? std::chrono::seconds(0) : otherwise;
}

Result<Idempotency> Idempotency::Read(const HttpRequest& request,
                                      Service& service) {
  Idempotency read;
  Store& store = service.store();
  read.store_ = &store;
  read.key_ = request.FindHeader("idempotency-key");
  if (!request.headers.contains("idempotency-key")) return read;
  if (read.key_.empty() || read.key_.size() > 255) {
    return Error{ErrorCode::kInvalidArgument,
                 "Idempotency-Key takes 1 to 255 bytes.", "",
                 "Idempotency-Key"};
  }
  read.request_sha256_ = CalcRequestSha256(request);
  GRASPDB_TRY(hold, service.HoldKey(read.key_));
  read.hold_ = std::move(hold);
  GRASPDB_TRY(reply, store.FindReply(read.key_));
  if (!reply) return read;
  if (reply->request_sha256 != read.request_sha256_) {
    return Error{ErrorCode::kKeyReused,
                 "The Idempotency-Key was used for another request.",
                 "Use a new key for each request, the same for its retries.",
                 "Idempotency-Key"};
  }
  HttpResponse earlier;
  earlier.status = reply->status;
  earlier.headers = reply->headers;
  earlier.headers.emplace_back(kReplayed, "true");
  earlier.body = reply->body;
  read.earlier_ = std::move(earlier);
  return read;
}

Result<void> Idempotency::Keep(const HttpResponse& response) {
  const std::shared_ptr<void> hold = std::move(hold_);
  if (key_.empty() || earlier_) return {};
  return store_->InsertReply({key_, request_sha256_, response.status,
                              response.headers, response.body});
}

Result<void> CheckPartLabels(const Store& store, const std::string& category,
                             const std::vector<std::string>& labels) {
  if (labels.empty()) return {};
  std::set<std::string> known;
  const auto add = [&known](const StoredCategory& stored) {
    for (const CategoryPart& part : stored.parts) known.insert(part.label);
  };
  if (!category.empty()) {
    GRASPDB_TRY(stored, store.FindCategory(category));
    add(stored);
  } else {
    PageRequest page{1000, ""};
    do {
      GRASPDB_TRY(categories, store.ListCategories(page));
      for (const StoredCategory& stored : categories.items) add(stored);
      page.cursor = categories.next_cursor;
    } while (!page.cursor.empty());
  }
  for (const std::string& label : labels) {
    if (known.contains(label)) continue;
    return Error{
        ErrorCode::kNotFound,
        category.empty()
            ? fmt::format("No category has a part {}.", label)
            : fmt::format("The category {} has no part {}.", category, label),
        fmt::format("Known are {}.", fmt::join(known, ", ")), "part"};
  }
  return {};
}

Result<HttpResponse> AnswerOnce(
    const HttpRequest& request, Service& service,
    const std::function<Result<HttpResponse>()>& handler) {
  GRASPDB_TRY(idempotency, Idempotency::Read(request, service));
  if (idempotency.earlier()) return *idempotency.earlier();
  GRASPDB_TRY(response, handler());
  GRASPDB_TRY_VOID(idempotency.Keep(response));
  return std::move(response);
}

Result<HttpResponse> AnswerJob(
    const Service& service, WorkSlots& held_threads, const HttpRequest& request,
    std::chrono::seconds otherwise, const StoredJob& submitted,
    Idempotency& idempotency,
    const std::function<Result<HttpResponse>(const StoredJob&)>& answer) {
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kStep{200};
  HttpResponse accepted = MakeJsonResponse(202, "");
  accepted.headers = {{"Location", "/v1/jobs/" + submitted.id}};
  GRASPDB_TRY_VOID(idempotency.Keep(accepted));
  const auto deadline =
      steady_clock::now() + ReadPreferredWait(request, otherwise);
  StoredJob job = submitted;
  const auto may_wait = held_threads.Take(request.stop);
  while (may_wait && !job.Finished() && steady_clock::now() < deadline &&
         !request.stop.stop_requested()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(
        deadline - steady_clock::now());
    GRASPDB_TRY(now, service.WaitForJob(job.id, std::min(left, kStep)));
    job = std::move(now);
  }
  if (job.state == JobState::kSucceeded) return answer(job);
  if (job.state == JobState::kCancelled) {
    return Error{ErrorCode::kCancelled,
                 fmt::format("The job {} was cancelled.", job.id),
                 "Send the request again."};
  }
  if (job.state == JobState::kFailed) {
    return job.error.value_or(
        Error{ErrorCode::kInternal, "A job failed without an error.", ""});
  }
  accepted.body = ToJson(job) + "\n";
  return accepted;
}

}  // namespace graspdb
