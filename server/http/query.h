#pragma once

#include <initializer_list>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/http/message.h"

namespace graspdb {

/** Reads the query parameters of a request by type. The first thing wrong is
 kept: read all parameters, then call Finish() before using any.

     QueryReader query(request.query);
     const auto count = query.Integer("count", 1, 1000).value_or(40);
     const auto part = query.Text("part");
     GRASPDB_TRY_VOID(query.Finish());

 Each getter answers nothing when the parameter is absent or wrong. */
class QueryReader {
 public:
  /** @param query Must outlive the reader. */
  explicit QueryReader(const TextPairs& query) : query_(query) {}

  /** Not empty, at most `most` bytes. */
  std::optional<std::string> Text(const std::string& name, size_t most = 256);
  /** A decimal integer in [least, most]. */
  std::optional<int64_t> Integer(
      const std::string& name, int64_t least,
      int64_t most = std::numeric_limits<int64_t>::max());
  /** A decimal number in [least, most], or in (least, most] when `above`. */
  std::optional<double> Number(const std::string& name, double least,
                               double most, bool above = false);
  /** "true" or "false". */
  std::optional<bool> Boolean(const std::string& name);
  /** One of the given words. */
  std::optional<std::string> Choice(const std::string& name,
                                    std::initializer_list<const char*> words);

  /** @retval kInvalidArgument naming the first parameter that is repeated,
   unparsable, out of range or unknown (never asked for), and what it takes. */
  Result<void> Finish() const;

 private:
  const std::string* Find(const std::string& name);
  void Refuse(const std::string& name, const std::string& value,
              const std::string& takes);

  const TextPairs& query_;
  std::set<std::string> known_;
  std::optional<Error> error_;
};

}  // namespace graspdb
