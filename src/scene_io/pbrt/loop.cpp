// Loop's subdivision surface. C. Loop, "Smooth Subdivision Surfaces Based on Triangles" (1987); the limits' weights:
// H. Hoppe et al., "Piecewise Smooth Surface Reconstruction" (1994).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>

#include "scene_io/pbrt/geometry.h"

namespace kairos::pbrt {

namespace {

constexpr uint32_t kNone = 0xffffffff;

/// The neighbours of a vertex, counter-clockwise. On a boundary the first and the last lie on it.
struct Ring {
  std::vector<uint32_t> around;
  bool boundary = false;
};

/// Which vertices are joined, for meshes in which each edge has one or two triangles that agree on the front.
class Joins {
 public:
  Joins(const std::vector<Triangle>& triangles, size_t vertices) : out_(vertices) {
    for (const Triangle& t : triangles)
      for (size_t k = 0; k < 3; ++k)  // seen from t[k], the edge opposite leads from one neighbour to the next
        out_[t[k]].emplace_back(t[(k + 1) % 3], t[(k + 2) % 3]);
  }

  /// An empty ring for a vertex of no triangle, or one where the surface is no sheet: it stays where it is.
  Ring ring(uint32_t vertex) const {
    const auto& edges = out_[vertex];
    Ring ring;
    if (edges.empty()) return ring;
    std::unordered_map<uint32_t, uint32_t> next;
    std::unordered_map<uint32_t, int> reached;
    for (const auto& [from, to] : edges) {
      if (!next.emplace(from, to).second || ++reached[to] > 1) return {};
    }
    uint32_t start = edges.front().first;
    for (const auto& [from, to] : edges)
      if (reached.find(from) == reached.end()) {
        start = from;
        ring.boundary = true;
      }
    uint32_t at = start;
    do {
      ring.around.push_back(at);
      const auto found = next.find(at);
      at = found == next.end() ? kNone : found->second;
    } while (at != kNone && at != start && ring.around.size() <= edges.size());
    const size_t expected = edges.size() + (ring.boundary ? 1 : 0);
    if (ring.around.size() != expected) return {};  // two sheets meet in this vertex
    return ring;
  }

