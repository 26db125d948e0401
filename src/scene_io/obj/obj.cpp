#include "scene_io/obj/obj.h"

#include <fmt/format.h>

#include <kairos/error.h>

#include "scene_io/text_numbers.h"

namespace kairos {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Lines without their ends (LF, CR LF or CR), joined where the last character is a backslash.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    number_ = next_number_;
    if (rest_.empty()) return false;
    line = take();
    if (!continues(line)) return true;
    joined_.clear();
    for (;;) {
      const bool more = continues(line);
      joined_ += more ? line.substr(0, line.size() - 1) : line;
      if (!more || rest_.empty()) break;
      joined_ += ' ';
      line = take();
    }
    line = joined_;
    return true;
  }

  size_t number() const { return number_; }  ///< of the line last read, from 1

 private:
  static bool continues(std::string_view line) { return !line.empty() && line.back() == '\\'; }

  std::string_view take() {
    const size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    const size_t ends = end == rest_.npos ? 0 : rest_.substr(end, 2) == "\r\n" ? 2 : 1;
    rest_.remove_prefix(line.size() + ends);
    ++next_number_;
    return line;
  }

  std::string_view rest_;
  std::string joined_;
  size_t number_ = 1, next_number_ = 1;
};

/// The next run of characters that are no spaces; empty at the end of the line.
std::string_view take_token(std::string_view& line) {
  size_t begin = 0;
  while (begin < line.size() && is_space(line[begin])) ++begin;
  size_t end = begin;
  while (end < line.size() && !is_space(line[end])) ++end;
  const std::string_view token = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return token;
}

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& path) : lines_(text) { mesh_.path = path; }

  PolygonMesh parse() {
    std::string_view line;
    while (lines_.next(line)) {
      if (const size_t comment = line.find('#'); comment != line.npos) line = line.substr(0, comment);
      const std::string_view keyword = take_token(line);
      if (keyword == "v") {
        mesh_.positions.push_back(read_vec3(line));
      } else if (keyword == "vn") {
        mesh_.normals.push_back(read_vec3(line));
      } else if (keyword == "vt") {
        const float u = read_float(line);
        mesh_.uvs.push_back({u, is_blank(line) ? 0 : read_float(line)});
      } else if (keyword == "f") {
        read_face(line);
      }
    }
    finish();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}:{}", mesh_.path, lines_.number()), what);
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
    mesh_.end_face(size);
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
    if (mesh_.corner_uvs.empty()) mesh_.uvs.clear();
    if (mesh_.corner_normals.empty()) mesh_.normals.clear();
    mark_bad(mesh_.corners, mesh_.positions.size());
    mark_bad(mesh_.corner_uvs, mesh_.uvs.size());
    mark_bad(mesh_.corner_normals, mesh_.normals.size());
  }

  Lines lines_;
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh parse_obj(std::string_view text, const std::string& path) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // would hide the first statement
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
  return ObjParser(text, path).parse();
}

}  // namespace kairos
