#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/** @file
 What a fuzz target defines: it takes any bytes, and aborts when something is
 wrong. Linked with replay_main.cc, which tries mutants from a seed, or with
 clang's libFuzzer (preset "fuzz"). */

/** @returns 0. */
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace graspdb::fuzz {

/** Sound inputs to set out from. */
std::vector<std::string> MakeSeeds();

inline std::string_view AsText(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/** Ends the process, so that the input is kept. */
inline void Require(bool condition) {
  if (!condition) __builtin_trap();
}

}  // namespace graspdb::fuzz
