#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "engine/admission/mesh_format.h"
#include "engine/admission/text_scanner.h"
#include "server/cli/backend.h"
#include "server/codec/json.h"
#include "server/codec/parameters_json.h"
#include "server/http/target.h"

// Last: the system headers that it includes define _res, a name of Eigen's.
#include <httplib.h>

namespace graspdb {
namespace {

constexpr JsonLimits kAnswerLimits{256 << 20, 64, 20'000'000};
constexpr std::chrono::milliseconds kPoll{300};
constexpr std::chrono::seconds kReadTimeout{660};
constexpr double kLongestDeadline = 500.0;  // s; a server waits 600 at most.

struct Reply {
  int status{0};
  std::string location;
  std::string body;
};

// "?a=b&c=d" from what is not empty.
class QueryText {
 public:
  QueryText& Add(const std::string& name, const std::string& value) {
    if (value.empty()) return *this;
    text_ += (text_.empty() ? "?" : "&") + name + "=" + EncodePercent(value);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string FormatOf(const ImportOrder& order) {
  if (!order.format.empty()) return order.format;
  const auto guess =
      GuessMeshFormat({reinterpret_cast<const uint8_t*>(order.bytes.data()),
                       order.bytes.size()},
                      order.file_name);
  return guess ? ToLower(GetName(*guess)) : "";
}

class RemoteBackend : public Backend {
 public:
  explicit RemoteBackend(const std::string& url) : url_(url), client_(url) {
    client_.set_read_timeout(kReadTimeout);
    client_.set_keep_alive(true);
    client_.set_tcp_nodelay(true);
  }

  Result<std::string> Grasp(const TransferOrder& order,
                            std::optional<double> deadline,
                            Progress& progress) override {
    QueryText query;
    query.Add("category", order.category)
        .Add("object", order.object_id)
        .Add("part", fmt::format("{}", fmt::join(order.part_labels, ",")))
        .Add("task", order.task)
        .Add("hand", order.hand)
        .Add("count", order.count ? std::to_string(*order.count) : "")
        .Add("exhaustive", order.exhaustive ? "true" : "")
        .Add("sources", std::to_string(order.sources))
        .Add("stage", ToString(order.stage))
        .Add("seed", std::to_string(order.seed))
        .Add("parameters", DescribeChanges(order.parameters))
        .Add("deadline", deadline ? fmt::format("{}", *deadline) : "");
    if (order.object_id.empty()) {
      query.Add("format", FormatOf(order.mesh)).Add("units", order.mesh.units);
    }
    const std::string target = "/v1/grasps" + query.text();
    if (deadline) {  // What is cut is not found again: wait for it.
      if (*deadline > kLongestDeadline) {
        return Error{ErrorCode::kInvalidArgument,
                     "With --server a deadline is at most 500 s.", "",
                     "deadline"};
      }
      progress.Report("the server searches", 0.0);
      GRASPDB_TRY(reply, Post(target, order.mesh.bytes, "wait=600"));
      if (reply.status != 202) return reply.body;
      return Error{ErrorCode::kDeadlineExceeded, "The server is still at it.",
                   "GET /v1/jobs"};
    }
    GRASPDB_TRY(reply, Post(target, order.mesh.bytes, "respond-async"));
    if (reply.status != 202) return reply.body;
    GRASPDB_TRY_VOID(Follow(reply, progress));
    // What it made is stored: the same request is answered from there.
    GRASPDB_TRY(answer, Post(target, order.mesh.bytes, "wait=60"));
    return answer.body;
  }

  Result<std::string> Query(const GraspSearch& search) override {
    const GraspQuery& wanted = search.query;
    using Sort = GraspQuery::Sort;
    const char* sort = wanted.sort == Sort::kEpsilon  ? "epsilon"
                       : wanted.sort == Sort::kHybrid ? "hybrid"
                       : wanted.sort == Sort::kRobust ? "robust"
                       : wanted.sort == Sort::kMerit  ? "merit"
                                                      : "newest";
    QueryText query;
    query.Add("category", wanted.category)
        .Add("part", fmt::format("{}", fmt::join(wanted.part_labels, ",")))
        .Add("task", search.task)
        .Add("hand", wanted.hand)
        .Add("object", wanted.object_id)
        .Add("stage", wanted.stage ? ToString(*wanted.stage) : "")
        .Add("min_epsilon",
             wanted.min_epsilon ? fmt::format("{}", *wanted.min_epsilon) : "")
        .Add("sort", sort)
        .Add("limit", std::to_string(wanted.page.limit))
        .Add("cursor", wanted.page.cursor);
    GRASPDB_TRY(reply, Get("/v1/grasps" + query.text()));
    return reply.body;
  }

  Result<std::string> Segment(const ImportOrder& order, Progress&) override {
    QueryText query;
    query.Add("category", order.category)
        .Add("format", FormatOf(order))
        .Add("units", order.units);
    GRASPDB_TRY(reply, Post("/v1/objects" + query.text(), order.bytes, ""));
    return reply.body;
  }

  Result<std::string> Learn(const LearnOrder& order,
                            Progress& progress) override {
    const std::string object = EncodePercent(order.object_id);
    Json body;
    if (!order.part_labels.empty()) body["parts"] = order.part_labels;
    if (!order.hands.empty()) body["hands"] = order.hands;
    body["parameters"] = Json::parse(ParametersToJson(order.parameters));
    body["seed"] = order.seed;
    GRASPDB_TRY(reply,
                Post("/v1/objects/" + object + "/grasp-spaces", DumpJson(body),
                     "respond-async", "application/json"));
    if (reply.status == 202) {
      GRASPDB_TRY_VOID(Follow(reply, progress));
    }
    GRASPDB_TRY(spaces, Get("/v1/grasp-spaces?limit=1000&object=" + object));
    return spaces.body;
  }

  Result<std::string> Render(const RenderOrder& order) override {
    if (order.grasp_id.empty()) {
      return Error{ErrorCode::kNotImplemented,
                   "A server draws single grasps only.",
                   "use --grasp, or --db with the database file"};
    }
    GRASPDB_TRY(reply, Get(fmt::format("/v1/grasps/{}.png?width={}&height={}",
                                       EncodePercent(order.grasp_id),
                                       order.width, order.height)));
    return reply.body;
  }

 private:
  // The parameters that differ from the defaults, as JSON; empty when none do.
  static std::string DescribeChanges(const Parameters& parameters) {
    const Json defaults = Json::parse(ParametersToJson(Parameters()));
    const Json given = Json::parse(ParametersToJson(parameters));
    Json changes = Json::object();
    for (const auto& [section, fields] : given.items()) {
      for (const auto& [name, value] : fields.items()) {
        if (value != defaults[section][name]) changes[section][name] = value;
      }
    }
    return changes.empty() ? "" : DumpJson(changes);
  }

  Result<Reply> Get(const std::string& target) {
    return Check(client_.Get(target));
  }

  Result<Reply> Post(const std::string& target, const std::string& body,
                     const std::string& prefer,
                     const char* type = "application/octet-stream") {
    httplib::Headers headers;
    if (!prefer.empty()) headers.emplace("Prefer", prefer);
    return Check(client_.Post(target, headers, body, type));
  }

  // A reply that says what went wrong becomes the error it tells of.
  Result<Reply> Check(const httplib::Result& result) {
    if (!result) {
      return Error{ErrorCode::kNotFound,
                   url_ + " does not answer: " +
                       httplib::to_string(result.error()) + ".",
                   "start it with graspdb serve"};
    }
    if (result->status < 400) {
      return Reply{result->status, result->get_header_value("Location"),
                   result->body};
    }
    Error error{ErrorCode::kInternal,
                fmt::format("{} answered {}.", url_, result->status)};
    if (const auto problem = ParseJson(result->body); problem) {
      JsonFields fields(*problem, "");
      std::string code;
      fields.Read("code", code);
      fields.Read("detail", error.message);
      fields.Read("hint", error.hint);
      fields.Read("field", error.field);
      if (const auto known = ParseErrorCode(code)) error.code = *known;
    }
    return error;
  }

  // Polls a job until it has ended.
  Result<void> Follow(const Reply& accepted, Progress& progress) {
    while (true) {
      GRASPDB_TRY(reply, Get(accepted.location));
      GRASPDB_TRY(job, ParseJson(reply.body, kAnswerLimits));
      JsonFields fields(job, "job");
      std::string state;
      std::string stage;
      double share = 0.0;
      fields.Read("state", state);
      fields.Read("stage", stage);
      fields.Read("progress", share);
      progress.Report(stage.empty() ? state : stage, share);
      if (state == "succeeded") return {};
      if (state == "failed" || state == "cancelled") {
        return ReadJobError(job, state);
      }
      std::this_thread::sleep_for(kPoll);
    }
  }

  static Error ReadJobError(const Json& job, const std::string& state) {
    Error error{ErrorCode::kCancelled, "The job was " + state + "."};
    if (!job.contains("error") || !job["error"].is_object()) return error;
    JsonFields fields(job["error"], "error");
    std::string code;
    fields.Read("code", code);
    fields.Read("detail", error.message);
    if (!job["error"]["hint"].is_null()) fields.Read("hint", error.hint);
    if (const auto known = ParseErrorCode(code)) error.code = *known;
    return error;
  }

  std::string url_;
  httplib::Client client_;
};

}  // namespace

Result<std::unique_ptr<Backend>> MakeRemoteBackend(const std::string& url) {
  const bool sound = (url.starts_with("http://") && url.size() > 7) ||
                     (url.starts_with("https://") && url.size() > 8);
  if (!sound) {
    return Error{ErrorCode::kInvalidArgument,
                 "'" + url + "' is not the URL of a server.",
                 "such as http://localhost:8080", "server"};
  }
  return std::unique_ptr<Backend>(std::make_unique<RemoteBackend>(url));
}

}  // namespace graspdb
