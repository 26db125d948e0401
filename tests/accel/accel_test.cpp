// The trees: everything is in them once, inside its boxes, and the same for any number of threads.
#include "accel/accel.h"

#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "soup.h"

namespace kairos {
namespace {

using Id = std::pair<uint32_t, uint32_t>;

template <int kKeys>
struct Walk {
  const Tree<kKeys>& tree;
  std::multiset<Id> found;
  uint32_t deepest = 0;

  /// Vertices at both keys must be inside `lower` and `upper` of every box above.
  void visit(NodeRef ref, const float (&lower)[kKeys][3], const float (&upper)[kKeys][3], uint32_t depth) {
    deepest = std::max(deepest, depth);
    if ((ref & kLeafBit) != 0) {
      const auto& block = tree.blocks[ref & ~kLeafBit];
      ASSERT_GE(block.count, 1u);
      ASSERT_LE(block.count, kWidth);
      for (size_t slot = 0; slot < block.count; ++slot) {
        found.insert({block.mesh[slot], block.triangle[slot]});
        for (size_t key = 0; key < kKeys; ++key)
          for (size_t vertex = 0; vertex < 3; ++vertex)
            for (size_t axis = 0; axis < 3; ++axis) {
              ASSERT_GE(block.position[key][vertex][axis][slot], lower[key][axis]);
              ASSERT_LE(block.position[key][vertex][axis][slot], upper[key][axis]);
            }
      }
      return;
    }
    const auto& node = tree.nodes[ref];
    ASSERT_GE(node.count, 2u);
    for (size_t c = 0; c < node.count; ++c) {
      float inner_lower[kKeys][3], inner_upper[kKeys][3];
      for (size_t key = 0; key < kKeys; ++key)
        for (size_t axis = 0; axis < 3; ++axis) {
          inner_lower[key][axis] = node.lower[key][axis][c];
          inner_upper[key][axis] = node.upper[key][axis][c];
          ASSERT_GE(inner_lower[key][axis], lower[key][axis]);
          ASSERT_LE(inner_upper[key][axis], upper[key][axis]);
        }
      visit(node.child[c], inner_lower, inner_upper, depth + 1);
    }
  }
  void run() {
    float lower[kKeys][3], upper[kKeys][3];
    for (auto& key : lower)
      for (float& x : key) x = -INFINITY;
    for (auto& key : upper)
      for (float& x : key) x = INFINITY;
    if (tree.root != kNoNode) visit(tree.root, lower, upper, 0);
    EXPECT_EQ(deepest, tree.depth);
  }
};

TEST(Accel, EveryTriangleIsInItsTreesOnceAndInsideItsBoxes) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes;
  meshes.push_back(test::random_soup(random, test::Motion::still, 3000));
  meshes.push_back(test::random_soup(random, test::Motion::deform, 20000));  // enough to build in parallel
  meshes.push_back(test::random_soup(random, test::Motion::violent, 5));
  Mesh& three_keys = meshes.emplace_back(test::random_soup(random, test::Motion::translation, 700));
  three_keys.key_times = {0, 0.5f, 0.5f, 1};  // with a jump, which needs no tree
  three_keys.positions.insert(three_keys.positions.begin() + 1, {three_keys.positions[0], three_keys.positions[1]});
  const Accel accel = build_accel(meshes);