 private:
  std::vector<std::vector<std::pair<uint32_t, uint32_t>>> out_;
};

double beta(size_t valence) { return valence == 3 ? 3.0 / 16 : 3.0 / (8.0 * static_cast<double>(valence)); }

Vec3d weighted(const std::vector<Vec3d>& p, uint32_t vertex, const Ring& ring, double weight) {
  const std::vector<uint32_t>& around = ring.around;
  if (ring.boundary) return p[vertex] * (1 - 2 * weight) + (p[around.front()] + p[around.back()]) * weight;
  Vec3d sum{};
  for (const uint32_t v : around) sum += p[v];
  return p[vertex] * (1 - static_cast<double>(around.size()) * weight) + sum * weight;
}

uint64_t edge_key(uint32_t a, uint32_t b) { return uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

/// One step: old vertices are smoothed, each edge gets a new one, each triangle becomes four.
void subdivide(std::vector<Vec3d>& p, std::vector<Triangle>& triangles) {
  struct Edge {
    uint32_t middle;
    uint32_t opposite[2];
    int triangles = 0;
  };
  std::unordered_map<uint64_t, Edge> edges;
  const auto old_count = static_cast<uint32_t>(p.size());
  uint32_t count = old_count;
  for (const Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k) {
      const auto [found, is_new] = edges.try_emplace(edge_key(t[k], t[(k + 1) % 3]), Edge{count, {kNone, kNone}, 0});
      if (is_new) ++count;
      Edge& edge = found->second;
      if (edge.triangles < 2) edge.opposite[edge.triangles] = t[(k + 2) % 3];
      ++edge.triangles;
    }
  std::vector<Vec3d> fine(count);
  const Joins joins(triangles, old_count);
  for (uint32_t v = 0; v < old_count; ++v) {
    const Ring ring = joins.ring(v);
    constexpr double kBoundary = 1.0 / 8;
    fine[v] = ring.around.empty() ? p[v] : weighted(p, v, ring, ring.boundary ? kBoundary : beta(ring.around.size()));
  }
  for (const auto& [key, edge] : edges) {
    const Vec3d ends = p[key >> 32] + p[key & 0xffffffff];
    fine[edge.middle] =
        edge.triangles == 2 ? ends * (3.0 / 8) + (p[edge.opposite[0]] + p[edge.opposite[1]]) * (1.0 / 8) : ends * 0.5;
  }
  std::vector<Triangle> smaller;
  smaller.reserve(triangles.size() * 4);
  for (const Triangle& t : triangles) {
    const auto middle = [&](size_t k) { return edges.at(edge_key(t[k], t[(k + 1) % 3])).middle; };
    const uint32_t a = middle(0), b = middle(1), c = middle(2);
    for (const Triangle& part : {Triangle{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}}) smaller.push_back(part);
  }
  p = std::move(fine);
  triangles = std::move(smaller);
}

/// The limit surface's normal from the ring's limit tangents.
Vec3d limit_normal(const std::vector<Vec3d>& p, uint32_t vertex, const Ring& ring) {
  const std::vector<uint32_t>& around = ring.around;
  const size_t n = around.size();
  Vec3d along{}, across{};
  if (!ring.boundary) {
    for (size_t j = 0; j < n; ++j) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(n);
      along += p[around[j]] * std::cos(angle);
      across += p[around[j]] * std::sin(angle);
    }
    return normalize(cross(along, across));
  }
  along = p[around.front()] - p[around.back()];
  if (n == 2) {
    across = p[around[0]] + p[around[1]] - p[vertex] * 2;
  } else if (n == 3) {
    across = p[around[1]] - p[vertex];
  } else if (n == 4) {
    across = p[around[0]] * -1.0 + p[around[1]] * 2.0 + p[around[2]] * 2.0 + p[around[3]] * -1.0 + p[vertex] * -2.0;
  } else {
    const double theta = std::numbers::pi / static_cast<double>(n - 1);
    across = (p[around.front()] + p[around.back()]) * std::sin(theta);
    for (size_t j = 1; j + 1 < n; ++j)
      across += p[around[j]] * ((2 * std::cos(theta) - 2) * std::sin(static_cast<double>(j) * theta));
    across = -across;
  }
  return normalize(cross(along, across));
}

}  // namespace

MeshData subdivide_loop(const std::vector<Vec3f>& positions, const std::vector<Triangle>& cage, int64_t levels,
                        uint64_t max_triangles, const Place& place) {
  constexpr int64_t kMaxLevels = 12;
  // Working space is a kilobyte a vertex; more is no subdivision surface but an accident.
  constexpr uint64_t kMostTriangles = 1 << 24;
  max_triangles = std::min(max_triangles, kMostTriangles);
  if (levels < 0 || levels > kMaxLevels) fail(place, fmt::format("'levels' must be from 0 to {}", kMaxLevels));
  if (cage.size() > max_triangles >> (2 * levels))
    fail(place, fmt::format("{} levels of subdivision make too many triangles", levels));
  std::vector<Vec3d> p;
  for (const Vec3f& position : positions) p.push_back(to_double(position));
  std::vector<Triangle> triangles;
  for (const Triangle& t : cage)  // those with a corner twice have no area, and no place in a ring
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  for (int64_t level = 0; level < levels; ++level) subdivide(p, triangles);

  MeshData data;
  data.positions.resize(1);
  data.normals.resize(1);
  data.triangles = triangles;
  std::vector<Vec3d> mean(p.size());  // of the triangles' normals, where there is no limit
  for (const Triangle& t : triangles) {
    const Vec3d normal = cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
    for (const uint32_t v : t) mean[v] += normal;
  }
  const Joins joins(triangles, p.size());
  std::vector<Vec3d> limit(p);
  std::vector<Ring> rings(p.size());
  for (uint32_t v = 0; v < p.size(); ++v) {
    rings[v] = joins.ring(v);
    if (rings[v].around.empty()) continue;
    constexpr double kBoundary = 1.0 / 6;  // a cubic B-spline's

    const size_t n = rings[v].around.size();
    const double interior = 1 / (static_cast<double>(n) + 3 / (8 * beta(n)));
    limit[v] = weighted(p, v, rings[v], rings[v].boundary ? kBoundary : interior);
  }
  for (uint32_t v = 0; v < p.size(); ++v) {
    Vec3d normal = rings[v].around.empty() ? Vec3d{} : limit_normal(p, v, rings[v]);
    if (length(normal) == 0) normal = normalize(mean[v]);
    data.positions[0].push_back(to_float(limit[v]));
    data.normals[0].push_back(to_float(normal));
  }
  return data;
}

}  // namespace kairos::pbrt
