// The trees: everything is in them once, inside its boxes, and the same for any number of threads.
#include "accel/accel.h"

#include <cstring>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "soup.h"

namespace kairos {
namespace {

using Id = std::pair<uint32_t, uint32_t>;

/// A child's box, and when it is there.
struct Box {
  double lower[2][3], upper[2][3];
  float begin, end;

  template <int kKeys>
  Box(const Node<kKeys>& node, size_t child, float window_begin, float window_end)
      : begin(window_begin), end(window_end) {
    for (size_t key = 0; key < 2; ++key)
      for (size_t axis = 0; axis < 3; ++axis) {
        lower[key][axis] = static_cast<double>(node.lower[key % kKeys][axis][child]);
        upper[key][axis] = static_cast<double>(node.upper[key % kKeys][axis][child]);
      }
  }

  /// Vertices at one key, which lies inside the window.
  void expect_inside(const float (&position)[3][3][kWidth], size_t slot, float time) const {
    ASSERT_GE(time, begin);
    ASSERT_LE(time, end);
    const double at = (static_cast<double>(time) - static_cast<double>(begin)) /
                      (static_cast<double>(end) - static_cast<double>(begin));
    for (const auto& vertex : position)
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto x = static_cast<double>(vertex[axis][slot]);
        const auto bound = [&](const double(&of)[2][3]) { return of[0][axis] + at * (of[1][axis] - of[0][axis]); };
        ASSERT_GE(x, bound(lower));
        ASSERT_LE(x, bound(upper));
      }
  }
};

/// Vertices at all keys must be inside every box above them.
struct StillWalk {
  const StillTree& tree;
  std::multiset<Id> found;
  uint32_t deepest = 0;
  std::vector<Box> above;

  void run() {
    if (tree.root != kNoNode) visit(tree.root);
    EXPECT_EQ(deepest, tree.depth);
  }
  void visit(NodeRef ref) {
    deepest = std::max(deepest, static_cast<uint32_t>(above.size()));
    if ((ref & kLeafBit) == 0) {
      const auto& node = tree.nodes[ref];
      ASSERT_GE(node.count, 2u);
      for (size_t c = 0; c < node.count; ++c) {
        above.emplace_back(node, c, 0.0f, 1.0f);
        visit(node.child[c]);
        above.pop_back();
      }
      return;
    }
    const auto& block = tree.blocks[ref & ~kLeafBit];
    ASSERT_GE(block.count, 1u);
    ASSERT_LE(block.count, kWidth);
    for (size_t slot = 0; slot < block.count; ++slot) {
      found.insert({block.mesh[slot], block.triangle[slot]});
      for (const Box& box : above) box.expect_inside(block.position[0], slot, 0);
    }
  }
};

struct MovingWalk {
  const MovingTree& tree;
  std::map<Id, std::vector<std::pair<float, float>>> found;  ///< key spans
  size_t lanes = 0, stored = 0;                              ///< key spans that are there, and those that have memory
  uint32_t deepest = 0;
  std::vector<Box> above;

