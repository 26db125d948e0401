#include "scene_io/ply/ply.h"

#include <array>
#include <bit>

#include <fmt/format.h>

#include <kairos/error.h>

#include "scene_io/file_warnings.h"
#include "scene_io/ply/header.h"
#include "scene_io/ply/source.h"

namespace kairos {

namespace {

enum Slot { kX, kY, kZ, kNx, kNy, kNz, kU, kV, kRed, kGreen, kBlue, kAlpha, kSlots };
constexpr int kNoSlot = -1;

int slot_of(const PlyProperty& property) {
  struct Known {
    std::string_view name;
    Slot slot;
  };
  constexpr Known kKnown[] = {{"x", kX},
                              {"y", kY},
                              {"z", kZ},
                              {"nx", kNx},
                              {"ny", kNy},
                              {"nz", kNz},
                              {"u", kU},
                              {"v", kV},
                              {"s", kU},
                              {"t", kV},
                              {"texture_u", kU},
                              {"texture_v", kV},
                              {"texture_s", kU},
                              {"texture_t", kV},
                              {"red", kRed},
                              {"green", kGreen},
                              {"blue", kBlue},
                              {"alpha", kAlpha},
                              {"diffuse_red", kRed},
                              {"diffuse_green", kGreen},
                              {"diffuse_blue", kBlue}};
  if (!property.is_list)
    for (const Known& known : kKnown)
      if (known.name == property.name) return known.slot;
  return kNoSlot;
}

/// What a full colour is written as.
float full_code(PlyType type) {
  if (type == PlyType::float32 || type == PlyType::float64) return 1;
  return type == PlyType::uint16 ? 65535.0f : 255.0f;
}

uint32_t to_index(double number) {
  const bool usable = number >= 0 && number < static_cast<double>(kMaxIndices);  // false for NaN
  const auto index = usable ? static_cast<uint32_t>(number) : kBadIndex;
  return usable && index == number ? index : kBadIndex;
}

template <class Source>
class BodyParser {
 public:
  BodyParser(Source source, const std::string& path) : source_(source) { mesh_.path = path; }

  PolygonMesh parse(const PlyHeader& header) {
    mesh_.warnings = header.warnings;
    bool has_vertices = false;
    for (const PlyElement& element : header.elements) {
      if (element.properties.empty()) continue;  // takes no room in the file, whatever its count
      check_room(element);
      if (element.name == "vertex") {
        if (has_vertices) fail("has a second element 'vertex'");
        has_vertices = true;
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element, false);
      } else if (element.name == "tristrips") {
        read_faces(element, true);
      } else {
        left_out(element, "elements '" + printable(element.name) + "'");
        for (uint64_t i = 0; i < element.count; ++i)
          for (const PlyProperty& property : element.properties) skip(property);
      }
    }
    if (!has_vertices) fail("has no element 'vertex'");
    for (std::string& line : warnings_.lines()) mesh_.warnings.push_back(std::move(line));
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ErrorCode::bad_input, mesh_.path, what); }

  void left_out(const PlyElement& element, const std::string& what) {
    if (element.count > 0) warnings_.add({mesh_.path, 0}, what + " are left out");
  }
  void property_left_out(const PlyElement& element, const PlyProperty& property) {
    left_out(element, "properties '" + printable(property.name) + "' of elements '" + printable(element.name) + "'");
  }

  /// Before any memory is taken for it: does the file have room for what the header promises?
  void check_room(const PlyElement& element) const {
    uint64_t size = 0;
    for (const PlyProperty& property : element.properties)
      size += Source::min_size(property.is_list ? property.count_type : property.type);
    if (element.count > source_.room(size))
      fail(fmt::format("is too short for its {} elements '{}'", element.count, printable(element.name)));
  }

  void skip(const PlyProperty& property) {
    const uint64_t count = property.is_list ? list_size(property) : 1;
    if (count > source_.room(property.type)) fail("ends before the last of its elements");
    source_.skip(property.type, count);
  }

  uint64_t list_size(const PlyProperty& property) {
    const double size = source_.number(property.count_type);
    if (!(size >= 0 && size <= 4294967295.0) || size != std::floor(size))
      fail(fmt::format("a list '{}' of length {}", printable(property.name), size));
    const auto count = static_cast<uint64_t>(size);
    if (count > source_.room(property.type))
      fail(fmt::format("is too short for a list '{}' of length {}", printable(property.name), count));
    return count;
  }

