#include "scene_io/mesh_data.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>

#include "image/srgb.h"
#include "scene_io/triangulate.h"

namespace kairos {

void PolygonMesh::end_face(uint64_t size, uint32_t material) {
  if (corners.size() > kMaxIndices) throw Error(ErrorCode::bad_input, path, "has more than 2^32 face corners");
  // While all faces are triangles their sizes are not kept.
  if (size != 3 && face_sizes.empty()) face_sizes.assign((corners.size() - size) / 3, 3);
  if (size != 3 || !face_sizes.empty()) face_sizes.push_back(static_cast<uint32_t>(size));
  // Nor are materials, while all faces have the first.
  if (material != 0 && face_materials.empty())
    face_materials.assign((face_sizes.empty() ? corners.size() / 3 : face_sizes.size()) - 1, 0);
  if (material != 0 || !face_materials.empty()) face_materials.push_back(material);
}

namespace {

/// Collects warnings; with `strict` the first of them is an error.
class Warn {
 public:
  Warn(std::vector<std::string>& lines, bool strict) : lines_(lines), strict_(strict) {}

  void operator()(const std::string& place, const std::string& what) { line(place + ": " + what); }
  void line(const std::string& line) {
    if (strict_) throw Error(ErrorCode::bad_input, "", line);
    lines_.push_back(line);
  }

 private:
  std::vector<std::string>& lines_;
  bool strict_;
};

size_t face_count(const PolygonMesh& mesh) {
  return mesh.face_sizes.empty() ? mesh.corners.size() / 3 : mesh.face_sizes.size();
}

void check_same_faces(const std::vector<PolygonMesh>& keys) {
  const PolygonMesh& first = keys.front();
  for (const PolygonMesh& key : keys) {
    const auto differ = [&](const char* what, size_t count, size_t first_count) {
      throw Error(ErrorCode::bad_input, key.path,
                  fmt::format("has {} {}, {} has {}; motion keys need equal connectivity", count, what, first.path,
                              first_count));
    };
    if (key.positions.size() != first.positions.size())
      differ("vertices", key.positions.size(), first.positions.size());
    if (face_count(key) != face_count(first)) differ("faces", face_count(key), face_count(first));
    if (key.corners.size() != first.corners.size()) differ("face corners", key.corners.size(), first.corners.size());
    if (key.corners != first.corners || key.face_sizes != first.face_sizes)
      throw Error(
          ErrorCode::bad_input, key.path,
          "its faces name other vertices than those of " + first.path + "; motion keys need equal connectivity");
  }
}

/// Vertices of a mesh while they are split: each is one position, and one value of every attribute seen so far.
struct Vertices {
  std::vector<uint32_t> corner;    ///< [corner] its vertex; beyond the vertices where the index is bad
  std::vector<uint32_t> position;  ///< [vertex]

  /// Splits vertices until all corners of one have the same `attribute` ([corner]).
  void split(const std::vector<uint32_t>& attribute, const std::string& path) {
    constexpr uint32_t kUnused = kBadIndex;
    const size_t before = position.size();
    std::vector<uint32_t> first(before, kUnused);
    // Sorted, not hashed: no choice of indices makes that slow.
    struct Corner {
      uint64_t key;  // vertex and value
      uint32_t index;
    };
    std::vector<Corner> others;
    for (size_t c = 0; c < corner.size(); ++c) {
      const uint32_t vertex = corner[c], value = attribute[c];
      if (vertex >= before || value == kBadIndex || first[vertex] == value) continue;
      if (first[vertex] == kUnused)
        first[vertex] = value;
      else
        others.push_back({uint64_t{vertex} << 32 | value, static_cast<uint32_t>(c)});
    }
    std::sort(others.begin(), others.end(),
              [](const Corner& a, const Corner& b) { return std::pair(a.key, a.index) < std::pair(b.key, b.index); });
    std::vector<size_t> runs;  // where the corners of each new vertex begin, in order of use
    for (size_t i = 0; i < others.size(); ++i)
      if (i == 0 || others[i].key != others[i - 1].key) runs.push_back(i);
    std::sort(runs.begin(), runs.end(), [&](size_t a, size_t b) { return others[a].index < others[b].index; });
    for (const size_t run : runs) {
      if (position.size() >= kMaxIndices) throw Error(ErrorCode::bad_input, path, "has more than 2^32 vertices");
      const auto vertex = static_cast<uint32_t>(position.size());
      position.push_back(position[others[run].key >> 32]);
      for (size_t i = run; i < others.size() && others[i].key == others[run].key; ++i) corner[others[i].index] = vertex;
    }
  }