  void run() {
    if (tree.root != kNoNode) visit(tree.root);
    EXPECT_EQ(deepest, tree.depth);
    for (auto& [id, spans] : found) {  // together they are the shutter, without an overlap
      std::sort(spans.begin(), spans.end());
      float until = 0;
      for (const auto& [begin, end] : spans) {
        EXPECT_EQ(begin, until) << id.first;
        until = end;
      }
      EXPECT_EQ(until, 1) << id.first;
    }
  }
  void visit(NodeRef ref) {
    deepest = std::max(deepest, static_cast<uint32_t>(above.size()));
    if ((ref & kLeafBit) == 0) {
      const auto& node = tree.nodes[ref];
      ASSERT_GE(node.count, 2u);
      for (size_t c = 0; c < node.count; ++c) {
        const bool windows = !tree.windows.empty();
        above.emplace_back(node, c, windows ? tree.windows[ref].begin.lane[c] : 0.0f,
                           windows ? tree.windows[ref].end.lane[c] : 1.0f);
        visit(node.child[c]);
        above.pop_back();
      }
      return;
    }
    const auto& block = tree.blocks[ref & ~kLeafBit];
    ASSERT_GE(block.count, 1u);
    ASSERT_LE(block.count, kWidth);
    ASSERT_GE(block.spans, 1u);
    stored += size_t{block.spans} * kWidth;
    for (size_t slot = 0; slot < block.count; ++slot)
      for (uint32_t key = 0; key <= block.spans; ++key) {
        const Row* times = &tree.times[block.first_time + key];
        const float time = times[0].lane[slot];
        ASSERT_TRUE(!block.same_times || time == times[0].lane[0]);
        for (const Box& box : above) box.expect_inside(tree.keys[block.first_key + key].position, slot, time);
        if (key == block.spans || time == times[1].lane[slot]) continue;
        ++lanes;
        found[{block.mesh[slot], block.triangle[slot]}].push_back({time, times[1].lane[slot]});
      }
  }
};

TEST(Accel, EveryTriangleIsThereAtAllTimesOnceAndInsideItsBoxes) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes;
  meshes.push_back(test::random_soup(random, test::Motion::still, 3000));
  meshes.push_back(test::random_soup(random, test::Motion::deform, 20000));  // enough to build in parallel
  meshes.push_back(test::random_soup(random, test::Motion::violent, 5));
  Mesh& jumping = meshes.emplace_back(test::random_soup(random, test::Motion::translation, 700));
  jumping.key_times = {0, 0.5f, 0.5f, 1};  // a jump takes no time
  jumping.positions.insert(jumping.positions.begin() + 1, {jumping.positions[0], jumping.positions[1]});
  // Keys of their own for everybody, and many that turn about: split in time.
  for (uint32_t keys = 2; keys < 20; ++keys)
    meshes.push_back(test::with_random_keys(random, test::random_soup(random, test::Motion::violent, 3), keys));
  meshes.push_back(test::with_random_keys(random, test::random_soup(random, test::Motion::violent, 2000), 17));
  const Accel accel = build_accel(meshes);

  StillWalk still{accel.still, {}, 0, {}};
  still.run();
  EXPECT_EQ(still.found.size(), 3000u);
  MovingWalk moving{accel.moving, {}, 0, 0, 0, {}};
  moving.run();
  EXPECT_EQ(moving.found.size(), 20005u + 700u + 18 * 3 + 2000u);
  EXPECT_FALSE(accel.moving.windows.empty()) << "nothing was split in time";
}

TEST(Accel, TrianglesOfManyMeshesShareBlocksWhateverTheirKeys) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes;
  for (int i = 0; i < 1024; ++i)
    meshes.push_back(test::with_random_keys(random, test::random_soup(random, test::Motion::translation, 1), 3));
  const Accel accel = build_accel(meshes);
  EXPECT_LE(accel.moving.blocks.size(), 1024u / 6);
  // Where key spans differ in number, what is repeated takes no more than what is there.
  for (int i = 0; i < 1024; ++i) {
    const uint32_t keys = 2 + static_cast<uint32_t>(random() % 30);
    meshes.push_back(test::with_random_keys(random, test::random_soup(random, test::Motion::translation, 1), keys));
  }
  const Accel mixed = build_accel(meshes);
  MovingWalk walk{mixed.moving, {}, 0, 0, 0, {}};
  walk.run();
  EXPECT_LE(walk.stored, 4 * walk.lanes);
}

TEST(Accel, KeysOfNeighbouringSpansAreStoredOnce) {
  std::mt19937 random(test::seed());
  const Mesh one = test::random_soup(random, test::Motion::translation, 5000);
  const Mesh many = test::with_random_keys(random, one, 17, 0.001f);
  const auto bytes = [](const Mesh& mesh) { return build_accel(std::vector{mesh}).memory_bytes(); };
  EXPECT_LE(bytes(many), bytes(one) * 17 / 2 * 5 / 4) << "seventeen keys in place of two, and a quarter more";
}

TEST(Accel, TrianglesThatNoKeyMovesStandStillWhateverTheRestOfTheirMeshDoes) {
  std::mt19937 random(test::seed());
  Mesh mesh = test::random_soup(random, test::Motion::still, 100);
  mesh.positions[1][0].x += 1;  // moves triangle 0 alone
  const Accel accel = build_accel(std::vector{mesh});
  StillWalk still{accel.still, {}, 0, {}};
  still.run();
  EXPECT_EQ(still.found.size(), 99u);
  EXPECT_EQ(accel.moving.blocks.size(), 1u);
}

void expect_same_bytes(const auto& a, const auto& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), bytes_of(a)) == 0);
}

