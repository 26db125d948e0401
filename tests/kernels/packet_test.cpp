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

/// As many that are parallel, from origins within `width` of each other but for how far along their way they lie: in
/// one of four draws along an axis, as those to a sun straight above are.
std::vector<Ray> parallel_bundle(std::mt19937& random, size_t count, float width) {
  std::uniform_real_distribution<float> off(-width / 2, width / 2), along(0, 1);
  Ray middle = test::random_ray(random);
  if (random() % 4 == 0) middle.direction = {0, 0, -1};
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const float x = off(random), y = off(random);
    rays.push_back({middle.origin + Vec3f{x, y, 0} + middle.direction * along(random), middle.direction});
  }
  EXPECT_TRUE(count < 2 || make_packet(rays).has_value());
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
      for (const auto& rays :
           {bundle(random, count, 1e-3f), bundle(random, count, 0.05f), parallel_bundle(random, count, 0.1f)}) {
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
      const std::vector<Ray> rays = i % 2 == 0 ? bundle(random, 16, 0.02f) : parallel_bundle(random, 16, 0.1f);
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

/// Also rays that begin amid what they are to meet, and end there.
TEST_P(Packets, AreOccludedWhenSingleRaysAre) {
  const uint32_t seed = test::seed();
  size_t instants = 0, agree = 0, covered = 0;
  const auto is_covered = [](std::span<const TimeRange> ranges, float time) {
    return std::any_of(ranges.begin(), ranges.end(),
                       [&](const TimeRange& r) { return r.begin <= time && time < r.end; });
  };
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    std::vector<Mesh> meshes{random_soup(random, motion, 30)};
    if (random() % 2) meshes[0] = test::with_random_keys(random, meshes[0], 4);
    const Tracer exact(meshes, {Precision::exact, InstructionSet::scalar});
    const Tracer fast(meshes, {Precision::fast, GetParam()});
    Tracer::Workspace workspace, single;
    for (size_t count = 1; count <= Tracer::kMaxPacket; ++count) {
      std::vector<Ray> rays = count % 3 == 0 ? bundle(random, count, 0.02f) : parallel_bundle(random, count, 0.1f);
      for (Ray& ray : rays) ray.origin.z -= static_cast<float>(count) / 2;
      TraceLimits limits;
      if (count % 2 == 0) limits = {0.2f, 0.9f, 6};
      const auto got = fast.occluded_packet(rays, workspace, limits);
      ASSERT_EQ(got.size(), count);
      for (size_t r = 0; r < count; ++r) {
        const auto want = exact.occluded(rays[r], single, limits);
        for (int k = 0; k < 64; ++k) {
          const float time = (static_cast<float>(k) + 0.5f) / 64;
          ++instants;
          covered += is_covered(want, time);
          agree += is_covered(got[r], time) == is_covered(want, time);
        }
      }
    }
  }
  EXPECT_GT(covered, instants / 20) << "seed " << seed;
  EXPECT_GE(static_cast<double>(agree), 0.997 * static_cast<double>(instants)) << "seed " << seed;
}

/// Boxes must be tested against all rays, not those in their midst.
TEST_P(Packets, MeetWhatOneOfThemAloneMeets) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 60; ++i) {
    const std::vector<Ray> rays = i % 3 == 0 ? bundle(random, 16, 0.05f) : parallel_bundle(random, 16, 0.1f);
    const Ray& one = rays[random() % rays.size()];
    Mesh mesh = random_soup(random, test::Motion::slow, 1);
    const auto set = [&](size_t triangle, Vec3f middle) {
      const Vec3f corners[3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
      for (size_t key = 0; key < 2; ++key)
        for (size_t v = 0; v < 3; ++v) mesh.positions[key][3 * triangle + v] = middle + corners[v] * 0.003f;
    };
    const Vec3f there = one.origin + one.direction * (6 + uniform(random));
    Vec3f middle{};  // of the rays, at that depth
    for (const Ray& ray : rays)
      middle += (ray.origin + ray.direction * ((there.z - ray.origin.z) / ray.direction.z)) / 16.0f;
    const uint32_t others = 40;  // on the side of the rays on which it is
    for (uint32_t t = 0; t < others; ++t) {
      mesh.triangles.push_back({3 * t + 3, 3 * t + 4, 3 * t + 5});
      for (auto& positions : mesh.positions) positions.resize(3 * (size_t{t} + 2));
      const float x = 2 + uniform(random), y = 2 + uniform(random), z = uniform(random);
      set(t + 1, there + Vec3f{std::copysign(x, there.x - middle.x), std::copysign(y, there.y - middle.y), z});
    }
    set(0, there);
    for (Vec3f& p : mesh.positions[1]) p.x += 0.0005f;  // what rests is in a tree of its own
    const Tracer tracer(std::vector{mesh}, {Precision::fast, GetParam()});
    const auto got = trace_packet(tracer, rays, Visibility::visible);
    const auto& seen = got[static_cast<size_t>(&one - rays.data())];
    ASSERT_EQ(seen.size(), 1u) << "seed " << seed;
    EXPECT_EQ(seen[0].triangle, 0u);
    EXPECT_EQ(seen[0].duration(), 1);
  }
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
      for (const auto& rays : {bundle(random, count, 0.02f), parallel_bundle(random, count, 0.1f)}) {
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
    const size_t count = 2 + random() % 15;
    const std::vector<Ray> rays = i % 2 == 0 ? bundle(random, count, 0.02f) : parallel_bundle(random, count, 0.1f);
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
  std::vector<Ray> far_apart = parallel_bundle(random, 8, 0.01f);  // as wide as all that there is
  far_apart[2].origin.x += 10;
  EXPECT_FALSE(make_packet(far_apart, 0.1f).has_value());
  std::vector<Ray> broken = bundle(random, 8, 0.01f);
  broken[0].direction.y = std::nanf("");
  Tracer::Workspace workspace;
  for (const auto& rays : {apart, wide, along_axis, broken, far_apart}) {
    EXPECT_TRUE(rays[0].direction != rays[0].direction || !make_packet(rays, 0.1f).has_value());
    const auto got = trace_packet(tracer, rays, Visibility::visible);
    for (size_t r = 0; r < rays.size(); ++r) expect_same(got[r], tracer.trace(rays[r], Visibility::visible, workspace));
  }
  EXPECT_TRUE(trace_packet(tracer, {}, Visibility::visible).empty());
  EXPECT_THROW(trace_packet(tracer, bundle(random, 17, 0.01f), Visibility::visible), Error);
  EXPECT_THROW(tracer.occluded_packet(bundle(random, 17, 0.01f), workspace), Error);
}

TEST_P(Packets, GiveTheSameBitsWithAnyVectorInstructionSet) {
  if (GetParam() == InstructionSet::scalar) GTEST_SKIP() << "it computes in double precision";
  std::mt19937 random(test::seed());
  const std::vector<Mesh> meshes{random_soup(random, test::Motion::deform, 200), still_soup(random, 50)};
  const Tracer best(meshes, {Precision::fast, supported_instruction_sets().back()});
  const Tracer tracer(meshes, {Precision::fast, GetParam()});
  for (size_t count : {2u, 4u, 5u, 16u})
    for (int i = 0; i < 20; ++i) {
      const std::vector<Ray> rays = i % 2 == 0 ? bundle(random, count, 0.01f) : parallel_bundle(random, count, 0.1f);
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
      const std::vector<Ray> rays = i % 2 == 0 ? bundle(random, 16, 0.005f) : parallel_bundle(random, 16, 0.05f);
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
