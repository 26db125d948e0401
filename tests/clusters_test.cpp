// Clusters of segments: fewer shading evaluations, the same mean, and everything that is not shading as before.
#include <cmath>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "integrators/segment_shading.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

// A fine ball that flies through the picture, and a board behind it.
Shot flying_ball(bool smooth, Material::AlphaMode mode = Material::AlphaMode::opaque) {
  Shot shot;
  shot.projection.width = 16;
  shot.projection.height = 12;
  shot.background = {0.1f, 0.2f, 0.3f};
  shot.materials = {lambert({0.9f, 0.5f, 0.3f}), lambert({0.4f, 0.4f, 0.5f})};
  shot.materials[0].alpha_mode = mode;
  shot.materials[0].alpha = mode == Material::AlphaMode::blend ? 0.6f : 1.0f;
  shot.meshes = {ball({-1, 0, -4}, 1.1f, 24, 0), parallelogram({-1, -3, -6}, {4, 0, 0}, {0, 6, 0}, 1)};
  Mesh& mesh = shot.meshes[0];
  mesh.positions.push_back(mesh.positions[0]);
  for (Vec3f& p : mesh.positions[1]) p += {2, 0.4f, 0};
  mesh.key_times = {0, 1};
  if (!smooth) mesh.normals.clear();
  return shot;
}

RenderParams tc(ShadingKind shading, Clusters clusters, int samples) {
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.shading = shading;
  params.clusters = clusters;
  params.shading_samples = samples;
  params.tc_rays = 4;
  return params;
}

const std::vector<float>& values(const Image& image, const char* channel) { return image.find(channel)->values; }

TEST(Clusters, TakeFewerEvaluationsAndLeaveTheRestAlone) {
  for (const auto mode : {Material::AlphaMode::opaque, Material::AlphaMode::blend})
    for (const bool smooth : {true, false}) {
      const Shot shot = flying_ball(smooth, mode);
      RenderStats on, off;
      RenderParams params = tc(ShadingKind::normal, Clusters::on, 1);
      params.aovs = {Aov::depth, Aov::coverage, Aov::segments, Aov::mesh};
      const Image with = render(shot, params, &on);
      params.clusters = Clusters::off;
      const Image without = render(shot, params, &off);
      EXPECT_LT(static_cast<double>(on.shading_samples), 0.5 * static_cast<double>(off.shading_samples));
      for (const char* name : {"depth.Z", "mesh.id", "segments.Y"})
        EXPECT_EQ(values(with, name), values(without, name));
      for (size_t i = 0; i < values(with, "coverage.A").size(); ++i)
        EXPECT_NEAR(values(with, "coverage.A")[i], values(without, "coverage.A")[i], 1e-6);
      EXPECT_NE(values(with, "R"), values(without, "R"));
    }
}

// Over many seeds, the mean with one sample per cluster is that with many per segment.
TEST(Clusters, AreUnbiased) {
  for (const auto mode : {Material::AlphaMode::opaque, Material::AlphaMode::blend})
    for (const ShadingKind shading : {ShadingKind::normal, ShadingKind::whitted}) {
      const Shot shot = flying_ball(true, mode);
      Renderer renderer(shot);
      const int pictures = 16;
      const size_t pixels = static_cast<size_t>(shot.projection.width) * static_cast<size_t>(shot.projection.height);
      std::vector<double> sum(pixels), squares(pixels);
      for (int i = 0; i < pictures; ++i) {
        RenderParams params = tc(shading, Clusters::on, 1);
        params.sampler = SamplerKind::random;  // independent of other seeds' to the last bit
        params.seed = static_cast<uint64_t>(i);
        const Image with = renderer.render(params);
        params.clusters = Clusters::off;
        params.shading_samples = 16;
        const Image exact = renderer.render(params);
        for (size_t p = 0; p < pixels; ++p) {
          const double difference = values(with, "G")[p] - values(exact, "G")[p];
          sum[p] += difference;
          squares[p] += difference * difference;
        }
      }
      double bias = 0, square_noise = 0, bias_squares = 0;
      for (size_t p = 0; p < pixels; ++p) {
        const double mean = sum[p] / pictures, variance = squares[p] / pictures - mean * mean;
        bias += mean;
        bias_squares += mean * mean;
        square_noise += variance / (pictures - 1);
      }
      ASSERT_GT(square_noise, 0);
      EXPECT_LT(std::abs(bias), 4.5 * std::sqrt(square_noise)) << "of the whole picture";
      EXPECT_LT(bias_squares, 1.5 * square_noise) << "of single pixels";
    }
}

