#include "engine/admission/ply_file.h"

#include <array>
#include <charconv>
#include <cstring>
#include <utility>

#include "engine/admission/text_scanner.h"

namespace graspdb {
namespace {

constexpr std::size_t kMostPlyHeaderLines = 1000;

std::size_t GetPlySize(std::string_view type) {
  static constexpr std::pair<std::string_view, std::size_t> kSizes[] = {
      {"char", 1},  {"int8", 1},    {"uchar", 1},  {"uint8", 1},
      {"short", 2}, {"int16", 2},   {"ushort", 2}, {"uint16", 2},
      {"int", 4},   {"int32", 4},   {"uint", 4},   {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& [name, size] : kSizes) {
    if (type == name) return size;
  }
  return 0;
}

}  // namespace

std::optional<PlyHeader> TakePlyHeader(std::string_view& text) {
  PlyHeader header;
  if (Trim(TakeLine(text)) != "ply") return std::nullopt;
  for (std::size_t i = 0; i < kMostPlyHeaderLines && !text.empty(); ++i) {
    std::string_view line = TakeLine(text);
    const std::string_view keyword = TakeWord(line);
    if (keyword == "end_header") return header;
    if (keyword == "format") {
      header.format = TakeWord(line);
    } else if (keyword == "element") {
      PlyElement element{std::string(TakeWord(line)), 0, {}};
      const std::string_view count = TakeWord(line);
      const auto [end, error] = std::from_chars(
          count.data(), count.data() + count.size(), element.count);
      if (error != std::errc() || element.count < 0 ||
          end != count.data() + count.size()) {
        return std::nullopt;
      }
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) return std::nullopt;
      PlyProperty property;
      std::string_view type = TakeWord(line);
      if (type == "list") {
        property.count_size = GetPlySize(TakeWord(line));
        if (property.count_size == 0) return std::nullopt;
        type = TakeWord(line);
      }
      property.type = type;
      property.size = GetPlySize(type);
      property.name = TakeWord(line);
      if (property.size == 0 || property.name.empty()) return std::nullopt;
      header.elements.back().properties.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info") {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

const PlyProperty* FindProperty(const PlyElement& element,
                                std::string_view name, bool list) {
  for (const PlyProperty& property : element.properties) {
    if (property.name == name && (property.count_size > 0) == list) {
      return &property;
    }
  }
  return nullptr;
}

PlyBody::PlyBody(std::string_view body, std::string_view format)
    : rest_(body),
      ascii_(format == "ascii"),
      big_endian_(format == "binary_big_endian") {}

bool PlyBody::Skip(std::size_t size, int64_t count) {
  if (ascii_) {
    for (int64_t i = 0; i < count; ++i) {
      if (TakeWord(rest_).empty()) return false;
    }
    return true;
  }
  if (count > static_cast<int64_t>(rest_.size() / size)) return false;
  rest_.remove_prefix(size * static_cast<std::size_t>(count));
  return true;
}

int64_t PlyBody::TakeCount(std::size_t size) {
  int64_t count = 0;
  if (ascii_) {
    const std::string_view word = TakeWord(rest_);
    const auto [end, error] =
        std::from_chars(word.data(), word.data() + word.size(), count);
    return error == std::errc() ? count : -1;
  }
  if (rest_.size() < size) return -1;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t at = big_endian_ ? i : size - 1 - i;
    count = count << 8 | static_cast<uint8_t>(rest_[at]);
  }
  rest_.remove_prefix(size);
  return count;
}

std::optional<double> PlyBody::TakeValue(const PlyProperty& property) {
  if (ascii_) return ParseNumber(TakeWord(rest_));
  if (rest_.size() < property.size) return std::nullopt;
  std::array<char, 8> bytes{};
  for (std::size_t i = 0; i < property.size; ++i) {
    bytes[i] = rest_[big_endian_ ? property.size - 1 - i : i];
  }
  rest_.remove_prefix(property.size);
  const auto as = [&bytes](auto value) {
    std::memcpy(&value, bytes.data(), sizeof(value));
    return static_cast<double>(value);
  };
  const bool is_float = property.type.starts_with("float");
  const bool is_signed = !property.type.starts_with("u");
  switch (property.size) {
    case 1:
      return is_signed ? as(int8_t{}) : as(uint8_t{});
    case 2:
      return is_signed ? as(int16_t{}) : as(uint16_t{});
    case 4:
      if (is_float) return as(float{});
      return is_signed ? as(int32_t{}) : as(uint32_t{});
    default:
      return as(double{});
  }
}

bool PlyBody::CouldHold(const PlyElement& element) const {
  std::size_t row = 0;
  for (const PlyProperty& property : element.properties) {
    const std::size_t size =
        property.count_size > 0 ? property.count_size : property.size;
    row += ascii_ ? 1 : size;
  }
  return row > 0 && element.count <= static_cast<int64_t>(rest_.size() / row);
}

}  // namespace graspdb