  void read_vertices(const PlyElement& element) {
    std::vector<int> slots;
    std::array<bool, kSlots> has{};
    std::array<float, kSlots> row{};
    std::array<float, kSlots> full{};
    row[kAlpha] = full[kAlpha] = 1;
    for (const PlyProperty& property : element.properties) {
      slots.push_back(slot_of(property));
      if (slots.back() == kNoSlot) {
        property_left_out(element, property);
        continue;
      }
      const auto slot = static_cast<size_t>(slots.back());
      has[slot] = true;
      full[slot] = full_code(property.type);
    }
    if (!has[kX] || !has[kY] || !has[kZ]) fail("its vertices lack one of x, y, z");
    if (element.count > kMaxIndices) fail("has more than 2^32 vertices");
    const bool normals = has[kNx] && has[kNy] && has[kNz], uvs = has[kU] && has[kV],
               colors = has[kRed] && has[kGreen] && has[kBlue];
    mesh_.positions.reserve(element.count);
    if (normals) mesh_.normals.reserve(element.count);
    if (uvs) mesh_.uvs.reserve(element.count);
    if (colors) mesh_.colors.reserve(element.count);
    for (uint64_t i = 0; i < element.count; ++i) {
      for (size_t p = 0; p < slots.size(); ++p) {
        if (slots[p] == kNoSlot)
          skip(element.properties[p]);
        else
          row[static_cast<size_t>(slots[p])] = source_.real(element.properties[p].type);
      }
      mesh_.positions.push_back({row[kX], row[kY], row[kZ]});
      if (normals) mesh_.normals.push_back({row[kNx], row[kNy], row[kNz]});
      if (uvs) mesh_.uvs.push_back({row[kU], row[kV]});
      if (colors)
        mesh_.colors.push_back(color_of_codes({row[kRed] / full[kRed], row[kGreen] / full[kGreen],
                                               row[kBlue] / full[kBlue], row[kAlpha] / full[kAlpha]}));
    }
  }

  void read_faces(const PlyElement& element, bool strips) {
    for (const PlyProperty& property : element.properties)
      if (!is_indices(property)) property_left_out(element, property);
    for (uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) {
        if (!is_indices(property))
          skip(property);
        else if (strips)
          read_strip(property);
        else
          read_face(property);
      }
  }

  static bool is_indices(const PlyProperty& property) {
    return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  void read_face(const PlyProperty& property) {
    const uint64_t size = list_size(property);
    for (uint64_t k = 0; k < size; ++k) mesh_.corners.push_back(to_index(source_.number(property.type)));
    mesh_.end_face(size);
  }

  void read_strip(const PlyProperty& property) {
    uint32_t a = 0, b = 0;
    uint64_t in_strip = 0;
    for (uint64_t k = list_size(property); k > 0; --k) {
      const double number = source_.number(property.type);
      if (number == -1) {
        in_strip = 0;
        continue;
      }
      const uint32_t c = to_index(number);
      if (in_strip >= 2) {  // every other triangle is wound the other way round
        const bool odd = in_strip % 2 == 1;
        for (const uint32_t v : {odd ? b : a, odd ? a : b, c}) mesh_.corners.push_back(v);
        mesh_.end_face(3);
      }
      a = b;
      b = c;
      ++in_strip;
    }
  }

  Source source_;
  PolygonMesh mesh_;
  FileWarnings warnings_{false};
};

template <class Source>
PolygonMesh parse_body(std::string_view body, const PlyHeader& header, const std::string& path) {
  return BodyParser<Source>(Source(body, path), path).parse(header);
}

}  // namespace

PolygonMesh parse_ply(std::string_view file, const std::string& path) {
  const PlyHeader header = parse_ply_header(file, path);
  const std::string_view body = file.substr(header.size);
  if (header.format == PlyFormat::ascii) return parse_body<PlyAsciiSource>(body, header, path);
  const bool little = header.format == PlyFormat::little_endian;
  return little == (std::endian::native == std::endian::little) ? parse_body<PlyBinarySource<false>>(body, header, path)
                                                                : parse_body<PlyBinarySource<true>>(body, header, path);
}

}  // namespace kairos