  Walk<kStaticKeys> still{accel.still, {}, 0};
  still.run();
  EXPECT_EQ(still.found.size(), 3000u);
  std::map<Id, float> covered;  // shutter time for which a triangle is in some moving tree
  for (const auto& tree : accel.moving) {
    Walk<kMovingKeys> moving{tree, {}, 0};
    moving.run();
    for (const Id& id : moving.found) covered[id] += tree.time_end - tree.time_begin;
  }
  EXPECT_EQ(covered.size(), 20005u + 700u);
  for (const auto& [id, time] : covered) EXPECT_FLOAT_EQ(time, 1) << id.first;
}

TEST(Accel, TrianglesThatNoKeyMovesStandStillWhateverTheRestOfTheirMeshDoes) {
  std::mt19937 random(test::seed());
  Mesh mesh = test::random_soup(random, test::Motion::still, 100);
  mesh.positions[1][0].x += 1;  // moves triangle 0 alone
  const Accel accel = build_accel(std::vector{mesh});
  Walk<kStaticKeys> still{accel.still, {}, 0};
  still.run();
  EXPECT_EQ(still.found.size(), 99u);
  ASSERT_EQ(accel.moving.size(), 1u);
  EXPECT_EQ(accel.moving[0].blocks.size(), 1u);
}

template <int kKeys>
void expect_same(const Tree<kKeys>& a, const Tree<kKeys>& b) {
  EXPECT_EQ(a.root, b.root);
  EXPECT_EQ(a.depth, b.depth);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (size_t n = 0; n < a.nodes.size(); ++n) {
    ASSERT_EQ(a.nodes[n].count, b.nodes[n].count);
    ASSERT_EQ(std::memcmp(a.nodes[n].lower, b.nodes[n].lower, sizeof a.nodes[n].lower), 0);
    ASSERT_EQ(std::memcmp(a.nodes[n].upper, b.nodes[n].upper, sizeof a.nodes[n].upper), 0);
    ASSERT_EQ(std::memcmp(a.nodes[n].child, b.nodes[n].child, sizeof a.nodes[n].child), 0);
  }
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (size_t n = 0; n < a.blocks.size(); ++n) {
    ASSERT_EQ(a.blocks[n].count, b.blocks[n].count);
    ASSERT_EQ(std::memcmp(a.blocks[n].position, b.blocks[n].position, sizeof a.blocks[n].position), 0);
    ASSERT_EQ(std::memcmp(a.blocks[n].mesh, b.blocks[n].mesh, sizeof a.blocks[n].mesh), 0);
    ASSERT_EQ(std::memcmp(a.blocks[n].triangle, b.blocks[n].triangle, sizeof a.blocks[n].triangle), 0);
  }
}

TEST(Accel, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes;
  // Enough for several pieces per split; the second mesh is one half still.
  meshes.push_back(test::random_soup(random, test::Motion::deform, 60000));
  meshes.push_back(test::random_soup(random, test::Motion::translation, 20000));
  std::copy_n(meshes[1].positions[0].begin(), 30000, meshes[1].positions[1].begin());
  meshes.push_back(test::random_soup(random, test::Motion::still, 30000));
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return build_accel(meshes);
  };
  const Accel one = build(1);
  for (int round = 0; round < 3; ++round) {
    const Accel two = build(2);
    expect_same(one.still, two.still);
    ASSERT_EQ(one.moving.size(), two.moving.size());
    for (size_t t = 0; t < one.moving.size(); ++t) expect_same(one.moving[t], two.moving[t]);
  }
}

TEST(Accel, BlocksAreWellFilled) {
  std::mt19937 random(test::seed());
  const Accel accel = build_accel(std::vector{test::random_soup(random, test::Motion::deform, 20000)});
  // Where ranges are split without regard to blocks, these hold less than six triangles on average.
  EXPECT_LE(accel.moving.at(0).blocks.size(), 20000u / 7);
}

TEST(Accel, HostileGeometryMakesNoDeepTree) {
  // Each triangle a thousandth of the one before: every heuristic split takes off a few only.
  Mesh mesh;
  mesh.positions.resize(1);
  float size = 1e30f;
  for (uint32_t i = 0; i<50000; ++i, size = size> 1e-30f ? size * 0.999f : 1e-30f) {
    mesh.positions[0].insert(mesh.positions[0].end(), {Vec3f{size, 0, 0}, Vec3f{size, size, 0}, Vec3f{size, 0, size}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_LE(build_accel(std::vector{mesh}).depth(), 40u);
}

TEST(Accel, CoordinatesWhoseSumsOverflowDoNoHarm) {
  // Areas, centres and motions of these are infinite, or no number at all where all coordinates have one sign.
  std::mt19937 random(test::seed());
  for (const float size : {1e19f, 1e38f, 3.4e38f})
    for (const float low : {-1.0f, 0.6f}) {
      std::uniform_real_distribution<float> uniform(low, 1);
      Mesh mesh;
      mesh.key_times = {0, 1};
      mesh.positions.resize(2);
      for (uint32_t i = 0; i < 5000; ++i) {
        for (int v = 0; v < 3; ++v)
          for (auto& key : mesh.positions)
            key.push_back({size * uniform(random), size * uniform(random), size * uniform(random)});
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
      const Accel accel = build_accel(std::vector{mesh});
      Walk<kMovingKeys> walk{accel.moving.at(0), {}, 0};
      walk.run();
      EXPECT_EQ(walk.found.size(), 5000u) << size;
      EXPECT_LE(accel.depth(), 9u) << size;
    }
}

TEST(Accel, ThingsInOnePlaceThatMoveDifferentlyArePartedFirst) {
  // Two flocks that start together and fly apart: the root's children hold one of them each.
  Mesh mesh;
  mesh.key_times = {0, 1};
  mesh.positions.resize(2);
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(0, 1);
  for (uint32_t i = 0; i < 64; ++i) {
    const Vec3f move = i % 2 == 0 ? Vec3f{100, 0, 0} : Vec3f{-100, 0, 0};
    for (int v = 0; v < 3; ++v) {
      const Vec3f p{uniform(random), uniform(random), uniform(random)};
      mesh.positions[0].push_back(p - move);
      mesh.positions[1].push_back(p + move);
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Accel accel = build_accel(std::vector{mesh});
  for (const auto& block : accel.moving.at(0).blocks)
    for (size_t slot = 1; slot < block.count; ++slot) EXPECT_EQ(block.triangle[slot] % 2, block.triangle[0] % 2);
}

}  // namespace
}  // namespace kairos
