// The tracer on random moving triangles: every instruction set and precision against the scalar reference, and the
// properties that any answer must have.
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include <kairos/tracer.h>

#include "kernels/moving_triangle.h"
#include "soup.h"

namespace kairos {
namespace {

using test::random_ray;
using test::random_soup;

constexpr double kExactTime = 1e-6;  // of the shutter
/// Float arithmetic on coordinates of about 10: a rounding of 1e-6 in place, divided by the speed with which an edge
/// passes the ray. Rays and triangles for which that is slow are few, hence a share and not a maximum.
constexpr double kFastShare = 0.995;

class TracerOnSoup : public testing::TestWithParam<InstructionSet> {};

std::vector<Segment> trace(const Tracer& tracer, const Ray& ray, Visibility visibility) {
  Tracer::Workspace workspace;
  const auto span = tracer.trace(ray, visibility, workspace);
  return {span.begin(), span.end()};
}

TEST_P(TracerOnSoup, MeetsTheSameTrianglesAsTheReferenceAtTheSameTimes) {
  const uint32_t seed = test::seed();
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    const std::vector<Mesh> meshes{random_soup(random, motion, 200)};
    const Tracer reference(meshes, {Precision::exact, InstructionSet::scalar});
    const Tracer exact(meshes, {Precision::exact, GetParam()});
    for (int r = 0; r < 300; ++r) {
      const Ray ray = random_ray(random);
      const auto want = trace(reference, ray, Visibility::all), got = trace(exact, ray, Visibility::all);
      ASSERT_EQ(got.size(), want.size()) << "seed " << seed << " motion " << int(motion) << " ray " << r;
      for (size_t i = 0; i < want.size(); ++i) {
        EXPECT_EQ(got[i].triangle, want[i].triangle) << "seed " << seed;
        EXPECT_EQ(got[i].front, want[i].front);
        EXPECT_NEAR(got[i].begin, want[i].begin, kExactTime);
        EXPECT_NEAR(got[i].end, want[i].end, kExactTime);
        EXPECT_NEAR(got[i].dist_begin, want[i].dist_begin, 1e-4 * want[i].dist_begin);
      }
    }
  }
}

TEST_P(TracerOnSoup, FastAgreesWithExactAtAlmostAllInstants) {
  const uint32_t seed = test::seed();
  size_t instants = 0, agree = 0;
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    const std::vector<Mesh> meshes{random_soup(random, motion, 200)};
    const Tracer exact(meshes, {Precision::exact, InstructionSet::scalar});
    const Tracer fast(meshes, {Precision::fast, GetParam()});
    for (int r = 0; r < 300; ++r) {
      const Ray ray = random_ray(random);
      const auto want = trace(exact, ray, Visibility::visible), got = trace(fast, ray, Visibility::visible);
      for (int k = 0; k < 64; ++k) {
        const float time = (static_cast<float>(k) + 0.5f) / 64;
        ++instants;
        agree += test::triangle_at(want, time) == test::triangle_at(got, time);
      }
    }
  }
  EXPECT_GE(static_cast<double>(agree), kFastShare * static_cast<double>(instants)) << "seed " << seed;
}

TEST_P(TracerOnSoup, SeesTheNearestTriangleAtEveryInstant) {
  const uint32_t seed = test::seed();
  size_t instants = 0, wrong = 0;
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    const std::vector<Mesh> meshes{random_soup(random, motion, 200)};
    const Tracer tracer(meshes, {Precision::exact, GetParam()});
    for (int r = 0; r < 200; ++r) {
      const Ray ray = random_ray(random);
      const auto seen = trace(tracer, ray, Visibility::visible);
      for (size_t i = 0; i < seen.size(); ++i) {
        ASSERT_LT(seen[i].begin, seen[i].end);
        ASSERT_GE(seen[i].begin, i == 0 ? 0 : seen[i - 1].end) << "seed " << seed;
        ASSERT_LE(seen[i].end, 1);
      }
      for (int k = 0; k < 64; ++k) {
        const float time = std::uniform_real_distribution<float>(0, 1)(random);
        ++instants;
        wrong += test::triangle_at(seen, time) != test::nearest_at(meshes[0], ray, time);
      }
    }
  }
  // Instants within rounding of a segment's end, or two triangles that pass through each other, may differ.
  EXPECT_LE(wrong, instants / 1000) << "seed " << seed;
}

