#include "scene_io/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace kairos {

namespace {

constexpr uint32_t kNone = 0xffffffff;

/// A float's bits, the same for both zeros.
uint32_t bits(float value) { return value == 0 ? 0 : std::bit_cast<uint32_t>(value); }

/// [vertex]: the first vertex that is the same in all respects.
std::vector<uint32_t> weld(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                           std::span<const Vec2f> uvs) {
  const auto key = [&](uint32_t v) {
    const Vec3f &p = positions[v], &n = normals[v];
    return std::array{bits(p.x), bits(p.y), bits(p.z), bits(n.x), bits(n.y), bits(n.z), bits(uvs[v].x), bits(uvs[v].y)};
  };
  std::vector<uint32_t> order(positions.size()), welded(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const auto key_a = key(a), key_b = key(b);
    return key_a != key_b ? key_a < key_b : a < b;
  });
  for (size_t i = 0; i < order.size(); ++i)
    welded[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? welded[order[i - 1]] : order[i];
  return welded;
}

/// How the picture lies on a triangle.
struct Face {
  Vec3d along;                                              // in which u rises; unit
  bool is_upright = false;                                  // not mirrored, seen from the front
  bool takes_any = true;                                    // covers nothing of the picture: goes with any neighbour
  bool is_degenerate = false;                               // two of its corners are in one place
  std::array<uint32_t, 3> neighbours{kNone, kNone, kNone};  // beyond the edges that begin at each corner
  std::array<uint32_t, 3> groups{kNone, kNone, kNone};
};

Vec3d across(Vec3d direction, Vec3d normal) { return normalize(direction - normal * dot(direction, normal)); }

class Tangents {
 public:
  Tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const Vec2f> uvs,
           std::span<const Triangle> triangles)
      : positions_(positions), normals_(normals), uvs_(uvs), welded_(weld(positions, normals, uvs)) {
    corners_.reserve(triangles.size());
    for (const Triangle& t : triangles) corners_.push_back({welded_[t[0]], welded_[t[1]], welded_[t[2]]});
    faces_.resize(triangles.size());
    for (uint32_t f = 0; f < faces_.size(); ++f) measure(f);
    find_neighbours();
    for (uint32_t f = 0; f < faces_.size(); ++f)
      for (uint32_t i = 0; i < 3; ++i)
        if (!faces_[f].takes_any && !faces_[f].is_degenerate && faces_[f].groups[i] == kNone) make_group(f, i);
    lend_to_degenerate();
  }

  CornerTangents result() {
    CornerTangents made;
    for (const Face& face : faces_) made.corner.insert(made.corner.end(), face.groups.begin(), face.groups.end());
    made.tangents = std::move(tangents_);
    return made;
  }

 private:
  Vec3d position(uint32_t face, uint32_t corner) const { return to_double(positions_[corners_[face][corner]]); }

  void measure(uint32_t f) {
    Face& face = faces_[f];
    const Triangle& c = corners_[f];
    for (size_t i = 0; i < 3; ++i)
      face.is_degenerate = face.is_degenerate || positions_[c[i]] == positions_[c[(i + 1) % 3]];
    const auto change = [&](size_t i) {  // v upwards
      return Vec2d{static_cast<double>(uvs_[c[i]].x) - static_cast<double>(uvs_[c[0]].x),
                   static_cast<double>(uvs_[c[0]].y) - static_cast<double>(uvs_[c[i]].y)};
    };
    const Vec2d a = change(1), b = change(2);
    const Vec3d side_a = position(f, 1) - position(f, 0), side_b = position(f, 2) - position(f, 0);
    const double area = a.x * b.y - a.y * b.x;
    face.is_upright = area > 0;
    const Vec3d along = side_a * b.y - side_b * a.y, upwards = side_b * a.x - side_a * b.x;
    if (area == 0 || !std::isfinite(area) || normalize(along) == Vec3d{} || normalize(upwards) == Vec3d{}) return;
    face.takes_any = false;
    face.along = normalize(along) * (face.is_upright ? 1.0 : -1.0);
  }

