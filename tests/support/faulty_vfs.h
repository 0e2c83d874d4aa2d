#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/base/random.h"

namespace graspdb {

/** SQLite's access to files, with faults: fails when told to, and knows what of
 the files in one folder would be left were the power cut now. There is one in a
 process, and SQLite uses it for every file once it was asked for. */
class FaultyVfs {
 public:
  enum class Call {
    kChange,  ///< Write, truncation, flush.
    kRead,
    kOpen,
  };

  static FaultyVfs& Get();

  /** Forgets all faults and watches the files in the folder: those that SQLite
   opens there from now on. */
  void Watch(const std::string& folder);

  /** Called before each change of a watched file. */
  void set_before_change(std::function<void()> hook) {
    before_change_ = std::move(hook);
  }

  /** The n-th such call from now on fails with an SQLite error code; 0: none.
   */
  void FailAt(int64_t n, int code, Call call = Call::kChange);
  /** Whether that call has come. */
  bool has_failed() const { return code_ != 0 && left_ == 0; }

  /** Writes to a folder what a power cut may leave of the watched files: all
   that was flushed, and any of the sectors that were written since. */
  void WriteImage(const std::string& folder, Random& random);

  // What the functions that SQLite calls need.
  struct File {
    int64_t durable_size{0};
    /** What sectors that were written since the last flush had been. */
    std::map<int64_t, std::vector<char>> durable;
  };
  File* Find(const char* path);
  /** @returns 0, or the code to fail with. */
  int Begin(Call call);

 private:
  FaultyVfs();

  std::string folder_;
  std::map<std::string, File> files_;
  std::function<void()> before_change_;
  int64_t left_{0};
  int code_{0};
  Call call_{Call::kChange};
};

}  // namespace graspdb
