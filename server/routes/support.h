#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/codec/record_json.h"
#include "server/http/message.h"
#include "server/http/query.h"
#include "server/http/router.h"
#include "server/jobs/service.h"
#include "server/routes/work_slots.h"

/** @file
 What several routes share. */

namespace graspdb {

HttpResponse MakeJsonResponse(int status, std::string json);

/** A mesh file to keep under `name`.`format`. */
HttpResponse MakeFileResponse(std::string bytes, const std::string& name,
                              const std::string& format);

/** 400 for an upload without a mesh. */
Error MakeMissingMesh();

/** The JSON body, {} when there is none. */
std::string BodyOrEmptyObject(const HttpRequest& request);

/** The form's file "labels", or nothing: see FaceLabelsFromJson(). A large one
 waits for a slot, since its JSON takes much memory.
 @retval kOverloaded as WorkSlots::Take(). */
Result<std::vector<std::string>> ReadLabels(const HttpRequest& request,
                                            WorkSlots& slots);

/** A slot to read so many bytes of JSON with; null where they are few.
 @retval kOverloaded as WorkSlots::Take(). */
Result<std::shared_ptr<void>> TakeToParse(size_t bytes, WorkSlots& slots,
                                          const HttpRequest& request);

/** The object with its parts. */
Result<HttpResponse> DescribeObject(const Service& service, int status,
                                    const std::string& id);

/** The parameters limit (1..1000, default 100) and cursor. */
PageRequest ReadPage(QueryReader& query);

/** The parameter seed, 1 when absent. */
uint64_t ReadSeed(QueryReader& query);

/** The parameter deadline, s, of what becomes a job. */
std::optional<double> ReadDeadline(QueryReader& query);

/** A comma-separated list without empty items; empty when absent. */
std::vector<std::string> ReadList(QueryReader& query, const std::string& name);

/** A page of records as a JSON list; encode() makes a Result<std::string>. */
template <class T, class Encode>
Result<HttpResponse> MakeListResponse(const Page<T>& page, Encode&& encode) {
  std::vector<std::string> items;
  for (const T& item : page.items) {
    GRASPDB_TRY(text, Result<std::string>(encode(item)));
    items.push_back(std::move(text));
  }
  return MakeJsonResponse(200, ListToJson(items, page.next_cursor));
}

/** The mesh that a request uploads, raw or as the form's part "mesh", with the
 parameters format and units; all else is the caller's.
 Nothing when the request has no body.
 @retval kInvalidArgument for a form with other files than "mesh" and those
   named in `others`. */
Result<std::optional<ImportOrder>> ReadUpload(
    const HttpRequest& request, QueryReader& query,
    const std::vector<std::string>& others = {});

/** How long a client wants to wait for a job: RFC 7240's Prefer, wait=N (at
 most 600 s) and respond-async; unknown preferences are ignored. */
std::chrono::seconds ReadPreferredWait(const HttpRequest& request,
                                       std::chrono::seconds otherwise);

/** The Idempotency-Key of a POST and what was answered under it before. */
class Idempotency {
 public:
  /** Holds the key until Keep() or the end.
   @retval kInvalidArgument when the key is malformed.
   @retval kKeyReused when it was used for another request.
   @retval kConflict while the first request is being answered. */
  static Result<Idempotency> Read(const HttpRequest& request, Service& service);

  /** Empty when the request has none. */
  const std::string& key() const { return key_; }
  const std::optional<HttpResponse>& earlier() const { return earlier_; }
  /** Remembers the answer. */
  Result<void> Keep(const HttpResponse& response);

 private:
  Store* store_{nullptr};
  std::shared_ptr<void> hold_;
  std::string key_;
  std::string request_sha256_;
  std::optional<HttpResponse> earlier_;
};

/** Keeps a submitted job under its Idempotency-Key, then waits for it for as
 long as the client wants, or until the server stops; not at all when as many
 wait as may.
 @param answer  Makes the answer of a job that succeeded.
 @returns 202 with the job and its Location when it is not done by then.
 @retval The job's error when it failed; kCancelled. */
Result<HttpResponse> AnswerJob(
    const Service& service, WorkSlots& held_threads, const HttpRequest& request,
    std::chrono::seconds otherwise, const StoredJob& submitted,
    Idempotency& idempotency,
    const std::function<Result<HttpResponse>(const StoredJob&)>& answer);

/** Refuses labels that the category, or without one any category, has not.
 @retval kNotFound naming the known ones. */
Result<void> CheckPartLabels(const Store& store, const std::string& category,
                             const std::vector<std::string>& labels);

/** Runs `handler`, unless its answer to the same request under the same
 Idempotency-Key is known: then that. Answers of failures are not kept. */
Result<HttpResponse> AnswerOnce(
    const HttpRequest& request, Service& service,
    const std::function<Result<HttpResponse>()>& handler);

/** An execution that ends when the server stops. */
class RequestContext {
 public:
  explicit RequestContext(const HttpRequest& request)
      : cancel_(request.stop, Cancel{&context_}) {}
  ExecutionContext& context() { return context_; }

 private:
  struct Cancel {
    ExecutionContext* context;
    void operator()() const { context->Cancel(); }
  };
  ExecutionContext context_;
  std::stop_callback<Cancel> cancel_;
};

}  // namespace graspdb
