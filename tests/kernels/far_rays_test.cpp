// Rays from so far away that products of coordinates would overflow.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <kairos/tracer.h>

#include "soup.h"

namespace kairos {
namespace {

Tracer tracer_of(const Mesh& mesh, InstructionSet set) {
  TracerOptions options;
  options.instruction_set = set;
  return Tracer({&mesh, 1}, options);
}

/// A ray of the same line that begins `dist` before z = 10. Its coordinates are exact.
Ray from(float dist, Vec3f near_by) { return {{near_by.x, near_by.y, 10 + dist}, {0, 0, -1}}; }

TEST(FarRays, SeeWhatRaysFromNearbySee) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> place(-2, 2);
  Tracer::Workspace workspace;
  for (const test::Motion motion : {test::Motion::translation, test::Motion::deform, test::Motion::still}) {
    const Mesh mesh = test::random_soup(random, motion, 30);
    for (const InstructionSet set : supported_instruction_sets()) {
      const Tracer tracer = tracer_of(mesh, set);
      size_t seen = 0;
      for (int i = 0; i < 30; ++i) {
        const Vec3f point{place(random), place(random), 0};
        const auto near_by = tracer.trace(from(0, point), Visibility::visible, workspace);
        const std::vector<Segment> expected(near_by.begin(), near_by.end());
        seen += expected.size();
        for (int exponent = 31; exponent < 127; exponent += 5) {
          const float dist = std::ldexp(1.0f, exponent);
          const auto segments = tracer.trace(from(dist, point), Visibility::visible, workspace);
          double duration = 0, difference = 0;
          for (const Segment& s : segments) duration += static_cast<double>(s.duration());
          for (const Segment& s : expected) difference -= static_cast<double>(s.duration());
          EXPECT_NEAR(duration + difference, 0, 1e-3) << to_string(set) << " from 2^" << exponent;
          for (const Segment& s : segments) EXPECT_FLOAT_EQ(s.dist_begin, dist);
          TraceLimits limits;
          limits.max_dist = dist / 2;
          EXPECT_TRUE(tracer.trace(from(dist, point), Visibility::visible, workspace, limits).empty());
        }
      }
      EXPECT_GT(seen, 0u);
    }
  }
}

TEST(FarRays, InAPacketSeeTheSame) {
  std::mt19937 random(test::seed());
  const Mesh mesh = test::random_soup(random, test::Motion::translation, 30);
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer = tracer_of(mesh, set);
    std::vector<Ray> rays;
    for (int i = 0; i < 8; ++i) rays.push_back(from(0x1p60f, {static_cast<float>(i) / 8 - 0.5f, 0, 0}));
    Tracer::Workspace workspace, other;
    const auto results = tracer.trace_packet(rays, Visibility::visible, workspace);
    for (size_t i = 0; i < rays.size(); ++i) {
      const auto alone = tracer.trace(rays[i], Visibility::visible, other);
      EXPECT_TRUE(std::equal(alone.begin(), alone.end(), results[i].segments.begin(), results[i].segments.end(),
                             [](const Segment& a, const Segment& b) {
                               return a.begin == b.begin && a.end == b.end && a.dist_begin == b.dist_begin &&
                                      a.mesh == b.mesh && a.triangle == b.triangle;
                             }));
    }
  }
}

TEST(FarRays, ThatLookAwayOrPassByMeetNothing) {
  std::mt19937 random(test::seed());
  const Mesh mesh = test::random_soup(random, test::Motion::translation, 30);
  Tracer::Workspace workspace;
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer = tracer_of(mesh, set);
    for (const Ray& ray : {Ray{{0, 0, 0x1p60f}, {0, 0, 1}}, Ray{{0, 0x1p60f, 0x1p60f}, {0, 0, -1}},
                           Ray{{0x1p100f, 0, 0}, {0, 1, 0}}, Ray{{0x1p60f, 0x1p60f, 0x1p60f}, {-1, 0, 0}}})
      EXPECT_TRUE(tracer.trace(ray, Visibility::visible, workspace).empty()) << to_string(set);
  }
}

}  // namespace
}  // namespace kairos
