// What is asked of a ray beyond its direction: a window of time, a largest distance, and whether anything is there.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/tracer.h>

#include "soup.h"

namespace kairos {
namespace {

constexpr int kInstants = 64;

float instant(int k) { return (static_cast<float>(k) + 0.5f) / kInstants; }

float distance_at(const Segment& s, float time) {
  return s.dist_begin + (s.dist_end - s.dist_begin) * ((time - s.begin) / s.duration());
}

bool inside(const TraceLimits& limits, const Segment& s, float time) {
  return s.begin <= time && time < s.end && limits.window_begin <= time && time < limits.window_end &&
         distance_at(s, time) <= limits.max_dist;
}

/// How many of the segments are there at `time`, within the limits.
int64_t count_at(std::span<const Segment> segments, const TraceLimits& limits, float time) {
  int64_t count = 0;
  for (const Segment& s : segments) count += inside(limits, s, time);
  return count;
}

void expect_inside(std::span<const Segment> segments, const TraceLimits& limits) {
  for (const Segment& s : segments) {
    EXPECT_GE(s.begin, limits.window_begin);
    EXPECT_LT(s.begin, s.end);
    EXPECT_LE(s.end, limits.window_end);
    EXPECT_LE(std::max(s.dist_begin, s.dist_end), limits.max_dist);
  }
}

/// Triangles of all kinds of motion, of one key span or several, and what stands still.
std::vector<Mesh> any_meshes(std::mt19937& random, test::Motion motion) {
  std::vector<Mesh> meshes{test::random_soup(random, motion, 60)};
  if (random() % 2) {
    meshes[0].positions.insert(meshes[0].positions.begin() + 1, test::positions_at(meshes[0], 0.375f));
    meshes[0].key_times = {0, 0.375f, 1};
  }
  if (random() % 2) meshes.push_back(test::random_soup(random, test::Motion::still, 4));
  return meshes;
}

TraceLimits any_limits(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  TraceLimits limits;
  if (random() % 4 != 0) {
    const float a = uniform(random), b = uniform(random);
    limits.window_begin = std::min(a, b);
    limits.window_end = std::max(a, b);
  }
  if (random() % 2) limits.max_dist = 2 + 10 * uniform(random);
  return limits;
}

class Limits : public testing::TestWithParam<std::tuple<InstructionSet, Precision>> {
 protected:
  static TracerOptions options() {
    TracerOptions options;
    options.instruction_set = std::get<0>(GetParam());
    options.precision = std::get<1>(GetParam());
    return options;
  }
};

TEST_P(Limits, LeaveOfTheWholeAnswerWhatIsInside) {
  const uint32_t seed = test::seed();
  size_t instants = 0, agree = 0;
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    for (int scene = 0; scene < 4; ++scene) {
      const Tracer tracer(any_meshes(random, motion), options());
      Tracer::Workspace workspace, limited;
      for (int i = 0; i < 40; ++i) {
        const Ray ray = test::random_ray(random);
        const TraceLimits limits = any_limits(random);
        for (const Visibility visibility : {Visibility::visible, Visibility::all}) {
          const auto whole = tracer.trace(ray, visibility, workspace);
          const auto got = tracer.trace(ray, visibility, limited, limits);
          expect_inside(got, limits);
          for (int k = 0; k < kInstants; ++k) {
            ++instants;
            agree += count_at(whole, limits, instant(k)) == count_at(got, {}, instant(k));
            if (visibility == Visibility::visible && count_at(got, {}, instant(k)) == 1)
              agree -= test::triangle_at(whole, instant(k)) != test::triangle_at(got, instant(k));
          }
        }
      }
    }
  }
  EXPECT_GE(static_cast<double>(agree), 0.999 * static_cast<double>(instants)) << "seed " << seed;
}

TEST_P(Limits, HoldForPackets) {
  const uint32_t seed = test::seed();
  size_t instants = 0, agree = 0;
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    const Tracer tracer(any_meshes(random, motion), options());
    Tracer::Workspace workspace, alone;
    std::uniform_real_distribution<float> off(-0.02f, 0.02f);
    for (int i = 0; i < 20; ++i) {
      const Ray middle = test::random_ray(random);
      const TraceLimits limits = any_limits(random);
      std::vector<Ray> rays;
      for (int r = 0; r < 16; ++r)
        rays.push_back({middle.origin, middle.direction + Vec3f{off(random), off(random), 0}});
      const auto seen = tracer.trace_packet(rays, Visibility::visible, workspace, {}, true, limits);
      for (size_t r = 0; r < rays.size(); ++r) {
        expect_inside(seen[r].segments, limits);
        const auto want = tracer.trace(rays[r], Visibility::visible, alone, limits);
        for (int k = 0; k < kInstants; ++k) {
          ++instants;
          agree += test::triangle_at(want, instant(k)) == test::triangle_at(seen[r].segments, instant(k));
        }
      }
    }
  }
  EXPECT_GE(static_cast<double>(agree), 0.995 * static_cast<double>(instants)) << "seed " << seed;
}