TEST_P(TracerOnSoup, KeysOnTheWayChangeNothing) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const Mesh two = random_soup(random, test::Motion::deform, 100);
  Mesh many = two;
  many.key_times = {0, 0.25f, 0.375f, 1};
  many.positions.clear();
  for (float time : many.key_times) many.positions.push_back(test::positions_at(two, time));
  const Tracer tracer_two(std::vector{two}, {Precision::exact, GetParam()});
  const Tracer tracer_many(std::vector{many}, {Precision::exact, GetParam()});
  size_t segments = 0, different = 0;
  for (int r = 0; r < 500; ++r) {
    const Ray ray = random_ray(random);
    const auto a = trace(tracer_two, ray, Visibility::visible), b = trace(tracer_many, ray, Visibility::visible);
    segments += a.size();
    if (a.size() != b.size()) {  // a sliver where three ends fall together
      ++different;
      continue;
    }
    for (size_t i = 0; i < a.size(); ++i) {
      different += a[i].triangle != b[i].triangle;
      EXPECT_NEAR(a[i].begin, b[i].begin, 1e-3) << "seed " << seed;
      EXPECT_NEAR(a[i].end, b[i].end, 1e-3) << "seed " << seed;
    }
  }
  EXPECT_LE(different, segments / 200) << "seed " << seed;
}

TEST_P(TracerOnSoup, BatchesGiveWhatSingleRaysGive) {
  std::mt19937 random(test::seed());
  const std::vector<Mesh> meshes{random_soup(random, test::Motion::translation, 100),
                                 random_soup(random, test::Motion::still, 100)};
  const Tracer tracer(meshes, {Precision::fast, GetParam()});
  std::vector<Ray> rays;
  for (int r = 0; r < 1000; ++r) rays.push_back(random_ray(random));
  TraceCounters counters;
  const SegmentBatch batch = tracer.trace(rays, Visibility::visible, &counters);
  ASSERT_EQ(batch.offsets.size(), rays.size() + 1);
  for (size_t r = 0; r < rays.size(); ++r) {
    const auto one = trace(tracer, rays[r], Visibility::visible);
    ASSERT_EQ(batch[r].size(), one.size());
    for (size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(batch[r][i].begin, one[i].begin);
      EXPECT_EQ(batch[r][i].mesh, one[i].mesh);
      EXPECT_EQ(batch[r][i].triangle, one[i].triangle);
    }
  }
  EXPECT_EQ(counters.rays, rays.size());
  EXPECT_EQ(counters.segments, batch.segments.size());
}

TEST_P(TracerOnSoup, RaysThatAreNoneMeetNothing) {
  std::mt19937 random(test::seed());
  const Tracer tracer(std::vector{random_soup(random, test::Motion::deform, 100)}, {Precision::exact, GetParam()});
  const float nan = std::nanf(""), inf = INFINITY;
  for (const Ray& ray : {Ray{{0, 0, 0}, {0, 0, 0}}, Ray{{nan, 0, 0}, {0, 0, -1}}, Ray{{0, 0, 0}, {0, inf, -1}}})
    EXPECT_TRUE(trace(tracer, ray, Visibility::all).empty());
}

