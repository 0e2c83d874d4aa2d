#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/geometry/surface_sampling.h"
#include "server/decode/decode_client.h"
#include "tests/support/cloud_files.h"
#include "tests/support/mesh_files.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// Changes a few bytes or numbers, cuts, repeats or swaps pieces.
FileBytes Mutate(FileBytes bytes, Random& random) {
  for (int i = random.NextIndex(4); i >= 0 && !bytes.empty(); --i) {
    const int size = static_cast<int>(bytes.size());
    const int at = random.NextIndex(size);
    const int length = std::min(size - at, 1 + random.NextIndex(1 + size / 8));
    const FileBytes piece(bytes.begin() + at, bytes.begin() + at + length);
    switch (random.NextIndex(6)) {
      case 0:
        bytes[at] = static_cast<uint8_t>(random.NextBits());
        break;
      case 1:
        bytes[at] ^= static_cast<uint8_t>(1 << random.NextIndex(8));
        break;
      case 2:
        bytes.erase(bytes.begin() + at, bytes.begin() + at + length);
        break;
      case 3:
        bytes.insert(bytes.begin() + random.NextIndex(size), piece.begin(),
                     piece.end());
        break;
      case 4: {
        const FileBytes word =
            ToBytes(std::array{"nan", "-1", "4294967295", "1e39", "0",
                               "999999999999", " ", "\n"}[random.NextIndex(8)]);
        bytes.insert(bytes.begin() + at, word.begin(), word.end());
        break;
      }
      default: {
        const auto value =
            std::array{
                0u,          0xffffffffu, 0x7fffffffu,
                0x7fc00000u, 0x7f7fffffu, 0x80000000u}[random.NextIndex(6)];
        if (at + 4 <= size) std::memcpy(bytes.data() + at, &value, 4);
      }
    }
  }
  return bytes;
}

TEST(Decoder, AnswersManyMutantsOfEachFormat) {
  const TriangleMesh mesh = workshop::MakeCylinder(0.04, 0.1, 8, 2);
  auto files = MakeEveryFile(mesh);
  const auto points = SamplePoissonDisk(mesh, 300, 1).points;
  for (auto& cloud : MakeEveryCloud(points)) files.push_back(std::move(cloud));
  const char* wanted = std::getenv("GRASPDB_MUTANTS");  // Of each file.
  const int mutants = wanted == nullptr ? 120 : std::atoi(wanted);
  ASSERT_GE(mutants, 10);
  std::vector<std::pair<std::string, FileBytes>> work;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto& [name, bytes] = files[i];
    for (int k = 0; k < mutants; ++k) {
      Random random(DeriveSeed(11, {i, static_cast<uint64_t>(k)}));
      work.emplace_back(name, Mutate(bytes, random));
    }
  }
  std::atomic<std::size_t> next{0};
  int solids = 0;
  int refused = 0;
  std::mutex mutex;
  std::chrono::milliseconds slowest{0};
  std::string slowest_name;
  DecoderOptions options;
  options.helper = GRASPDB_DECODE_HELPER;
  const Decoder decoder(options);
  const auto run = [&] {
    for (std::size_t i = next++; i < work.size(); i = next++) {
      DecodeRequest request;
      request.file_name = work[i].first;
      const auto begin = std::chrono::steady_clock::now();
      const auto decoded = decoder.Decode(work[i].second, request);
      const auto took = std::chrono::ceil<std::chrono::milliseconds>(
          std::chrono::steady_clock::now() - begin);
      const std::lock_guard lock(mutex);
      if (took > slowest) {
        slowest = took;
        slowest_name =
            fmt::format("mutant {} of {}", i % mutants, work[i].first);
      }
      if (decoded) {
        ++solids;
        EXPECT_TRUE(IsClosed(decoded->mesh_O));
        continue;
      }
      ++refused;
      EXPECT_TRUE(decoded.error().code == ErrorCode::kUnusableInput ||
                  decoded.error().code == ErrorCode::kTooLarge)
          << decoded.error().message;
      EXPECT_FALSE(decoded.error().message.empty());
    }
  };
  std::thread other(run);
  run();
  other.join();
  EXPECT_EQ(solids + refused, std::ssize(work));
  EXPECT_GT(solids, mutants / 3);
  EXPECT_GT(refused, mutants);
  const DecodeCounts counts = decoder.counts();
  EXPECT_EQ(counts.unstarted, 0);
  RecordProperty("mutants", static_cast<int>(work.size()));
  RecordProperty("crashed", static_cast<int>(counts.crashed));
  RecordProperty("timed_out", static_cast<int>(counts.timed_out));
  RecordProperty("slowest_milliseconds", static_cast<int>(slowest.count()));
  RecordProperty("slowest", slowest_name);
}

}  // namespace
}  // namespace graspdb
