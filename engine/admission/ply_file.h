#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graspdb {

/** What a PLY file says of its body. */
struct PlyProperty {
  std::string name;
  std::string type;
  std::size_t size{0};        ///< Bytes of a value.
  std::size_t count_size{0};  ///< Bytes of a list's count; 0: a scalar.
};

struct PlyElement {
  std::string name;
  int64_t count{0};
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
};

/** Cuts the header off the text and leaves the body; nothing when malformed. */
std::optional<PlyHeader> TakePlyHeader(std::string_view& text);

/** The element's property of that name: a list or a scalar; null if none. */
const PlyProperty* FindProperty(const PlyElement& element,
                                std::string_view name, bool list);

/** Walks over the values of a body. */
class PlyBody {
 public:
  /** @param format  As the header names it: "ascii", "binary_little_endian" or
   "binary_big_endian". */
  PlyBody(std::string_view body, std::string_view format);

  /** Passes over `count` values of so many bytes each.
   @returns false when they are not all there. */
  bool Skip(std::size_t size, int64_t count);

  /** A list's count of so many bytes; -1 when there is none. */
  int64_t TakeCount(std::size_t size);

  /** A scalar of the named type; nothing when there is none. */
  std::optional<double> TakeValue(const PlyProperty& property);

  /** Whether so many rows could be there at all. */
  bool CouldHold(const PlyElement& element) const;

 private:
  std::string_view rest_;
  bool ascii_;
  bool big_endian_;
};

}  // namespace graspdb
