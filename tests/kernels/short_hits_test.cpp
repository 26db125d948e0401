// What is met for a short time only, on triangles seen nearly edge-on, is seen as well.
#include <random>

#include <gtest/gtest.h>

#include <kairos/tracer.h>

#include "soup.h"

namespace kairos {
namespace {

double total(std::span<const Segment> segments) {
  double sum = 0;
  for (const Segment& s : segments) sum += s.duration();
  return sum;
}

TEST(ShortHits, ALoneTriangleIsSeenWheneverItIsMet) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto vector = [&](float size) {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    return Vec3f{size * x, size * y, size * z};
  };
  // Fast past the ray and turning on the way; an end of a hit may be moved by a millionth of the shutter.
  constexpr double kEnds = 4e-6;
  int met_shortly = 0;
  for (int i = 0; i < 30000; ++i) {
    Mesh mesh;
    mesh.name = "triangle";
    mesh.triangles = {{0, 1, 2}};
    mesh.key_times = {0, 1};
    mesh.positions.resize(2);
    const Vec3f center = Vec3f{0, 0, -5} + vector(1);
    const Vec3f move{100 * uniform(random), 100 * uniform(random), 0};
    for (int v = 0; v < 3; ++v) {
      mesh.positions[0].push_back(center - move + vector(0.5f));
      mesh.positions[1].push_back(center + move + vector(0.5f));
    }
    const Ray ray{{}, center + vector(0.1f)};
    const Tracer tracer(std::span<const Mesh>(&mesh, 1));
    Tracer::Workspace workspace;
    const double met = total(tracer.trace(ray, Visibility::all, workspace));
    met_shortly += met > 1e-5 && met < 1e-3;
    ASSERT_NEAR(total(tracer.trace(ray, Visibility::visible, workspace)), met, kEnds) << "triangle " << i;
  }
  EXPECT_GT(met_shortly, 1000);
}

}  // namespace
}  // namespace kairos