TEST_P(Limits, OccludedIsWhenAnythingIsMet) {
  const uint32_t seed = test::seed();
  size_t instants = 0, agree = 0;
  for (const test::Motion motion : test::kAllMotions) {
    std::mt19937 random(seed + static_cast<uint32_t>(motion));
    for (int scene = 0; scene < 4; ++scene) {
      const Tracer tracer(any_meshes(random, motion), options());
      Tracer::Workspace workspace, occluded;
      for (int i = 0; i < 40; ++i) {
        const Ray ray = test::random_ray(random);
        const TraceLimits limits = any_limits(random);
        const auto whole = tracer.trace(ray, Visibility::all, workspace);
        const auto got = tracer.occluded(ray, occluded, limits);
        for (size_t r = 0; r < got.size(); ++r) {
          EXPECT_GE(got[r].begin, r == 0 ? limits.window_begin : got[r - 1].end);
          EXPECT_LT(got[r].begin, got[r].end);
          EXPECT_LE(got[r].end, limits.window_end);
        }
        for (int k = 0; k < kInstants; ++k) {
          const bool covered = std::any_of(
              got.begin(), got.end(), [&](const TimeRange& r) { return r.begin <= instant(k) && instant(k) < r.end; });
          ++instants;
          agree += covered == (count_at(whole, limits, instant(k)) > 0);
        }
      }
    }
  }
  EXPECT_GE(static_cast<double>(agree), 0.999 * static_cast<double>(instants)) << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(Kernels, Limits,
                         testing::Combine(testing::ValuesIn(supported_instruction_sets().begin(),
                                                            supported_instruction_sets().end()),
                                          testing::Values(Precision::fast, Precision::exact)),
                         [](const auto& instance) {
                           return std::string(to_string(std::get<0>(instance.param))) +
                                  (std::get<1>(instance.param) == Precision::fast ? "_fast" : "_exact");
                         });

/// A triangle that is before the ray from 0.4375 to 0.5625, at distance 2.
Mesh passing_triangle() {
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = {0, 1};
  mesh.positions = {{{-5, -1, 0}, {-3, -1, 0}, {-4, 1, 0}}, {{3, -1, 0}, {5, -1, 0}, {4, 1, 0}}};
  return mesh;
}

/// A large triangle before the ray, `dist` away at the begin and `dist_end` at the end of the shutter.
Mesh wall(float dist, float dist_end) {
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = {0, 1};
  for (const float d : {dist, dist_end})
    mesh.positions.push_back({{-99, -99, 2 - d}, {99, -99, 2 - d}, {0, 99, 2 - d}});
  if (dist == dist_end) {
    mesh.key_times = {0};
    mesh.positions.resize(1);
  }
  return mesh;
}

constexpr Ray kRay{{0, 0, 2}, {0, 0, -1}};

TEST(Limits, AreExact) {
  const Tracer tracer(std::vector{passing_triangle(), wall(8, 4)});
  Tracer::Workspace workspace;
  const auto seen = tracer.trace(kRay, Visibility::visible, workspace, {0.5f, 0.625f, 10});
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].begin, 0.5f);
  EXPECT_EQ(seen[0].end, 0.5625f);
  EXPECT_EQ(seen[1].mesh, 1u);
  EXPECT_EQ(seen[1].end, 0.625f);
  EXPECT_EQ(seen[1].dist_end, 5.5f);
  // The wall comes within a distance of 5 three quarters through.
  const auto near = tracer.trace(kRay, Visibility::all, workspace, {0, 1, 5});
  ASSERT_EQ(near.size(), 2u);
  EXPECT_EQ(near[1].begin, 0.75f);
  EXPECT_EQ(near[1].dist_begin, 5);
  EXPECT_EQ(near[1].dist_end, 4);
  const auto covered = tracer.occluded(kRay, workspace, {0.5f, 1, 5});
  ASSERT_EQ(covered.size(), 2u);
  EXPECT_EQ(covered[0].begin, 0.5f);
  EXPECT_EQ(covered[0].end, 0.5625f);
  EXPECT_EQ(covered[1].begin, 0.75f);
  EXPECT_EQ(covered[1].end, 1);
}

