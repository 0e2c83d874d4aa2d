#include "engine/admission/point_cloud_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "engine/admission/mesh_content.h"
#include "engine/admission/ply_file.h"
#include "engine/admission/text_scanner.h"
#include "engine/base/contract.h"

namespace graspdb {
namespace {

using Points = std::vector<Eigen::Vector3d>;

std::string_view ToText(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Result<void> CheckPoints(int64_t points, const MeshLimits& limits) {
  if (points <= limits.max_points) return {};
  return Error{ErrorCode::kTooLarge,
               fmt::format("the cloud has {} points; the limit is {}", points,
                           limits.max_points),
               "Thin the cloud out first.", "mesh"};
}

// ---- XYZ

Result<Points> ReadXyz(std::string_view text, const MeshLimits& limits) {
  Points points;
  for (int number = 1; !text.empty(); ++number) {
    std::string line(Trim(TakeLine(text)));
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) {
      continue;
    }
    for (char& c : line) {
      if (c == ',' || c == ';') c = ' ';
    }
    std::string_view rest = line;
    Eigen::Vector3d p;
    int found = 0;
    for (; found < 3; ++found) {
      const auto value = ParseNumber(TakeWord(rest));
      if (!value) break;
      p[found] = *value;
    }
    if (found == 1 && points.empty() && Trim(rest).empty()) continue;
    if (found < 3) {
      return MakeFormatError(
          MeshFormat::kXyz,
          fmt::format("line {} does not start with three numbers", number));
    }
    points.push_back(p);
    GRASPDB_TRY_VOID(CheckPoints(std::ssize(points), limits));
  }
  return points;
}

// ---- PLY

Result<Points> ReadPlyPoints(std::string_view bytes, const MeshLimits& limits) {
  const auto fail = [](const std::string& what) {
    return MakeFormatError(MeshFormat::kPly, what);
  };
  std::string_view rest = bytes;
  const auto header = TakePlyHeader(rest);
  if (!header) return fail("its header is malformed");
  PlyBody body(rest, header->format);
  Points points;
  for (const PlyElement& element : header->elements) {
    const bool is_vertex = element.name == "vertex";
    const PlyProperty* axes[3] = {FindProperty(element, "x", false),
                                  FindProperty(element, "y", false),
                                  FindProperty(element, "z", false)};
    if (is_vertex && !(axes[0] && axes[1] && axes[2])) {
      return fail("its vertices lack a coordinate");
    }
    if (is_vertex) GRASPDB_TRY_VOID(CheckPoints(element.count, limits));
    const std::string truncated = fmt::format(
        "its header announces {} of element '{}', which are not "
        "there",
        element.count, element.name.substr(0, 32));
    if (element.count > 0 && !body.CouldHold(element)) return fail(truncated);
    for (int64_t row = 0; row < element.count; ++row) {
      Eigen::Vector3d p;
      for (const PlyProperty& property : element.properties) {
        const auto axis = std::find(axes, axes + 3, &property);
        if (is_vertex && axis != axes + 3) {
          const auto value = body.TakeValue(property);
          if (!value) return fail(truncated);
          p[axis - axes] = *value;
          continue;
        }
        const int64_t count =
            property.count_size > 0 ? body.TakeCount(property.count_size) : 1;
        if (count < 0 || !body.Skip(property.size, count)) {
          return fail(truncated);
        }
      }
      if (is_vertex) points.push_back(p);
    }
  }
  return points;
}

// ---- PCD (the Point Cloud Library's file format 0.7)

struct PcdField {
  std::string name;
  int64_t size{4};
  char type{'F'};
  int64_t count{1};
};

struct PcdHeader {
  std::vector<PcdField> fields;
  int64_t points{-1};
  std::string data;
};

constexpr int kMostPcdLines = 100;
constexpr int64_t kMostPcdPointBytes = 65536;

// Cuts the header off the text; nothing when malformed.
std::optional<PcdHeader> TakePcdHeader(std::string_view& text) {
  PcdHeader header;
  int64_t width = -1, height = 1;
  for (int i = 0; i < kMostPcdLines && !text.empty(); ++i) {
    std::string_view line = TakeLine(text);
    const std::string_view keyword = TakeWord(line);
    std::vector<std::string_view> words;
    for (auto word = TakeWord(line); !word.empty(); word = TakeWord(line)) {
      words.push_back(word);
    }
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      for (const std::string_view word : words) {
        header.fields.push_back({std::string(word)});
      }
      continue;
    }
    if (keyword == "SIZE" || keyword == "TYPE" || keyword == "COUNT") {
      if (words.size() != header.fields.size()) return std::nullopt;
      for (std::size_t f = 0; f < words.size(); ++f) {
        PcdField& field = header.fields[f];
        if (keyword == "TYPE") {
          field.type = words[f].front();
        } else {
          int64_t& number = keyword == "SIZE" ? field.size : field.count;
          if (!ParseInteger(words[f], number) || number < 0 ||
              number > kMostPcdPointBytes) {
            return std::nullopt;
          }
        }
      }
      continue;
    }
    if (words.empty()) continue;
    if (keyword == "WIDTH" && !ParseInteger(words[0], width)) break;
    if (keyword == "HEIGHT" && !ParseInteger(words[0], height)) break;
    if (keyword == "POINTS" && !ParseInteger(words[0], header.points)) break;
    if (keyword != "DATA") continue;
    header.data = words[0];
    constexpr int64_t kMost = int64_t{1} << 31;
    if (header.points < 0 && width >= 0 && height >= 0 && width < kMost &&
        height < kMost) {
      header.points = width * height;
    }
    if (header.points < 0 || header.fields.empty()) return std::nullopt;
    return header;
  }
  return std::nullopt;
}

// Where x, y and z are in a point's bytes, or by how many values they come
// after its first.
struct PcdAxis {
  int64_t byte{0};
  int64_t value{0};
  const PcdField* field{nullptr};
};

std::optional<std::array<PcdAxis, 3>> FindPcdAxes(const PcdHeader& header) {
  std::array<PcdAxis, 3> axes;
  int64_t byte = 0, value = 0;
  for (const PcdField& field : header.fields) {
    const std::size_t axis = std::string_view("xyz").find(field.name);
    if (field.name.size() == 1 && axis < 3) axes[axis] = {byte, value, &field};
    byte += field.size * field.count;
    value += field.count;
    if (byte > kMostPcdPointBytes) return std::nullopt;
  }
  for (const PcdAxis& axis : axes) {
    if (axis.field == nullptr || axis.field->count != 1 ||
        axis.field->type != 'F' ||
        (axis.field->size != 4 && axis.field->size != 8)) {
      return std::nullopt;
    }
  }
  return axes;
}

double ReadFloat(const char* bytes, int64_t size) {
  if (size == 4) {
    float value = 0.0F;
    std::memcpy(&value, bytes, 4);
    return value;
  }
  double value = 0.0;
  std::memcpy(&value, bytes, 8);
  return value;
}

// Marc Lehmann's LZF, as PCL packs with it: a byte below 32 starts a run of
// that many bytes and one, any other a copy of three or more bytes from before.
// @returns nothing unless exactly so many bytes come out.
std::optional<std::string> UnpackLzf(std::string_view packed,
                                     std::size_t size) {
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto take = [&] {
    return static_cast<std::size_t>(static_cast<uint8_t>(packed[at++]));
  };
  while (at < packed.size()) {
    const std::size_t control = take();
    if (control < 32) {
      const std::size_t run = control + 1;
      if (run > packed.size() - at || out.size() + run > size) return {};
      out.append(packed.substr(at, run));
      at += run;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (at == packed.size()) return {};
      length += take();
    }
    if (at == packed.size()) return {};
    const std::size_t back = ((control & 31) << 8 | take()) + 1;
    if (back > out.size() || out.size() + length + 2 > size) return {};
    for (std::size_t i = 0; i < length + 2; ++i) {
      out.push_back(out[out.size() - back]);  // May read what it wrote.
    }
  }
  if (out.size() != size) return {};
  return out;
}

Result<Points> ReadPcd(std::string_view bytes, const MeshLimits& limits) {
  const auto fail = [](const std::string& what) {
    return MakeFormatError(MeshFormat::kPcd, what);
  };
  std::string_view body = bytes;
  const auto header = TakePcdHeader(body);
  if (!header) return fail("its header is malformed");
  const auto axes = FindPcdAxes(*header);
  if (!axes)
    return fail("its points lack x, y and z as floating point numbers");
  GRASPDB_TRY_VOID(CheckPoints(header->points, limits));
  const auto count = static_cast<std::size_t>(header->points);
  std::size_t point_size = 0, num_values = 0;
  for (const PcdField& field : header->fields) {
    point_size += static_cast<std::size_t>(field.size * field.count);
    num_values += static_cast<std::size_t>(field.count);
  }
  const std::string truncated = fmt::format(
      "its header announces {} points, which are not there", header->points);
  Points points;
  if (header->data == "ascii") {
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Vector3d p;
      for (std::size_t v = 0; v < num_values; ++v) {
        const auto value = ParseNumber(TakeWord(body));
        for (int axis = 0; axis < 3; ++axis) {
          if (v != static_cast<std::size_t>((*axes)[axis].value)) continue;
          if (!value) return fail(truncated);
          p[axis] = *value;
        }
      }
      points.push_back(p);
    }
    return points;
  }
  std::string unpacked;
  const bool by_field = header->data == "binary_compressed";
  if (by_field) {
    uint32_t sizes[2] = {0, 0};
    if (body.size() < sizeof(sizes)) return fail(truncated);
    std::memcpy(sizes, body.data(), sizeof(sizes));
    body.remove_prefix(sizeof(sizes));
    if (sizes[0] > body.size() || sizes[1] != count * point_size ||
        static_cast<int64_t>(sizes[1]) > 16 * limits.max_bytes) {
      return fail(truncated);
    }
    auto all = UnpackLzf(body.substr(0, sizes[0]), sizes[1]);
    if (!all) return fail("its compressed points do not unpack");
    unpacked = std::move(*all);
    body = unpacked;
  } else if (header->data != "binary") {
    return fail("its header names no known encoding");
  }
  if (body.size() / std::max<std::size_t>(point_size, 1) < count) {
    return fail(truncated);
  }
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d p;
    for (int k = 0; k < 3; ++k) {
      const PcdAxis& axis = (*axes)[k];
      const auto offset = static_cast<std::size_t>(axis.byte);
      const auto size = static_cast<std::size_t>(axis.field->size);
      p[k] = ReadFloat(body.data() + (by_field ? offset * count + i * size
                                               : i * point_size + offset),
                       axis.field->size);
    }
    points.push_back(p);
  }
  return points;
}