TEST_P(TracerOnSoup, DirectionsOfAnyLengthSeeTheSame) {
  std::mt19937 random(test::seed());
  std::vector<Mesh> meshes{random_soup(random, test::Motion::deform, 60), random_soup(random, test::Motion::still, 20)};
  meshes[1].positions.resize(1);
  for (const Precision precision : {Precision::fast, Precision::exact}) {
    const Tracer tracer(meshes, {precision, GetParam()});
    for (int r = 0; r < 50; ++r) {
      Ray ray = random_ray(random);
      ray.direction = {0.25f, 0.25f * static_cast<float>(1 + random() % 3), -1};  // few bits, so that none is lost
      const auto want = trace(tracer, ray, Visibility::visible);
      for (const int exponent : {-146, -126, -100, -31, 40, 126}) {  // denormals first
        Ray scaled = ray;
        for (int k = 0; k < 3; ++k) scaled.direction[k] = std::ldexp(ray.direction[k], exponent);
        const auto got = trace(tracer, scaled, Visibility::visible);
        ASSERT_EQ(got.size(), want.size()) << "2^" << exponent;
        Tracer::Workspace workspace;
        const std::vector<Ray> both{scaled, scaled};
        const auto packet = tracer.trace_packet(both, Visibility::visible, workspace);
        for (size_t i = 0; i < want.size(); ++i) {
          EXPECT_EQ(got[i].begin, want[i].begin);
          EXPECT_EQ(got[i].end, want[i].end);
          EXPECT_EQ(got[i].triangle, want[i].triangle);
          EXPECT_EQ(got[i].dist_end, std::ldexp(want[i].dist_end, -exponent));
        }
        EXPECT_EQ(packet[1].segments.size(), want.size());
      }
    }
  }
}

TEST(MovingTriangle, EveryIntervalIsFoundHoweverManyThereAre) {
  // Where in [0, 1] a ray meets a triangle of wild motion, by the signs of its edge functions at many instants.
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<double> uniform(-1, 1);
  int most = 0;
  for (int round = 0; round < 200000; ++round) {
    FramedTriangle<double> framed{};
    std::array<Quadratic<double>, 3> edges;
    for (Quadratic<double>& e : edges) {  // mostly with two roots, so that there are many intervals
      const double from = uniform(random), to = uniform(random), middle = uniform(random);
      e = {std::abs(from), -std::abs(middle), std::abs(to)};
    }
    for (auto& key : framed.dist)
      for (double& dist : key) dist = uniform(random);
    const HitIntervals<double> found = intersect_moving_triangle(framed, edges);
    most = std::max(most, found.count);
    if (found.count < 4) continue;
    for (int k = 0; k < 200; ++k) {
      const double time = (k + 0.5) / 200;
      double sum = 0, least = INFINITY, greatest = -INFINITY;
      for (size_t i = 0; i < 3; ++i) {
        const double e = edges[i].at(time);
        least = std::min(least, e);
        greatest = std::max(greatest, e);
        sum += e * (framed.dist[0][i] + time * (framed.dist[1][i] - framed.dist[0][i]));
      }
      if (std::min(std::abs(least), std::abs(greatest)) < 1e-9 || std::abs(sum) < 1e-9) continue;
      const bool met = (least > 0 && sum > 0) || (greatest < 0 && sum < 0);
      int times_met = 0;
      for (int i = 0; i < found.count; ++i)
        times_met += found.hit[static_cast<size_t>(i)].begin <= time && time < found.hit[static_cast<size_t>(i)].end;
      ASSERT_EQ(times_met, met ? 1 : 0) << round << " at " << time;
    }
  }
  EXPECT_GE(most, 4);
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, TracerOnSoup,
                         testing::ValuesIn(supported_instruction_sets().begin(), supported_instruction_sets().end()),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

TEST(Tracer, AnEmptySceneShowsNothing) {
  const Tracer tracer(std::span<const Mesh>{});
  EXPECT_TRUE(trace(tracer, {{0, 0, 0}, {0, 0, -1}}, Visibility::visible).empty());
}

}  // namespace
}  // namespace kairos