  /// What each vertex has of an attribute: `pool` by the indices of `attribute`, or by position where that is empty.
  template <class T>
  std::vector<T> gather(const std::vector<T>& pool, const std::vector<uint32_t>& attribute) const {
    std::vector<T> values(position.size());
    if (attribute.empty()) {
      for (size_t v = 0; v < position.size(); ++v) values[v] = pool[position[v]];
    } else {
      for (size_t c = 0; c < corner.size(); ++c)
        if (corner[c] < values.size() && attribute[c] < pool.size()) values[corner[c]] = pool[attribute[c]];
    }
    return values;
  }
};

bool all_corners_have(const std::vector<Vec3f>& pool, const std::vector<uint32_t>& attribute) {
  if (pool.empty()) return false;
  for (const uint32_t index : attribute)
    if (index == kNoIndex) return false;
  return true;
}

/// Indices of normals or texture coordinates that name nothing become none: the face is there all the same. Returns how
/// many there were.
size_t forget_bad(std::vector<uint32_t>& indices, size_t count) {
  size_t bad = 0;
  for (uint32_t& index : indices)
    if (index >= count && index != kNoIndex) {
      index = kNoIndex;
      ++bad;
    }
  return bad;
}

void forget_bad_attributes(PolygonMesh& mesh, Warn& warn) {
  const auto forget = [&](std::vector<uint32_t>& indices, size_t count, const char* what) {
    const size_t bad = forget_bad(indices, count);
    if (bad > 0)
      warn(mesh.path, fmt::format("{} of {} face corners name {} that are not there (the file has {}): they have none",
                                  bad, indices.size(), what, count));
    if (bad > 0 && count == 0) indices.clear();
  };
  forget(mesh.corner_normals, mesh.normals.size(), "normals");
  forget(mesh.corner_uvs, mesh.uvs.size(), "texture coordinates");
}

/// All triangles, as corner indices, and what material each has.
std::vector<Triangle> triangulate_faces(const PolygonMesh& mesh, std::vector<uint32_t>& materials, Warn& warn) {
  std::vector<Triangle> triangles;
  const size_t faces = face_count(mesh);
  triangles.reserve(faces);
  std::vector<Vec3f> points;
  std::vector<Triangle> cut;
  size_t small = 0, large = 0;
  uint32_t begin = 0;
  for (size_t f = 0; f < faces; ++f) {
    const uint32_t size = mesh.face_sizes.empty() ? 3 : mesh.face_sizes[f];
    if (size == 3) {
      triangles.push_back({begin, begin + 1, begin + 2});
    } else {
      if (size < 3) ++small;
      points.resize(size);
      for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = mesh.corners[begin + i];
        // A bad index leaves its polygon without a plane: it becomes a fan.
        points[i] = v < mesh.positions.size() ? mesh.positions[v] : Vec3f{NAN, NAN, NAN};
      }
      cut.clear();
      if (!triangulate_polygon(points, cut)) ++large;
      for (const Triangle& t : cut) triangles.push_back({begin + t[0], begin + t[1], begin + t[2]});
    }
    if (!mesh.face_materials.empty()) materials.resize(triangles.size(), mesh.face_materials[f]);
    begin += size;
  }
  if (small > 0) warn(mesh.path, fmt::format("{} faces with fewer than 3 corners left out", small));
  if (large > 0)
    warn(mesh.path, fmt::format("{} concave polygons with more than {} corners cut as if they were convex", large,
                                kMaxConcaveCorners));
  return triangles;
}

void normalize_all(std::vector<Vec3f>& normals) {
  for (Vec3f& n : normals) n = to_float(normalize(to_double(n)));
}

}  // namespace

