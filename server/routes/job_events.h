#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "server/jobs/service.h"

namespace graspdb {

/** A job's life as server-sent events: `job`, the job whenever it has changed,
 and `grasp`, each grasp that a transfer finds. An event's id says how far a
 client has come, for the header field Last-Event-ID. A grasp may come twice, of
 the same id, when a client returns after the job has ended or begun anew. */
class JobEvents {
 public:
  /** @param last_event_id  What the client got before; empty: nothing.
   @param stop  Ends the events early. The service outlives this. */
  JobEvents(const Service& service, StoredJob job,
            const std::string& last_event_id, std::stop_token stop);

  /** The next events as text, as soon as there is something new, or a comment
   once in a while; nothing when the job has ended and all was told. */
  std::optional<std::string> Next();

 private:
  using Clock = std::chrono::steady_clock;

  // What there is to tell about the job as it now is.
  std::string Describe(const StoredJob& job);
  std::string DescribeFoundGrasps(const StoredJob& job);
  std::string DescribeStoredGrasps(const StoredJob& job);
  std::string WriteEvent(const std::string& event,
                         const std::string& data) const;

  const Service& service_;
  StoredJob job_;
  const std::stop_token stop_;
  std::string run_;  // When this attempt at the job began …
  size_t told_{0};   // … and how many of its grasps the client has.
  // What it got here of each grasp, by id: one may be improved.
  std::map<std::string, std::string> sent_;
  bool first_{true};
  bool ended_{false};
  Clock::time_point last_{};
};

}  // namespace graspdb