template <int kKeys>
void expect_same_nodes(const LargeArray<Node<kKeys>>& a, const LargeArray<Node<kKeys>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t n = 0; n < a.size(); ++n) {
    ASSERT_EQ(a[n].count, b[n].count);
    ASSERT_EQ(std::memcmp(a[n].lower, b[n].lower, sizeof a[n].lower), 0);
    ASSERT_EQ(std::memcmp(a[n].upper, b[n].upper, sizeof a[n].upper), 0);
    ASSERT_EQ(std::memcmp(a[n].child, b[n].child, sizeof a[n].child), 0);
  }
}

void expect_same_ids(const auto& a, const auto& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t n = 0; n < a.size(); ++n) {
    ASSERT_EQ(a[n].count, b[n].count);
    ASSERT_EQ(std::memcmp(a[n].mesh, b[n].mesh, sizeof a[n].mesh), 0);
    ASSERT_EQ(std::memcmp(a[n].triangle, b[n].triangle, sizeof a[n].triangle), 0);
  }
}

void expect_same(const Accel& a, const Accel& b) {
  EXPECT_EQ(a.still.root, b.still.root);
  EXPECT_EQ(a.still.depth, b.still.depth);
  expect_same_nodes(a.still.nodes, b.still.nodes);
  expect_same_ids(a.still.blocks, b.still.blocks);
  for (size_t n = 0; n < a.still.blocks.size(); ++n)
    ASSERT_EQ(std::memcmp(a.still.blocks[n].position, b.still.blocks[n].position, sizeof a.still.blocks[n].position),
              0);
  EXPECT_EQ(a.moving.root, b.moving.root);
  EXPECT_EQ(a.moving.depth, b.moving.depth);
  expect_same_nodes(a.moving.nodes, b.moving.nodes);
  expect_same_ids(a.moving.blocks, b.moving.blocks);
  for (size_t n = 0; n < a.moving.blocks.size(); ++n) {
    ASSERT_EQ(a.moving.blocks[n].spans, b.moving.blocks[n].spans);
    ASSERT_EQ(a.moving.blocks[n].first_key, b.moving.blocks[n].first_key);
    ASSERT_EQ(a.moving.blocks[n].first_time, b.moving.blocks[n].first_time);
  }
  expect_same_bytes(a.moving.windows, b.moving.windows);
  expect_same_bytes(a.moving.keys, b.moving.keys);
  expect_same_bytes(a.moving.times, b.moving.times);
}

TEST(Accel, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes;
  // Enough for several pieces per split; the second mesh is one half still.
  meshes.push_back(test::random_soup(random, test::Motion::deform, 60000));
  meshes.push_back(test::random_soup(random, test::Motion::translation, 20000));
  std::copy_n(meshes[1].positions[0].begin(), 30000, meshes[1].positions[1].begin());
  meshes.push_back(test::random_soup(random, test::Motion::still, 30000));
  meshes.push_back(test::with_random_keys(random, test::random_soup(random, test::Motion::violent, 20000), 5));
  const auto build = [&](int threads) {
    Accel accel;
    with_threads(threads, [&] { accel = build_accel(meshes); });
    return accel;
  };
  const Accel one = build(1);
  for (int round = 0; round < 3; ++round) {
    const Accel two = build(2);
    expect_same(one, two);
  }
}

TEST(Accel, BlocksAreWellFilled) {
  std::mt19937 random(test::seed());
  const Accel accel = build_accel(std::vector{test::random_soup(random, test::Motion::deform, 20000)});
  // Where ranges are split without regard to blocks, these hold less than six triangles on average.
  EXPECT_LE(accel.moving.blocks.size(), 20000u / 7);
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
      mesh.key_times = {0, 0.5f, 1};
      mesh.positions.resize(3);
      for (uint32_t i = 0; i < 5000; ++i) {
        for (int v = 0; v < 3; ++v)
          for (auto& key : mesh.positions)
            key.push_back({size * uniform(random), size * uniform(random), size * uniform(random)});
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
      const Accel accel = build_accel(std::vector{mesh});
      MovingWalk walk{accel.moving, {}, 0, 0, 0, {}};
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
  for (const auto& block : accel.moving.blocks)
    for (size_t slot = 1; slot < block.count; ++slot) EXPECT_EQ(block.triangle[slot] % 2, block.triangle[0] % 2);
}

}  // namespace
}  // namespace kairos