TEST(Limits, OccludedLooksNoFurtherOnceTheWindowIsFull) {
  std::mt19937 random(test::seed());
  // Neither what stands still in front of the soup nor behind it leaves anything to be found.
  for (const float dist : {1.0f, 99.0f}) {
    const Tracer tracer(std::vector{wall(dist, dist), test::random_soup(random, test::Motion::translation, 2000)});
    Tracer::Workspace workspace;
    const auto covered = tracer.occluded(kRay, workspace);
    ASSERT_EQ(covered.size(), 1u);
    EXPECT_EQ(covered[0].begin, 0);
    EXPECT_EQ(covered[0].end, 1);
    EXPECT_EQ(workspace.counters().triangles, 1u);
  }
  // A wall that moves, behind thousands: its hit fills the window, however narrow that is.
  std::vector<Mesh> meshes{test::random_soup(random, test::Motion::translation, 2000), wall(3, 3.5f)};
  const Tracer tracer(meshes);
  Tracer::Workspace whole, window;
  const size_t covered = tracer.occluded(kRay, whole).size();
  EXPECT_EQ(covered, 1u);
  EXPECT_EQ(tracer.occluded(kRay, window, {0.49f, 0.51f}).size(), 1u);
  Tracer::Workspace visible;
  tracer.trace(kRay, Visibility::all, visible);
  EXPECT_LT(whole.counters().triangles, visible.counters().triangles / 2);
  EXPECT_LE(window.counters().triangles, whole.counters().triangles);
}

/// Mesh 0 has a hole from 0.5 on, or is blended.
class Hole : public CutOuts {
 public:
  explicit Hole(bool blended) : blended_(blended) {}
  bool has(uint32_t mesh) const override { return mesh == 0; }
  bool is_blended(uint32_t mesh) const override { return blended_ && mesh == 0; }
  bool solid(const Ray&, uint32_t, uint32_t, float time) const override { return time < 0.5f; }
  void solid_times(const Ray&, const Segment& hit, std::vector<float>& times) const override {
    times.clear();
    if (hit.begin < 0.5f) times = {hit.begin, std::min(hit.end, 0.5f)};
  }

 private:
  bool blended_;
};

TEST(Limits, OccludedRespectsCutOutsAndPassesThroughBlendedSurfaces) {
  for (const bool blended : {false, true}) {
    TracerOptions options;
    options.cut_outs = std::make_shared<Hole>(blended);
    const Tracer tracer(std::vector{passing_triangle()}, options);
    Tracer::Workspace workspace;
    const auto covered = tracer.occluded(kRay, workspace);
    ASSERT_EQ(covered.size(), blended ? 0u : 1u);
    if (blended) continue;
    EXPECT_EQ(covered[0].begin, 0.4375f);
    EXPECT_EQ(covered[0].end, 0.5f);
    tracer.trace(kRay, Visibility::visible, workspace, {0.5f, 1});
    EXPECT_TRUE(workspace.blended().empty());
  }
  TracerOptions options;
  options.cut_outs = std::make_shared<Hole>(true);
  const Tracer tracer(std::vector{passing_triangle()}, options);
  Tracer::Workspace workspace;
  EXPECT_TRUE(tracer.trace(kRay, Visibility::visible, workspace, {0.5f, 1}).empty());
  ASSERT_EQ(workspace.blended().size(), 1u);
  EXPECT_EQ(workspace.blended()[0].begin, 0.5f);
}

TEST(Limits, ThatMakeNoSenseAreRefused) {
  const Tracer tracer(std::vector{passing_triangle()});
  Tracer::Workspace workspace;
  for (const TraceLimits& limits :
       {TraceLimits{0.5f, 0.5f}, TraceLimits{0.6f, 0.5f}, TraceLimits{-0.1f, 0.5f}, TraceLimits{0.5f, 1.1f},
        TraceLimits{std::nanf(""), 1}, TraceLimits{0, 1, 0}, TraceLimits{0, 1, -1}, TraceLimits{0, 1, std::nanf("")}}) {
    EXPECT_THROW(tracer.trace(kRay, Visibility::visible, workspace, limits), Error);
    EXPECT_THROW(tracer.occluded(kRay, workspace, limits), Error);
    EXPECT_THROW(tracer.trace_packet(std::vector{kRay}, Visibility::visible, workspace, {}, true, limits), Error);
    EXPECT_THROW(tracer.trace(std::vector{kRay}, Visibility::visible, nullptr, limits), Error);
  }
}

}  // namespace
}  // namespace kairos
