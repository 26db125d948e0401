// Packets of rays against single ones.
#include "kernels/packet.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/tracer.h>

#include "soup.h"

namespace kairos {
namespace {

using test::random_soup;

/// `count` rays from one random origin that go about the same way.
std::vector<Ray> bundle(std::mt19937& random, size_t count, float width) {
  std::uniform_real_distribution<float> off(-width, width);
  const Ray middle = test::random_ray(random);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const float x = off(random), y = off(random);
    rays.push_back({middle.origin, middle.direction + Vec3f{x, y, 0}});
  }
  return rays;
}

std::vector<std::vector<Segment>> trace_packet(const Tracer& tracer, std::span<const Ray> rays, Visibility visibility) {
  Tracer::Workspace workspace;
  std::vector<std::vector<Segment>> results;
  for (const SeenByRay& seen : tracer.trace_packet(rays, visibility, workspace))
    results.emplace_back(seen.segments.begin(), seen.segments.end());
  return results;
}

void expect_same(std::span<const Segment> a, std::span<const Segment> b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].begin, b[i].begin);
    EXPECT_EQ(a[i].end, b[i].end);
    EXPECT_EQ(a[i].dist_begin, b[i].dist_begin);
    EXPECT_EQ(a[i].dist_end, b[i].dist_end);
    EXPECT_EQ(a[i].triangle, b[i].triangle);
    EXPECT_EQ(a[i].front, b[i].front);
  }
}

class Packets : public testing::TestWithParam<InstructionSet> {};

TEST_P(Packets, AgreeWithExactSingleRaysAtAlmostAllInstants) {
  const uint32_t seed = test::seed();
  size_t instants = 0, agree = 0;
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    Mesh mesh = random_soup(random, motion, 200);
    if (random() % 2) {  // over several key spans
      const std::vector<Vec3f> middle = test::positions_at(mesh, 0.375f);
      mesh.positions.insert(mesh.positions.begin() + 1, middle);
      mesh.key_times = {0, 0.375f, 1};
    }
    const Tracer exact(std::vector{mesh}, {Precision::exact, InstructionSet::scalar});
    const Tracer fast(std::vector{mesh}, {Precision::fast, GetParam()});
    for (size_t count = 2; count <= Tracer::kMaxPacket; ++count)
      for (const float width : {1e-3f, 0.05f}) {
        const std::vector<Ray> rays = bundle(random, count, width);
        const auto got = trace_packet(fast, rays, Visibility::visible);
        ASSERT_EQ(got.size(), count);
        Tracer::Workspace workspace;
        for (size_t r = 0; r < count; ++r) {
          const auto want = exact.trace(rays[r], Visibility::visible, workspace);
          for (int k = 0; k < 64; ++k) {
            const float time = (static_cast<float>(k) + 0.5f) / 64;
            ++instants;
            agree += test::triangle_at(want, time) == test::triangle_at(got[r], time);
          }
        }
      }
  }
  EXPECT_GE(static_cast<double>(agree), 0.995 * static_cast<double>(instants)) << "seed " << seed;
}

TEST_P(Packets, MeetTheTrianglesThatSingleRaysMeet) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  size_t segments = 0, different = 0;
  for (const test::Motion motion : {test::Motion::translation, test::Motion::violent, test::Motion::sliver}) {
    const Tracer tracer(std::vector{random_soup(random, motion, 200)}, {Precision::fast, GetParam()});
    Tracer::Workspace workspace;
    for (int i = 0; i < 40; ++i) {
      const std::vector<Ray> rays = bundle(random, 16, 0.02f);
      const auto got = trace_packet(tracer, rays, Visibility::all);
      for (size_t r = 0; r < rays.size(); ++r) {
        const auto want = tracer.trace(rays[r], Visibility::all, workspace);
        segments += want.size();
        if (got[r].size() != want.size()) {
          ++different;  // a sliver more or less
          continue;
        }
        for (size_t s = 0; s < want.size(); ++s)
          different += std::abs(got[r][s].begin - want[s].begin) > 1e-3f ||
                       std::abs(got[r][s].dist_begin - want[s].dist_begin) > 1e-3f * want[s].dist_begin;
      }
    }
  }
  EXPECT_LE(different, segments / 200) << "of " << segments << ", seed " << seed;
}

