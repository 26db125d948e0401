// pbrt-v4's bilinear patches as triangles.
#include <cmath>

#include <fmt/format.h>

#include "scene_io/pbrt/geometry.h"

namespace kairos::pbrt {

namespace {

// Cells along each side of a patch that is not a parallelogram: its surface leaves the triangles' by at most
// 1/1024 of the patch's twist.
constexpr uint32_t kCells = 16;

template <class T>
T bilinear(const std::array<T, 4>& corners, double u, double v) {
  return lerp(lerp(corners[0], corners[1], u), lerp(corners[2], corners[3], u), v);
}

struct Patch {
  std::array<Vec3d, 4> p, n{};  ///< at (0, 0), (1, 0), (0, 1) and (1, 1)
  std::array<Vec3d, 4> uv{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  bool has_normals = false;

  bool is_parallelogram() const {
    const Vec3d twist = p[0] - p[1] - p[2] + p[3];
    constexpr double kFlat = 1e-6;  // of the diagonal: float's rounding of the corners
    return length(twist) <= kFlat * length(p[3] - p[0]);
  }
  Vec3d normal(double u, double v) const {
    if (has_normals) return normalize(bilinear(n, u, v));
    return normalize(cross(lerp(p[1] - p[0], p[3] - p[2], v), lerp(p[2] - p[0], p[3] - p[1], u)));
  }
};

void add_patch(const Patch& patch, MeshData& data) {
  const uint32_t cells = patch.is_parallelogram() ? 1 : kCells;
  const auto first = static_cast<uint32_t>(data.positions[0].size());
  for (uint32_t j = 0; j <= cells; ++j)
    for (uint32_t i = 0; i <= cells; ++i) {
      const double u = static_cast<double>(i) / cells, v = static_cast<double>(j) / cells;
      data.positions[0].push_back(to_float(bilinear(patch.p, u, v)));
      data.normals[0].push_back(to_float(patch.normal(u, v)));
      const Vec3f uv = to_float(bilinear(patch.uv, u, v));
      data.uvs.push_back({uv.x, uv.y});
    }
  for (uint32_t j = 0; j < cells; ++j)
    for (uint32_t i = 0; i < cells; ++i) {
      const uint32_t corner = first + j * (cells + 1) + i, above = corner + cells + 1;
      data.triangles.push_back({corner, corner + 1, above + 1});
      data.triangles.push_back({corner, above + 1, above});
    }
}

}  // namespace

MeshData tessellate_bilinear(const Parameters& parameters, uint64_t max_triangles) {
  const std::vector<Vec3f> points = parameters.vec3_list("P"), normals = parameters.vec3_list("N");
  const std::vector<Vec2f> uvs = parameters.vec2_list("uv");
  std::vector<uint32_t> indices = parameters.index_list("indices");
  if (!parameters.find("indices") && points.size() == 4) indices = {0, 1, 2, 3};
  if (indices.empty() || indices.size() % 4 != 0)
    fail(parameters.place(), "a bilinear mesh needs 'indices', four for each patch");
  if ((!normals.empty() && normals.size() != points.size()) || (!uvs.empty() && uvs.size() != points.size()))
    fail(parameters.place(), "needs one normal and one texture coordinate for each point, or none");
  if (indices.size() / 4 > max_triangles / (uint64_t{2} * kCells * kCells))
    fail(parameters.place(), fmt::format("{} bilinear patches are too many", indices.size() / 4));
  MeshData data;
  data.positions.resize(1);
  data.normals.resize(1);
  for (size_t first = 0; first < indices.size(); first += 4) {
    Patch patch;
    patch.has_normals = !normals.empty();
    for (size_t corner = 0; corner < 4; ++corner) {
      const uint32_t index = indices[first + corner];
      if (index >= points.size() || !is_finite(points[index]))
        fail(parameters.place(), "a bilinear patch has an index out of range, or a point that is not finite");
      patch.p[corner] = to_double(points[index]);
      if (!normals.empty()) patch.n[corner] = to_double(normals[index]);
      if (!uvs.empty()) patch.uv[corner] = {uvs[index].x, uvs[index].y, 0};
    }
    add_patch(patch, data);
  }
  return data;
}

}  // namespace kairos::pbrt
