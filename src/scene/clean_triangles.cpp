#include "scene/clean_triangles.h"

#include <array>
#include <numeric>

#include "base/parallel.h"

namespace kairos {

namespace {

constexpr size_t kGrain = 1 << 14;

enum class Verdict : uint8_t { keep, not_finite, zero_area };

using Edges = std::array<Vec3d, 2>;  // from vertex 0 to vertices 1 and 2

Edges edges_at(const std::vector<Vec3f>& positions, const Triangle& triangle) {
  const Vec3d origin = to_double(positions[triangle[0]]);
  return {to_double(positions[triangle[1]]) - origin, to_double(positions[triangle[2]]) - origin};
}

/// Between two keys the area's normal is a parabola in time: c0 (1-x)^2 + c1 x (1-x) + c2 x^2, with the cross products
/// at both keys as c0 and c2. The area is zero at all times where all three vanish.
bool zero_area_always(const Mesh& mesh, const Triangle& triangle) {
  const Vec3d zero{};
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return true;
  Edges last = edges_at(mesh.positions.front(), triangle);
  if (cross(last[0], last[1]) != zero) return false;
  for (size_t k = 1; k < mesh.key_count(); ++k) {
    const Edges next = edges_at(mesh.positions[k], triangle);
    if (cross(next[0], next[1]) != zero) return false;
    const bool jump = mesh.key_times[k] == mesh.key_times[k - 1];
    if (!jump && cross(last[0], next[1]) + cross(next[0], last[1]) != zero) return false;
    last = next;
  }
  return true;
}

/// [vertex]: 1 where a position is not finite at some key; empty when there is none.
std::vector<uint8_t> find_bad_vertices(const Mesh& mesh) {
  std::vector<uint8_t> bad;
  for (const auto& key : mesh.positions)
    for (size_t v = 0; v < key.size(); ++v)
      if (!is_finite(key[v])) {
        bad.resize(mesh.vertex_count());
        bad[v] = 1;
      }
  return bad;
}

}  // namespace

DroppedTriangles clean_triangles(Mesh& mesh) {
  const size_t vertices = mesh.vertex_count();
  const std::vector<uint8_t> bad = find_bad_vertices(mesh);
  std::vector<Verdict> verdicts(mesh.triangles.size(), Verdict::keep);
  parallel_for(mesh.triangles.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Triangle& triangle = mesh.triangles[i];
      for (uint32_t v : triangle)
        if (v >= vertices || (!bad.empty() && bad[v])) verdicts[i] = Verdict::not_finite;
      if (verdicts[i] == Verdict::keep && zero_area_always(mesh, triangle)) verdicts[i] = Verdict::zero_area;
    }
  });

  for (auto& key : mesh.positions)
    for (size_t v = 0; v < bad.size(); ++v)
      if (bad[v]) key[v] = {};
  for (auto& key : mesh.normals)
    for (Vec3f& n : key)
      if (!is_finite(n)) n = {};
  for (auto& key : mesh.tangents)
    for (Vec4f& tangent : key)
      if (!is_finite(Vec3f{tangent.x, tangent.y, tangent.z})) tangent = {0, 0, 0, 1};

  DroppedTriangles dropped;
  for (Verdict v : verdicts) {
    dropped.not_finite += v == Verdict::not_finite;
    dropped.zero_area += v == Verdict::zero_area;
  }
  if (dropped.total() == 0) return dropped;

  if (mesh.prim_ids.empty()) {
    mesh.prim_ids.resize(mesh.triangles.size());
    std::iota(mesh.prim_ids.begin(), mesh.prim_ids.end(), 0u);
  }
  size_t kept = 0;
  for (size_t i = 0; i < verdicts.size(); ++i) {
    if (verdicts[i] != Verdict::keep) continue;
    mesh.triangles[kept] = mesh.triangles[i];
    mesh.prim_ids[kept++] = mesh.prim_ids[i];
  }
  mesh.triangles.resize(kept);
  mesh.prim_ids.resize(kept);
  return dropped;
}

}  // namespace kairos
