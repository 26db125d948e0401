#include "scene_io/obj/obj.h"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include <kairos/error.h>

#include "scene_io/file_warnings.h"
#include "scene_io/obj/lines.h"
#include "scene_io/text_numbers.h"

namespace kairos {

namespace {

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& path) : lines_(text) { mesh_.path = path; }

  PolygonMesh parse() {
    std::string_view line;
    while (lines_.next(line)) {
      const std::string_view whole = line;
      line = without_comment(line);
      const std::string_view keyword = take_token(line);
      if (keyword == "v") {
        mesh_.positions.push_back(read_vec3(line));
        read_color(line);
      } else if (keyword == "vn") {
        mesh_.normals.push_back(read_vec3(line));
      } else if (keyword == "vt") {
        const float u = read_float(line);
        mesh_.uvs.push_back({u, is_blank(line) ? 0 : read_float(line)});
      } else if (keyword == "f") {
        read_face(line);
      } else if (keyword == "usemtl") {
        use_material(name_in(whole));
      } else if (keyword == "mtllib") {
        mesh_.libraries.push_back(name_in(whole));
      } else if (keyword == "s") {
        const std::string_view group = take_token(line);
        if (group != "off" && group != "0" && first_smooth_ == 0) first_smooth_ = lines_.number();
      } else if (!keyword.empty() && keyword != "o" && keyword != "g") {
        warnings_.add({mesh_.path, lines_.number()}, "statements '" + printable(keyword) + "' are left out");
      }
    }
    finish();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}:{}", mesh_.path, lines_.number()), what);
  }

  /// What follows the statement's word: names may hold spaces and a '#'.
  static std::string name_in(std::string_view line) {
    take_token(line);
    return std::string(trimmed(line));
  }

  static bool is_blank(std::string_view line) { return take_token(line).empty(); }

  float read_float(std::string_view& line) const {
    const std::string_view token = take_token(line);
    float value = 0;
    if (token.empty()) fail("a number is missing");
    if (!parse_number(token, value)) fail("'" + printable(token) + "' is not a number");
    return value;
  }

  Vec3f read_vec3(std::string_view& line) const {
    const float x = read_float(line), y = read_float(line), z = read_float(line);
    return {x, y, z};
  }

  /// What may follow a vertex: nothing, a weight, or red, green, blue and perhaps alpha.
  void read_color(std::string_view line) {
    float number[4];
    int count = 0;
    while (count < 4 && parse_number(take_token(line), number[count])) ++count;
    const bool is_color = count >= 3;
    if (!is_color && mesh_.colors.empty()) return;
    constexpr Vec4f kWhite{INFINITY, INFINITY, INFINITY, INFINITY};  // in codes of any size
    mesh_.colors.resize(mesh_.positions.size() - 1, kWhite);
    mesh_.colors.push_back(is_color ? Vec4f{number[0], number[1], number[2], count > 3 ? number[3] : INFINITY}
                                    : kWhite);
    // Some write codes of bytes.
    for (int i = 0; is_color && i < count; ++i)
      if (number[i] > 1) color_scale_ = 1 / 255.0f;
  }

  /// One index of a corner, counted from 1, or backwards from the `count` values read so far. Whether a positive one
  /// names something is only known at the end of the file.
  uint32_t read_index(std::string_view text, size_t count) const {
    int64_t index = 0;
    if (!parse_integer(text, index)) fail("'" + printable(text) + "' is not an index");
    if (index < 0) index += static_cast<int64_t>(count) + 1;
    return index < 1 || index > static_cast<int64_t>(kMaxIndices) ? kBadIndex : static_cast<uint32_t>(index - 1);
  }

  void read_face(std::string_view line) {
    uint64_t size = 0;
    for (std::string_view token = take_token(line); !token.empty(); token = take_token(line), ++size) {
      std::string_view part[3];  // v / vt / vn
      for (int k = 0; k < 3; ++k) {
        const size_t slash = k < 2 ? token.find('/') : token.npos;
        part[k] = token.substr(0, slash);
        token = slash == token.npos ? std::string_view{} : token.substr(slash + 1);
      }
      append(mesh_.corner_uvs, part[1], mesh_.uvs.size());
      append(mesh_.corner_normals, part[2], mesh_.normals.size());
      mesh_.corners.push_back(read_index(part[0], mesh_.positions.size()));
    }
    if (mesh_.material_names.empty()) use_material("");
    mesh_.end_face(size, material_);
  }

  void use_material(const std::string& name) {
    constexpr uint32_t kMostMaterials = 1 << 16;  // each becomes a mesh
    const auto next = static_cast<uint32_t>(mesh_.material_names.size());
    if (next == kMostMaterials) fail(fmt::format("more than {} materials", kMostMaterials));
    const auto [found, is_new] = material_indices_.try_emplace(name, next);
    if (is_new) mesh_.material_names.push_back(name);
    material_ = found->second;
  }

  /// Appends an optional index; the list stays empty until some corner has one.
  void append(std::vector<uint32_t>& indices, std::string_view text, size_t count) const {
    if (text.empty() && indices.empty()) return;
    if (indices.empty()) indices.assign(mesh_.corners.size(), kNoIndex);
    indices.push_back(text.empty() ? kNoIndex : read_index(text, count));
  }

  static void mark_bad(std::vector<uint32_t>& indices, size_t count) {
    for (uint32_t& index : indices)
      if (index >= count && index != kNoIndex) index = kBadIndex;
  }

  void finish() {
    if (mesh_.positions.empty()) throw Error(ErrorCode::bad_input, mesh_.path, "has no vertices; is it an OBJ file?");
    if (mesh_.positions.size() > kMaxIndices)
      throw Error(ErrorCode::bad_input, mesh_.path, "has more than 2^32 vertices");
    if (first_smooth_ != 0 && mesh_.normals.empty() && !mesh_.corners.empty())
      warnings_.add({mesh_.path, first_smooth_}, "smoothing groups are left out: faces without normals are flat");
    mesh_.warnings = warnings_.lines();
    for (Vec4f& c : mesh_.colors)
      c = color_of_codes({c.x * color_scale_, c.y * color_scale_, c.z * color_scale_, c.w * color_scale_});
    if (mesh_.corner_uvs.empty()) mesh_.uvs.clear();
    if (mesh_.corner_normals.empty()) mesh_.normals.clear();
    mark_bad(mesh_.corners, mesh_.positions.size());
    mark_bad(mesh_.corner_uvs, mesh_.uvs.size());
    mark_bad(mesh_.corner_normals, mesh_.normals.size());
  }

  Lines lines_;
  PolygonMesh mesh_;
  FileWarnings warnings_{false};
  std::map<std::string, uint32_t> material_indices_;
  uint32_t material_ = 0;
  float color_scale_ = 1;
  size_t first_smooth_ = 0;  ///< the line that first asks for smooth faces; 0: none does
};

}  // namespace

PolygonMesh parse_obj(std::string_view text, const std::string& path) { return ObjParser(text, path).parse(); }

}  // namespace kairos
