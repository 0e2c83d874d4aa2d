#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace graspdb {

/** What a client may send and how slowly. */
struct HttpLimits {
  size_t max_head_bytes{32 * 1024};  ///< Request line and header fields.
  size_t max_request_line_bytes{8000};
  size_t max_field_bytes{8000};  ///< One header field.
  size_t max_fields{100};
  size_t max_json_bytes{4 << 20};      ///< Body of a JSON operation.
  int64_t max_upload_bytes{64 << 20};  ///< A file, or a whole form.
  /** Of all bodies that are there at once, but for the first 64 KiB of each; at
   least two of the largest. */
  size_t max_held_bytes{128 << 20};
  size_t max_form_parts{32};
  size_t max_form_head_bytes{8192};   ///< The header fields of a form part.
  size_t max_form_field_bytes{4096};  ///< A form part without a file.
  std::chrono::milliseconds idle_timeout{5000};  ///< Between two requests.
  /** The same while others wait for a thread. */
  std::chrono::milliseconds crowded_idle_timeout{1000};
  std::chrono::milliseconds head_timeout{10'000};
  /** Connections that may wait for each thread; as many again are told that
   they may not, and each has a moment to say what it wants. */
  size_t max_waiting_per_thread{4};
  std::chrono::milliseconds turned_away_timeout{100};
  /** For a client to take the last answer before its connection ends. */
  std::chrono::milliseconds linger_timeout{1000};
  std::chrono::seconds body_timeout{120};
  std::chrono::seconds write_timeout{30};  ///< Without a byte getting away.
  /** A client that takes less of an answer, after write_timeout, is cut off. */
  size_t least_bytes_per_second{32 << 10};
  size_t max_requests_per_connection{100'000};
  /** What is in flight when the server is to stop has so long to end. */
  std::chrono::seconds drain_timeout{5};
};

}  // namespace graspdb