MeshData make_mesh_data(std::vector<PolygonMesh> keys, bool strict) {
  check_same_faces(keys);
  MeshData data;
  Warn warn(data.warnings, strict);
  for (PolygonMesh& key : keys) {
    for (const std::string& warning : key.warnings) warn.line(warning);
    forget_bad_attributes(key, warn);
  }
  PolygonMesh& first = keys.front();
  const std::string place = keys.size() == 1 ? first.path : first.path + " to " + keys.back().path;
  std::vector<uint32_t> materials;
  const std::vector<Triangle> triangles = triangulate_faces(first, materials, warn);

  Vertices vertices;
  vertices.corner = first.corners;
  const size_t file_vertices = first.positions.size();
  vertices.position.resize(first.positions.size());
  for (size_t v = 0; v < vertices.position.size(); ++v) vertices.position[v] = static_cast<uint32_t>(v);
  bool with_normals = true, some_normals = false;
  for (const PolygonMesh& key : keys) {
    with_normals = with_normals && all_corners_have(key.normals, key.corner_normals);
    some_normals = some_normals || !key.normals.empty();
  }
  if (some_normals && !with_normals) warn(place, "normals left out: not every corner has one");
  if (!first.uvs.empty() && !first.corner_uvs.empty()) vertices.split(first.corner_uvs, place);
  for (const PolygonMesh& key : keys)
    if (with_normals && !key.corner_normals.empty()) vertices.split(key.corner_normals, place);

  if (!first.uvs.empty()) data.uvs = vertices.gather(first.uvs, first.corner_uvs);
  for (Vec2f& uv : data.uvs)
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {};
  if (!first.colors.empty()) data.colors = vertices.gather(first.colors, {});
  for (PolygonMesh& key : keys) {
    if (with_normals) {
      data.normals.push_back(vertices.gather(key.normals, key.corner_normals));
      normalize_all(data.normals.back());
    }
    const bool split = vertices.position.size() > key.positions.size();
    data.positions.push_back(split ? vertices.gather(key.positions, {}) : std::move(key.positions));
  }

  std::vector<bool> finite(vertices.position.size(), true);
  for (const auto& key : data.positions)
    for (size_t v = 0; v < key.size(); ++v)
      if (!is_finite(key[v])) finite[v] = false;
  const auto is_bad = [&](uint32_t corner) { return first.corners[corner] >= file_vertices; };
  size_t bad_index = 0, not_finite = 0;
  data.triangles.reserve(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    const bool bad = is_bad(a) || is_bad(b) || is_bad(c);
    const Triangle triangle{vertices.corner[a], vertices.corner[b], vertices.corner[c]};
    const bool usable = !bad && finite[triangle[0]] && finite[triangle[1]] && finite[triangle[2]];
    if (!usable) {
      if (bad_index + not_finite == 0)
        for (uint32_t p = 0; p < t; ++p) data.prim_ids.push_back(p);
      ++(bad ? bad_index : not_finite);
      continue;
    }
    data.triangles.push_back(triangle);
    if (!materials.empty()) data.triangle_materials.push_back(materials[t]);
    if (bad_index + not_finite > 0) data.prim_ids.push_back(static_cast<uint32_t>(t));
  }
  if (bad_index + not_finite > 0)
    warn(place, fmt::format("{} of {} triangles dropped: {} with a vertex index out of range, {} with a vertex that is "
                            "not finite",
                            bad_index + not_finite, triangles.size(), bad_index, not_finite));
  if (data.triangles.empty()) warn(place, "has no triangles");
  data.material_names = std::move(first.material_names);
  data.libraries = std::move(first.libraries);
  return data;
}

Vec4f color_of_codes(Vec4f codes) {
  const auto within = [](float code) { return code < 0 ? 0 : code < 1 ? code : 1; };  // 1 for NaN
  return {srgb_value(within(codes.x)), srgb_value(within(codes.y)), srgb_value(within(codes.z)), within(codes.w)};
}

std::vector<Vec2f> uvs_from_above(std::vector<Vec2f> uvs) {
  for (Vec2f& uv : uvs) uv.y = 1 - uv.y;
  return uvs;
}

}  // namespace kairos
