#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "engine/base/result.h"
#include "server/codec/json.h"

namespace graspdb {

/** What a bench has found so far, a file for each question, so that it may be
 interrupted at any time. */
class RowFiles {
 public:
  explicit RowFiles(std::filesystem::path folder);

  /** @retval kInvalidArgument where there cannot be such a folder. */
  Result<void> MakeFolder() const;

  /** @param name  Of a question, for people; characters that a file name may
   not have are replaced. @param key  All that the answer depends on.
   @returns what was written under both, if anything. */
  std::optional<Json> Read(const std::string& name,
                           const std::string& key) const;

  /** Whole or not at all, whenever the power goes. */
  Result<void> Write(const std::string& name, const std::string& key,
                     const Json& rows) const;

 private:
  std::filesystem::path MakePath(const std::string& name) const;

  const std::filesystem::path folder_;
};

}  // namespace graspdb