// What later stages are told: every instant of every segment exactly once, on its own triangle, at its own distance.
TEST(Clusters, PartsCoverEverySegmentExactly) {
  const Shot shot = flying_ball(true);
  const Shader shader(shot, ShadingKind::normal, false);
  const PixelContext context{CameraRays(shot.projection), Sampler(SamplerKind::owen_sobol, 4, 0),
                             PixelFilter(FilterKind::box), shader};
  const Tracer tracer(shot.meshes, {Precision::fast, {}});
  Tracer::Workspace workspace;
  size_t longest = 0;
  for (const int samples : {1, 4, 50}) {
    SegmentShading shading(context, {samples, true});
    for (int y = 0; y < shot.projection.height; ++y)
      for (int x = 0; x < shot.projection.width; ++x) {
        const SamplePoint point{0.3f, 0.6f, 0.7f};
        const Ray ray = context.ray(x, y, point);
        const auto segments = tracer.trace(ray, Visibility::visible, workspace);
        std::vector<ShadedSegment> parts;
        shading.shade(ray, segments, {}, 77, 0, point.time, parts);
        longest = std::max(longest, segments.size());
        size_t next = 0;
        for (const Segment& segment : segments) {
          float time = segment.begin, dist = segment.dist_begin;
          for (; next < parts.size() && parts[next].end <= segment.end; ++next) {
            EXPECT_EQ(parts[next].begin, time);
            EXPECT_LT(parts[next].begin, parts[next].end);
            EXPECT_EQ(parts[next].dist_begin, dist);
            EXPECT_EQ(parts[next].mesh, segment.mesh);
            EXPECT_EQ(parts[next].triangle, segment.triangle);
            time = parts[next].end;
            dist = parts[next].dist_end;
          }
          EXPECT_EQ(time, segment.end);
          EXPECT_EQ(dist, segment.dist_end);
        }
        EXPECT_EQ(next, parts.size());
      }
  }
  EXPECT_GT(longest, 10u) << "a fine mesh";
}

// Whitted shading is worth it, the others are not; the picture says which it was.
TEST(Clusters, AutomaticIsOnForWhitted) {
  const Shot shot = flying_ball(true);
  for (const ShadingKind shading : {ShadingKind::normal, ShadingKind::flat, ShadingKind::whitted}) {
    const bool expected = shading == ShadingKind::whitted;
    RenderParams params = tc(shading, Clusters::automatic, 2);
    const Image automatic = render(shot, params);
    params.clusters = expected ? Clusters::on : Clusters::off;
    const Image chosen = render(shot, params);
    EXPECT_EQ(values(automatic, "R"), values(chosen, "R"));
    std::string said;
    for (const Attribute& attribute : automatic.attributes)
      if (attribute.name == "kairos:clusters") said = std::get<std::string>(attribute.value);
    EXPECT_EQ(said, expected ? "on" : "off");
  }
}

// One colour all over: one evaluation stands for all that touches, and is exact.
TEST(Clusters, OfOneColourAreExact) {
  const Shot shot = flying_ball(true);
  RenderStats on, off;
  const Image with = render(shot, tc(ShadingKind::flat, Clusters::on, 8), &on);
  const Image without = render(shot, tc(ShadingKind::flat, Clusters::off, 8), &off);
  EXPECT_LT(on.shading_samples, off.shading_samples);
  for (size_t i = 0; i < values(with, "R").size(); ++i)
    EXPECT_NEAR(values(with, "R")[i], values(without, "R")[i], 1e-6);
}

}  // namespace
}  // namespace kairos