  /// Two triangles are neighbours where one has an edge the other way round. Of more than two at an edge, the first
  /// goes with the first, in the order of triangles.
  void find_neighbours() {
    struct Edge {
      uint32_t low, high, face, corner;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * faces_.size());
    for (uint32_t f = 0; f < faces_.size(); ++f) {
      if (faces_[f].is_degenerate) continue;
      for (uint32_t i = 0; i < 3; ++i) {
        const uint32_t from = corners_[f][i], to = corners_[f][(i + 1) % 3];
        edges.push_back({std::min(from, to), std::max(from, to), f, i});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::array{a.low, a.high, a.face, a.corner} < std::array{b.low, b.high, b.face, b.corner};
    });
    const auto is_forward = [&](const Edge& edge) { return corners_[edge.face][edge.corner] == edge.low; };
    for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) ++end;
      size_t forward = begin, backward = begin;
      while (true) {
        while (forward < end && !is_forward(edges[forward])) ++forward;
        while (backward < end && is_forward(edges[backward])) ++backward;
        if (forward == end || backward == end) break;
        const Edge &a = edges[forward++], &b = edges[backward++];
        faces_[a.face].neighbours[a.corner] = b.face;
        faces_[b.face].neighbours[b.corner] = a.face;
      }
    }
  }

  /// All triangles around a corner that share its tangent.
  void make_group(uint32_t first, uint32_t first_corner) {
    const uint32_t vertex = corners_[first][first_corner];
    const bool is_upright = faces_[first].is_upright;
    const auto group = static_cast<uint32_t>(tangents_.size());
    std::vector<uint32_t> members, open{first};
    while (!open.empty()) {
      const uint32_t f = open.back();
      open.pop_back();
      Face& face = faces_[f];
      uint32_t corner = 0;
      while (corner < 3 && corners_[f][corner] != vertex) ++corner;
      if (corner == 3 || face.groups[corner] != kNone) continue;
      if (face.takes_any && face.groups == std::array{kNone, kNone, kNone}) face.is_upright = is_upright;
      if (face.is_upright != is_upright) continue;
      face.groups[corner] = group;
      members.push_back(f);
      for (const uint32_t neighbour : {face.neighbours[(corner + 2) % 3], face.neighbours[corner]})
        if (neighbour != kNone) open.push_back(neighbour);
    }
    std::sort(members.begin(), members.end());
    Vec3d sum{};
    for (const uint32_t f : members)
      if (!faces_[f].takes_any) sum += weighed(f, vertex);
    const Vec3f unit = to_float(normalize(sum));
    tangents_.push_back({unit.x, unit.y, unit.z, is_upright ? 1.0f : -1.0f});
  }

  Vec3d weighed(uint32_t f, uint32_t vertex) const {
    uint32_t corner = 0;
    while (corners_[f][corner] != vertex) ++corner;
    const Vec3d normal = to_double(normals_[vertex]), here = position(f, corner);
    const Vec3d next = across(position(f, (corner + 1) % 3) - here, normal);
    const Vec3d last = across(position(f, (corner + 2) % 3) - here, normal);
    const double angle = std::acos(std::clamp(dot(next, last), -1.0, 1.0));
    return across(faces_[f].along, normal) * angle;
  }

  /// Triangles without an area take the tangents of others at the same vertices.
  void lend_to_degenerate() {
    std::vector<uint32_t> of_vertex(positions_.size(), kNone);
    for (uint32_t f = 0; f < faces_.size(); ++f)
      for (uint32_t i = 0; i < 3; ++i)
        if (faces_[f].groups[i] != kNone && of_vertex[corners_[f][i]] == kNone)
          of_vertex[corners_[f][i]] = faces_[f].groups[i];
    for (uint32_t f = 0; f < faces_.size(); ++f)
      for (uint32_t i = 0; i < 3; ++i)
        if (faces_[f].is_degenerate) faces_[f].groups[i] = of_vertex[corners_[f][i]];
  }

  std::span<const Vec3f> positions_, normals_;
  std::span<const Vec2f> uvs_;
  std::vector<uint32_t> welded_;
  std::vector<Triangle> corners_;  // of welded vertices
  std::vector<Face> faces_;
  std::vector<Vec4f> tangents_;  // [group]
};

static_assert(kNone == kNoTangent);

}  // namespace

CornerTangents make_tangents(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                             std::span<const Vec2f> uvs, std::span<const Triangle> triangles) {
  return Tangents(positions, normals, uvs, triangles).result();
}

}  // namespace kairos