Mesh still_soup(std::mt19937& random, uint32_t count) {
  Mesh mesh = random_soup(random, test::Motion::still, count);
  mesh.positions.resize(1);
  return mesh;
}

TEST_P(Packets, SeeTheNearestOfWhatStandsStill) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  size_t rays_traced = 0, agree = 0;
  for (int round = 0; round < 8; ++round) {
    const std::vector<Mesh> meshes{still_soup(random, 30), still_soup(random, 300)};
    const Tracer exact(meshes, {Precision::exact, InstructionSet::scalar});
    const Tracer fast(meshes, {Precision::fast, GetParam()});
    Tracer::Workspace workspace;
    for (size_t count = 2; count <= Tracer::kMaxPacket; ++count)
      for (const float width : {1e-3f, 0.02f}) {
        const std::vector<Ray> rays = bundle(random, count, width);
        const auto got = trace_packet(fast, rays, Visibility::visible);
        for (size_t r = 0; r < count; ++r) {
          const auto want = exact.trace(rays[r], Visibility::visible, workspace);
          ++rays_traced;
          ASSERT_LE(got[r].size(), 1u);
          if (got[r].size() != want.size()) continue;
          if (want.empty() || (got[r][0].mesh == want[0].mesh && got[r][0].triangle == want[0].triangle)) ++agree;
          if (want.empty()) continue;
          EXPECT_EQ(got[r][0].begin, 0);
          EXPECT_EQ(got[r][0].end, 1);
          EXPECT_EQ(got[r][0].dist_begin, got[r][0].dist_end);
          if (got[r][0].triangle != want[0].triangle) continue;
          EXPECT_NEAR(got[r][0].dist_begin, want[0].dist_begin, 1e-4f * want[0].dist_begin);
          EXPECT_EQ(got[r][0].front, want[0].front);
        }
      }
  }
  EXPECT_GE(static_cast<double>(agree), 0.998 * static_cast<double>(rays_traced)) << "seed " << seed;
}

TEST_P(Packets, MeetAllOfWhatStandsStill) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const Tracer tracer(std::vector{still_soup(random, 300)}, {Precision::fast, GetParam()});
  Tracer::Workspace workspace;
  size_t met = 0, different = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<Ray> rays = bundle(random, 2 + random() % 15, 0.02f);
    const auto got = trace_packet(tracer, rays, Visibility::all);
    for (size_t r = 0; r < rays.size(); ++r) {
      const auto want = tracer.trace(rays[r], Visibility::all, workspace);
      met += want.size();
      different += !std::equal(want.begin(), want.end(), got[r].begin(), got[r].end(),
                               [](const Segment& a, const Segment& b) { return a.triangle == b.triangle; });
    }
  }
  EXPECT_GT(met, 300u);
  EXPECT_LE(different, met / 100) << "of " << met << ", seed " << seed;
}

TEST_P(Packets, StandStillBehindWhatIsKnownToHideThem) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const Tracer tracer(std::vector{still_soup(random, 300)}, {Precision::fast, GetParam()});
  Tracer::Workspace workspace, single;
  size_t hidden = 0, in_front = 0, wrong = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<Ray> rays = bundle(random, 16, 0.02f);
    std::vector<Segment> hints(rays.size(), Segment{0, 1, 8, 8, 7, 9, true});
    const auto seen = tracer.trace_packet(rays, Visibility::visible, workspace, hints);
    for (size_t r = 0; r < rays.size(); ++r) {
      const auto free = tracer.trace(rays[r], Visibility::visible, single);
      const bool is_in_front = !free.empty() && free[0].dist_begin < 8;
      ++(is_in_front ? in_front : hidden);
      ASSERT_EQ(seen[r].segments.size(), 1u);
      wrong += seen[r].segments[0].mesh != (is_in_front ? 0u : 7u) ||
               seen[r].segments[0].triangle != (is_in_front ? free[0].triangle : 9u);
    }
  }
  EXPECT_GT(hidden, 20u);
  EXPECT_GT(in_front, 20u);
  EXPECT_LE(wrong, 6u) << "of 640, seed " << seed;  // at edges
}

