#include "server/ids.h"

#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <memory>
#include <mutex>
#include <vector>

#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

using Digest = std::array<unsigned char, 32>;

std::string ToHex(const Digest& digest) {
  std::string text;
  for (const unsigned char byte : digest) text += fmt::format("{:02x}", byte);
  return text;
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
  Digest digest{};
  unsigned int length = 0;
  const int ok = EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length,
                            EVP_sha256(), nullptr);
  GRASPDB_EXPECTS(ok == 1 && length == digest.size());
  return ToHex(digest);
}

Result<std::string> CalcFileSha256(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(
      EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  GRASPDB_EXPECTS(context != nullptr &&
                  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1);
  std::vector<char> chunk(1 << 20);
  while (file) {
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    GRASPDB_EXPECTS(EVP_DigestUpdate(context.get(), chunk.data(),
                                     static_cast<size_t>(file.gcount())) == 1);
  }
  if (!file.eof()) {
    return Error{ErrorCode::kInvalidArgument, path + " cannot be read.",
                 "check its name and permissions"};
  }
  Digest digest{};
  GRASPDB_EXPECTS(EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) ==
                  1);
  return ToHex(digest);
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

std::string MakeUuidBound(int64_t unix_milliseconds) {
  return fmt::format("{:08x}-{:04x}", unix_milliseconds >> 16,
                     unix_milliseconds & 0xffff);
}

int64_t CalcUnixMilliseconds() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch)
      .count();
}

std::string FormatTime(int64_t unix_milliseconds) {
  const std::time_t seconds = unix_milliseconds / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z",
                     utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec,
                     unix_milliseconds % 1000);
}

std::string FormatNow() { return FormatTime(CalcUnixMilliseconds()); }

}  // namespace graspdb
