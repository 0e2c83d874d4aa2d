#include "server/http/target.h"

#include <charconv>

#include "engine/base/utf8.h"

namespace graspdb {
namespace {

Error MakeTargetError(std::string message) {
  return {ErrorCode::kInvalidArgument, std::move(message),
          "Percent-encode the UTF-8 bytes of reserved characters."};
}

Result<TextPairs> ParseQuery(std::string_view text) {
  TextPairs pairs;
  while (!text.empty()) {
    const size_t end = text.find('&');
    const std::string_view pair = text.substr(0, end);
    text = end == std::string_view::npos ? "" : text.substr(end + 1);
    if (pair.empty()) continue;
    const size_t equals = pair.find('=');
    GRASPDB_TRY(name, DecodePercent(pair.substr(0, equals), true));
    std::string value;
    if (equals != std::string_view::npos) {
      GRASPDB_TRY(decoded, DecodePercent(pair.substr(equals + 1), true));
      value = decoded;
    }
    pairs.emplace_back(name, value);
  }
  return pairs;
}

}  // namespace

Result<std::string> DecodePercent(std::string_view text, bool plus_is_space) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '+' && plus_is_space) {
      out += ' ';
    } else if (text[i] == '%') {
      unsigned value = 0;
      const std::string_view digits = text.substr(i + 1, 2);
      const auto [end, error] = std::from_chars(
          digits.data(), digits.data() + digits.size(), value, 16);
      if (digits.size() != 2 || error != std::errc() ||
          end != digits.data() + 2) {
        return MakeTargetError("The request target has a broken % escape.");
      }
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
    }
  }
  if (out.find('\0') != std::string::npos || !IsUtf8(out)) {
    return MakeTargetError("The request target is not UTF-8 text.");
  }
  return out;
}

std::string EncodePercent(std::string_view text) {
  constexpr std::string_view kUnreserved =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    if (kUnreserved.find(c) != std::string_view::npos) {
      out += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    out += {'%', kHex[byte >> 4], kHex[byte & 15]};
  }
  return out;
}

Result<Target> ParseTarget(std::string_view target) {
  const size_t question = target.find('?');
  std::string_view path = target.substr(0, question);
  Target parsed;
  if (path != "/") {
    while (!path.empty()) {
      path.remove_prefix(1);  // The slash.
      const std::string_view segment = path.substr(0, path.find('/'));
      GRASPDB_TRY(decoded, DecodePercent(segment, false));
      parsed.segments.push_back(decoded);
      path.remove_prefix(segment.size());
    }
  }
  if (question != std::string_view::npos) {
    GRASPDB_TRY(query, ParseQuery(target.substr(question + 1)));
    parsed.query = std::move(query);
  }
  return parsed;
}

}  // namespace graspdb