TEST_P(Packets, AreTracedOneByOneWhereTheyShareNothing) {
  std::mt19937 random(test::seed());
  const Tracer tracer(std::vector{random_soup(random, test::Motion::deform, 200)}, {Precision::fast, GetParam()});
  std::vector<Ray> apart;  // origins differ
  for (int i = 0; i < 8; ++i) apart.push_back(test::random_ray(random));
  std::vector<Ray> wide = bundle(random, 8, 0.01f);
  wide[3].direction = wide[3].direction * -1.0f;
  std::vector<Ray> along_axis = bundle(random, 8, 0.01f);
  along_axis[5].direction.x = 0;
  std::vector<Ray> broken = bundle(random, 8, 0.01f);
  broken[0].direction.y = std::nanf("");
  Tracer::Workspace workspace;
  for (const auto& rays : {apart, wide, along_axis, broken}) {
    EXPECT_TRUE(rays[0].direction != rays[0].direction || !make_packet(rays).has_value());
    const auto got = trace_packet(tracer, rays, Visibility::visible);
    for (size_t r = 0; r < rays.size(); ++r) expect_same(got[r], tracer.trace(rays[r], Visibility::visible, workspace));
  }
  EXPECT_TRUE(trace_packet(tracer, {}, Visibility::visible).empty());
  EXPECT_THROW(trace_packet(tracer, bundle(random, 17, 0.01f), Visibility::visible), Error);
}

TEST_P(Packets, GiveTheSameBitsWithAnyVectorInstructionSet) {
  if (GetParam() == InstructionSet::scalar) GTEST_SKIP() << "it computes in double precision";
  std::mt19937 random(test::seed());
  const std::vector<Mesh> meshes{random_soup(random, test::Motion::deform, 200), still_soup(random, 50)};
  const Tracer best(meshes, {Precision::fast, supported_instruction_sets().back()});
  const Tracer tracer(meshes, {Precision::fast, GetParam()});
  for (size_t count : {2u, 4u, 5u, 16u})
    for (int i = 0; i < 20; ++i) {
      const std::vector<Ray> rays = bundle(random, count, 0.01f);
      const auto want = trace_packet(best, rays, Visibility::visible);
      const auto got = trace_packet(tracer, rays, Visibility::visible);
      for (size_t r = 0; r < count; ++r) expect_same(got[r], want[r]);
    }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, Packets,
                         testing::ValuesIn(supported_instruction_sets().begin(), supported_instruction_sets().end()),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

TEST(Packets, ShareMostOfTheirWork) {
  std::mt19937 random(test::seed());
  for (const Mesh& mesh : {random_soup(random, test::Motion::translation, 2000), still_soup(random, 2000)}) {
    const Tracer tracer(std::vector{mesh}, {Precision::fast, {}});
    if (tracer.instruction_set() == InstructionSet::scalar) GTEST_SKIP() << "no vector instructions here";
    Tracer::Workspace alone, together;
    for (int i = 0; i < 20; ++i) {
      const std::vector<Ray> rays = bundle(random, 16, 0.005f);
      for (const Ray& ray : rays) tracer.trace(ray, Visibility::visible, alone);
      tracer.trace_packet(rays, Visibility::visible, together);
    }
    EXPECT_EQ(together.counters().rays, alone.counters().rays);
    EXPECT_LT(together.counters().nodes, alone.counters().nodes / 4);
    EXPECT_LT(together.counters().triangles, alone.counters().triangles / 3);
  }
}

}  // namespace
}  // namespace kairos
