// Loop subdivision: the limit surface of meshes whose limit is known.
#include <cmath>
#include <set>

#include "pbrt_fixture.h"
#include "scene_io/pbrt/geometry.h"

namespace kairos {
namespace {

const pbrt::Place kPlace{"test", 1};
constexpr uint64_t kMany = 1 << 24;

MeshData subdivide(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles, int64_t levels) {
  return pbrt::subdivide_loop(positions, triangles, levels, kMany, kPlace);
}

const std::vector<Vec3f> kOctahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<Triangle> kOctahedronFaces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                             {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

/// A vertex's limit does not depend on the level from which it is taken.
TEST(PbrtLoop, LimitsAgreeBetweenLevels) {
  const MeshData base = subdivide(kOctahedron, kOctahedronFaces, 0);
  const std::vector<Vec3f> open{{0, 0, 0}, {2, 0, 1}, {1, 2, 0}, {-1, 1, 3}, {-2, -1, 0}, {0, -2, 1}, {3, 3, 3}};
  const std::vector<Triangle> open_faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1}, {1, 6, 2}};
  const MeshData open_base = subdivide(open, open_faces, 0);
  for (const int64_t levels : {1, 2, 4}) {
    const MeshData fine = subdivide(kOctahedron, kOctahedronFaces, levels);
    const MeshData open_fine = subdivide(open, open_faces, levels);
    EXPECT_EQ(fine.triangles.size(), 8u << (2 * levels));
    for (size_t v = 0; v < kOctahedron.size(); ++v) {
      EXPECT_LT(length(fine.positions[0][v] - base.positions[0][v]), 1e-6f) << v;
      EXPECT_LT(length(fine.normals[0][v] - base.normals[0][v]), 1e-5f) << v;
    }
    for (size_t v = 0; v < open.size(); ++v)
      EXPECT_LT(length(open_fine.positions[0][v] - open_base.positions[0][v]), 2e-6f) << v;
    for (const size_t v : {0, 6})  // inside, and a corner of one triangle
      EXPECT_GT(dot(open_fine.normals[0][v], open_base.normals[0][v]), 0.9999f) << v;
  }
}

TEST(PbrtLoop, OctahedronVertexHasItsKnownLimit) {
  // Valence 4: each neighbour weighs 1 / (4 + 3 / (8 beta)), beta = 3/32: 1/8. The neighbours' sum is zero.
  const MeshData fine = subdivide(kOctahedron, kOctahedronFaces, 3);
  EXPECT_NEAR(fine.positions[0][0].x, 0.5, 1e-6);
  EXPECT_NEAR(fine.positions[0][0].y, 0, 1e-6);
  for (size_t v = 0; v < 6; ++v) EXPECT_GT(dot(fine.normals[0][v], kOctahedron[v]), 0.99999f);
  // Closed: every edge has two triangles, in opposite directions; and V - E + F = 2.
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const Triangle& t : fine.triangles)
    for (size_t k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.count({b, a}));
  EXPECT_EQ(fine.positions[0].size() + fine.triangles.size(), edges.size() / 2 + 2);
}

TEST(PbrtLoop, TetrahedronVertexHasItsKnownLimit) {
  // Valence 3: each neighbour weighs 1 / (3 + 3 / (8 beta)), beta = 3/16: 1/5. All four vertices' sum is zero.
  const std::vector<Vec3f> p{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  for (const int64_t levels : {0, 2}) {
    const MeshData fine = subdivide(p, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}, levels);
    for (size_t v = 0; v < 4; ++v) EXPECT_LT(length(fine.positions[0][v] - p[v] * 0.2f), 1e-6f) << levels;
  }
}