Result<Points> ReadAll(std::string_view bytes, MeshFormat format,
                       const MeshLimits& limits) {
  switch (format) {
    case MeshFormat::kXyz:
      return ReadXyz(bytes, limits);
    case MeshFormat::kPly:
      return ReadPlyPoints(bytes, limits);
    case MeshFormat::kPcd:
      return ReadPcd(bytes, limits);
    default:
      return MakeFormatError(format, "it holds no cloud");
  }
}

}  // namespace

bool HoldsPointsOnly(std::span<const uint8_t> bytes, MeshFormat format) {
  if (format != MeshFormat::kPly) {
    return format == MeshFormat::kPcd || format == MeshFormat::kXyz;
  }
  std::string_view text = ToText(bytes);
  const auto header = TakePlyHeader(text);
  if (!header) return false;
  const auto has = [&header](std::string_view name) {
    return std::any_of(
        header->elements.begin(), header->elements.end(),
        [name](const auto& e) { return e.name == name && e.count > 0; });
  };
  return has("vertex") && !has("face") && !has("tristrips");
}

Result<Points> ReadPointCloud(std::span<const uint8_t> bytes, MeshFormat format,
                              double metres_per_unit,
                              const MeshLimits& limits) {
  GRASPDB_EXPECTS(metres_per_unit > 0.0 && std::isfinite(metres_per_unit));
  GRASPDB_TRY_VOID(CheckSize(bytes, format, limits));
  GRASPDB_TRY(all, ReadAll(ToText(bytes), format, limits));
  Points points;
  for (const Eigen::Vector3d& p : all) {
    if (p.allFinite()) points.push_back(metres_per_unit * p);
  }
  if (points.empty()) return MakeFormatError(format, "it has no points");
  return points;
}

}  // namespace graspdb
