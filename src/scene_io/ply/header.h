// The header of a PLY file: which elements follow, and what each is made of.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kairos {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of one value in a binary file.
uint64_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  ///< of a list's length
  PlyType type = PlyType::float32;
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> warnings;  ///< one line each
  size_t size = 0;                    ///< bytes up to and with the end of the line "end_header"
};

/// Throws Error(bad_input) that names the line of a malformed header. Counts are not compared with the file's size.
PlyHeader parse_ply_header(std::string_view file, const std::string& path);

}  // namespace kairos