/// On the regular grid Loop's scheme reproduces linear functions, and normals point to the front; on the boundary it
/// is a cubic B-spline, which does so too.
TEST(PbrtLoop, PlanesStayPlanes) {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  constexpr uint32_t kSide = 5;
  for (uint32_t y = 0; y < kSide; ++y)
    for (uint32_t x = 0; x < kSide; ++x)
      positions.push_back(
          {static_cast<float>(x), static_cast<float>(y), static_cast<float>(2 * x) + 3 * static_cast<float>(y)});
  for (uint32_t y = 0; y + 1 < kSide; ++y)
    for (uint32_t x = 0; x + 1 < kSide; ++x) {
      const uint32_t a = y * kSide + x;
      triangles.push_back({a, a + 1, a + kSide + 1});
      triangles.push_back({a, a + kSide + 1, a + kSide});
    }
  const MeshData fine = subdivide(positions, triangles, 2);
  const Vec3f normal = normalize(Vec3f{-2, -3, 1});
  for (size_t v = 0; v < fine.positions[0].size(); ++v) {
    const Vec3f& p = fine.positions[0][v];
    EXPECT_NEAR(p.z, 2 * p.x + 3 * p.y, 1e-5);
    EXPECT_GT(dot(fine.normals[0][v], normal), 0.9999f) << v;
  }
  const uint32_t inside = 2 * kSide + 2;
  EXPECT_LT(length(fine.positions[0][inside] - positions[inside]), 1e-5f);
  const uint32_t edge = 2;  // on the straight boundary, neighbours at both sides
  EXPECT_LT(length(fine.positions[0][edge] - positions[edge]), 1e-5f);
}

/// After many steps the triangles around a vertex lie in the limit's tangent plane.
TEST(PbrtLoop, NormalsAreThoseOfTheFineSurface) {
  std::vector<Vec3f> p = kOctahedron;
  p[0] = {2, 0.5f, 0.25f};  // no symmetry
  p[2] = {0.25f, 1.5f, 0.5f};
  std::vector<Triangle> open = kOctahedronFaces;
  open.erase(open.begin(), open.begin() + 2);  // and a boundary
  for (const std::vector<Triangle>& faces : {kOctahedronFaces, open}) {
    const MeshData fine = subdivide(p, faces, 6);
    std::vector<Vec3f> mean(fine.positions[0].size());
    for (const Triangle& t : fine.triangles) {
      const auto& at = fine.positions[0];
      for (const uint32_t v : t) mean[v] += normalize(cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]));
    }
    for (size_t v = 0; v < mean.size(); ++v) EXPECT_GT(dot(fine.normals[0][v], normalize(mean[v])), 0.998f) << v;
  }
}

TEST(PbrtLoop, SheetsThatMeetInAVertexAndOtherOdditiesStayFinite) {
  const std::vector<Vec3f> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  for (const std::vector<Triangle>& faces : {std::vector<Triangle>{{0, 1, 2}, {0, 3, 4}},
                                             {{0, 1, 2}, {0, 1, 2}},
                                             {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 1, 5}},
                                             {{0, 0, 1}, {0, 1, 2}},
                                             {}})
    for (const int64_t levels : {0, 3}) {
      const MeshData fine = subdivide(p, faces, levels);
      for (const Vec3f& v : fine.positions[0]) EXPECT_TRUE(is_finite(v));
      for (const Vec3f& n : fine.normals[0]) EXPECT_TRUE(is_finite(n));
    }
}

TEST(PbrtLoop, LevelsAreLimited) {
  expect_error([] { subdivide(kOctahedron, kOctahedronFaces, -1); }, {"test:1", "levels"});
  expect_error([] { subdivide(kOctahedron, kOctahedronFaces, 13); }, {"levels"});
  expect_error([] { pbrt::subdivide_loop(kOctahedron, kOctahedronFaces, 3, 511, kPlace); }, {"too many triangles"});
  EXPECT_EQ(pbrt::subdivide_loop(kOctahedron, kOctahedronFaces, 3, 512, kPlace).triangles.size(), 512u);
}

}  // namespace
}  // namespace kairos
