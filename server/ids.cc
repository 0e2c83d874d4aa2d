#include "server/ids.h"

#include <array>
#include <chrono>
#include <ctime>
#include <mutex>

#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

using Milliseconds = std::chrono::milliseconds;

int64_t CalcUnixMilliseconds() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<Milliseconds>(since_epoch).count();
}

// 48 bits of time and 12 of counter, never the same twice in this process.
uint64_t NextTimestamp() {
  static std::mutex mutex;
  static uint64_t last = 0;
  const std::lock_guard lock(mutex);
  const auto now = static_cast<uint64_t>(CalcUnixMilliseconds()) << 12;
  last = now > last ? now : last + 1;
  return last;
}

}  // namespace

std::string CalcSha256(std::string_view bytes) {
  std::array<unsigned char, 32> digest{};
  unsigned int length = 0;
  const int ok = EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length,
                            EVP_sha256(), nullptr);
  GRASPDB_EXPECTS(ok == 1 && length == digest.size());
  std::string text;
  for (const unsigned char byte : digest) text += fmt::format("{:02x}", byte);
  return text;
}

std::string MakeContentId(std::string_view content) {
  return CalcSha256(content).substr(0, 32);
}

std::string MakeUuid() {
  const uint64_t time = NextTimestamp();
  uint64_t random = 0;
  GRASPDB_EXPECTS(RAND_bytes(reinterpret_cast<unsigned char*>(&random),
                             sizeof(random)) == 1);
  const uint64_t variant = 0x8000 | ((random >> 48) & 0x3fff);
  return fmt::format("{:08x}-{:04x}-7{:03x}-{:04x}-{:012x}", time >> 28,
                     (time >> 12) & 0xffff, time & 0xfff, variant,
                     random & 0xffffffffffff);
}

std::string FormatNow() {
  const int64_t now = CalcUnixMilliseconds();
  const std::time_t seconds = now / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z",
                     utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec, now % 1000);
}

}  // namespace graspdb
