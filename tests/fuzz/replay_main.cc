// Runs a fuzz target on its seeds, on the inputs of a folder (what fuzzing has
// gathered and found) and on mutants of all of them, the same ones every time.
//
//   fuzz_json_replay CORPUS [MUTANTS]
//   fuzz_json_replay --write-seeds FOLDER     for libFuzzer to set out from

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/base/random.h"
#include "tests/fuzz/fuzz_target.h"

namespace graspdb::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kFewMutants = 100'000;
constexpr size_t kMostBytes = 1 << 16;

void Run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(input.data()),
                         input.size());
}

// Changes bytes, cuts, repeats or takes pieces of another input.
std::string Mutate(std::string input, const std::string& other,
                   Random& random) {
  static constexpr std::array kWords{
      "nan", "-1",   "4294967295", "1e400", "0",  "{", "}",    "[",
      "]",   "\"",   "\\u0000",    "%00",   "%",  "&", "\r\n", ":",
      ",",   "null", "true",       "--",    "\t", ";", "=",    "e"};
  for (int i = random.NextIndex(5); i >= 0; --i) {
    const int size = static_cast<int>(input.size());
    const auto at = static_cast<size_t>(random.NextIndex(size + 1));
    const auto length = static_cast<size_t>(1 + random.NextIndex(1 + size / 8));
    switch (random.NextIndex(7)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<char>(random.NextBits());
        break;
      case 1:
        if (at < input.size()) {
          input[at] = static_cast<char>(input[at] ^ (1 << random.NextIndex(8)));
        }
        break;
      case 2:
        input.erase(at, length);
        break;
      case 3:
        input.insert(at, input.substr(at, length));
        break;
      case 4:
        input.insert(at, kWords[static_cast<size_t>(random.NextIndex(
                             static_cast<int>(kWords.size())))]);
        break;
      case 5:
        input.insert(at, other.substr(std::min(at, other.size()), length));
        break;
      default: {
        const auto value = std::array{0u,          1u,          0xffffffffu,
                                      0x7fffffffu, 0x7fc00000u, 0x7f7fffffu,
                                      0x80000000u}[static_cast<size_t>(
            random.NextIndex(7))];
        if (at + sizeof(value) <= input.size()) {
          std::memcpy(input.data() + at, &value, sizeof(value));
        }
      }
    }
  }
  if (input.size() > kMostBytes) input.resize(kMostBytes);
  return input;
}

std::vector<std::string> ReadFolder(const std::string& folder) {
  std::vector<fs::path> files;
  if (fs::exists(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> inputs;
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(in),
                        std::istreambuf_iterator<char>());
  }
  return inputs;
}

int Main(int argc, char** argv) {
  std::vector<std::string> inputs = MakeSeeds();
  if (argc == 3 && std::string_view(argv[1]) == "--write-seeds") {
    fs::create_directories(argv[2]);
    for (size_t i = 0; i < inputs.size(); ++i) {
      std::ofstream(fs::path(argv[2]) / ("seed-" + std::to_string(i)),
                    std::ios::binary)
          << inputs[i];
    }
    return 0;
  }
  if (argc > 1) {
    for (std::string& input : ReadFolder(argv[1])) {
      inputs.push_back(std::move(input));
    }
  }
  Run("");
  for (const std::string& input : inputs) Run(input);
  const int mutants = argc > 2 ? std::atoi(argv[2]) : kFewMutants;
  Random random(1);
  for (int i = 0; i < mutants; ++i) {
    const auto choose = [&]() -> const std::string& {
      return inputs[static_cast<size_t>(
          random.NextIndex(static_cast<int>(inputs.size())))];
    };
    const std::string& one = choose();
    const std::string& other = choose();
    Run(Mutate(one, other, random));
  }
  std::printf("%zu inputs, %d mutants\n", inputs.size(), mutants);
  return 0;
}

}  // namespace
}  // namespace graspdb::fuzz

int main(int argc, char** argv) { return graspdb::fuzz::Main(argc, argv); }
