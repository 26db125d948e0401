// Clusters of segments: fewer shading evaluations, the same mean, and everything that is not shading as before.
#include <cmath>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include <kairos/picture.h>
#include <kairos/render.h>

#include "integrators/integrator.h"
#include "shading/packet_shading.h"
#include "shading/surface.h"
#include "soup.h"
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
  shot.lights = {ConstantLight{{0.4f, 0.4f, 0.4f}}, DirectionalLight{normalize(Vec3f{0.5f, -0.7f, -1}), {2, 2, 2}}};
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
  using Mode = Material::AlphaMode;
  using Case = std::tuple<Mode, ShadingKind, Clusters>;
  for (const auto& [mode, shading, clusters] :
       {Case{Mode::opaque, ShadingKind::normal, Clusters::on}, Case{Mode::blend, ShadingKind::normal, Clusters::on},
        Case{Mode::opaque, ShadingKind::whitted, Clusters::on}, Case{Mode::blend, ShadingKind::whitted, Clusters::on},
        Case{Mode::opaque, ShadingKind::normal, Clusters::pixel}}) {
    const Shot shot = flying_ball(true, mode);
    Renderer renderer(shot);
    const int pictures = 16;
    const size_t pixels = static_cast<size_t>(shot.projection.width) * static_cast<size_t>(shot.projection.height);
    std::vector<double> sum(pixels), squares(pixels);
    for (int i = 0; i < pictures; ++i) {
      RenderParams params = tc(shading, clusters, 1);
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

// Where colours are functions of time, triangles of a smooth surface share shading, too, and an eighth of the shutter's
// time looks as if each had been shaded alone.
TEST(Clusters, ShareColoursOverTime) {
  for (const auto mode : {Material::AlphaMode::opaque, Material::AlphaMode::blend}) {
    const Shot shot = flying_ball(true, mode);
    Renderer renderer(shot);
    const auto eighth = [&](Clusters clusters, int samples, uint64_t& evaluations) {
      RenderParams params = tc(ShadingKind::normal, clusters, samples);
      Picture picture(shot.projection, params, TimeWeight({{0.5, 8}, {0.625, 8}}));
      PixelConsumer* const consumer = &picture;
      RenderStats stats;
      renderer.render(params, {&consumer, 1}, &stats);
      evaluations = stats.shading_samples;
      return picture.take();
    };
    uint64_t with = 0, without = 0, many = 0;
    const Image shared = eighth(Clusters::on, 8, with), alone = eighth(Clusters::off, 8, without),
                exact = eighth(Clusters::off, 256, many);
    EXPECT_LT(static_cast<double>(with), 0.6 * static_cast<double>(without));
    const auto error = [&](const Image& image) {
      double squares = 0;
      for (size_t i = 0; i < values(exact, "G").size(); ++i)
        squares += std::pow(values(image, "G")[i] - values(exact, "G")[i], 2);
      return std::sqrt(squares / static_cast<double>(values(exact, "G").size()));
    };
    EXPECT_LT(error(shared), 0.01) << "and " << error(alone) << " alone";
    EXPECT_GT(error(shared), 0) << "else nothing was shared";
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
    SegmentShading shading(context.shader, {static_cast<double>(samples), Clusters::on});
    for (int y = 0; y < shot.projection.height; ++y)
      for (int x = 0; x < shot.projection.width; ++x) {
        const SamplePoint point{0.3f, 0.6f, 0.7f};
        const Ray ray = context.ray(x, y, point);
        const auto segments = tracer.trace(ray, Visibility::visible, workspace);
        RecordBuilder record;
        shading.shade(ray, segments, {}, {0, 1}, 77, 0, point.time, record);
        const std::span<const SeenPart> parts = record.parts();
        longest = std::max(longest, segments.size());
        size_t next = 0;
        for (const Segment& segment : segments) {
          float time = segment.begin, dist = segment.dist_begin;
          for (; next < parts.size() && parts[next].where.end <= segment.end; ++next) {
            EXPECT_EQ(parts[next].where.begin, time);
            EXPECT_LT(parts[next].where.begin, parts[next].where.end);
            EXPECT_EQ(parts[next].where.dist_begin, dist);
            EXPECT_EQ(parts[next].where.mesh, segment.mesh);
            EXPECT_EQ(parts[next].where.triangle, segment.triangle);
            time = parts[next].where.end;
            dist = parts[next].where.dist_end;
          }
          EXPECT_EQ(time, segment.end);
          EXPECT_EQ(dist, segment.dist_end);
        }
        EXPECT_EQ(next, parts.size());
      }
  }
  EXPECT_GT(longest, 10u) << "a fine mesh";
}

// The same of rays that are shaded together, over more parts than there are segments, and over fewer.
TEST(PixelClusters, PartsCoverEverySegmentOfEveryRayExactly) {
  const Shot shot = flying_ball(true);
  const Shader normals(shot, ShadingKind::normal, false, 0, nullptr, true), lit(shot, ShadingKind::whitted, false);
  const Tracer tracer(shot.meshes, {Precision::fast, {}});
  Tracer::Workspace workspace;
  size_t shared = 0, cut = 0;
  for (const auto& [shader, samples, surfaces] : {std::tuple{&normals, 1, true},
                                                  {&normals, 8, true},
                                                  {&normals, 300, true},
                                                  {&lit, 1, true},
                                                  {&lit, 8, false},
                                                  {&lit, 20, true}}) {
    const PixelContext context{CameraRays(shot.projection), Sampler(SamplerKind::owen_sobol, 16, 0),
                               PixelFilter(FilterKind::box), *shader};
    PacketShading shading(context.shader, {static_cast<double>(samples), Clusters::pixel});
    for (int y = 0; y < shot.projection.height; ++y)
      for (int x = 0; x < shot.projection.width; ++x) {
        std::vector<Ray> rays;
        std::vector<float> phases(16, 0.5f);
        const Sampler::Pixel pixel = context.sampler.pixel(x, y);
        for (uint32_t i = 0; i < 16; ++i) rays.push_back(context.ray(x, y, context.sampler.point(pixel, i)));
        const auto seen = tracer.trace_packet(rays, Visibility::visible, workspace);
        RecordBuilder record(surfaces);
        std::vector<uint32_t> ends;
        const uint64_t before = shading.evaluations();
        shading.shade({rays, seen, phases, pixel.seed, 0}, record, ends);
        const std::span<const SeenPart> parts = record.parts();
        ASSERT_EQ(ends.size(), rays.size());
        size_t next = 0, segments = 0;
        for (size_t r = 0; r < rays.size(); ++r) {
          for (const Segment& segment : seen[r].segments) {
            ++segments;
            float time = segment.begin, dist = segment.dist_begin;
            for (; next < ends[r] && parts[next].where.end <= segment.end; ++next) {
              EXPECT_EQ(parts[next].where.begin, time);
              EXPECT_LT(parts[next].where.begin, parts[next].where.end);
              EXPECT_EQ(parts[next].where.dist_begin, dist);
              EXPECT_EQ(parts[next].where.triangle, segment.triangle);
              time = parts[next].where.end;
              dist = parts[next].where.dist_end;
            }
            EXPECT_EQ(time, segment.end);
            EXPECT_EQ(dist, segment.dist_end);
          }
          EXPECT_EQ(next, ends[r]);
        }
        shared += shading.evaluations() - before < segments;
        cut += parts.size() > segments;
      }
  }
  EXPECT_GT(shared, 0u);
  EXPECT_GT(cut, 0u);
}

// With enough samples the colour is that of shading every segment by itself, many times over: of single-sided and
// shiny turns too.
TEST(PixelClusters, ConvergeToTheSegmentsOwnColours) {
  for (const bool smooth : {true, false}) {
    const Shot shot = flying_ball(smooth);
    RenderParams params = tc(ShadingKind::normal, Clusters::off, 64);
    params.tc_rays = 16;
    const Image exact = render(shot, params);
    params.clusters = Clusters::pixel;
    double few = 0, many = 0;
    for (const int samples : {1, 64}) {
      params.shading_samples = samples;
      RenderStats stats;
      const Image image = render(shot, params, &stats);
      double& sum = samples == 1 ? few : many;
      for (const char* channel : {"R", "G", "B"})
        for (size_t i = 0; i < values(exact, channel).size(); ++i)
          sum += std::pow(
              static_cast<double>(values(image, channel)[i]) - static_cast<double>(values(exact, channel)[i]), 2);
    }
    EXPECT_LT(std::sqrt(many / (3 * 16 * 12)), 5e-4) << "of unit colours, smooth " << smooth;
    if (smooth) {
      EXPECT_LT(many, 0.1 * few);
    }
  }
}

// Triangles turn while they fly: what is found to vary does, and by no more than is said.
TEST(ColourVariation, BoundsHowNormalsDiffer) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  Shot shot;
  shot.meshes = {test::random_soup(random, test::Motion::deform, 50),
                 test::random_soup(random, test::Motion::still, 50)};
  shot.meshes[1].positions.resize(1);
  shot.materials.resize(1);
  const Shader shader(shot, ShadingKind::normal, false, 0, nullptr, true);
  size_t vary = 0;
  for (uint32_t m = 0; m < 2; ++m)
    for (uint32_t t = 0; t < shot.meshes[m].triangles.size(); ++t) {
      const auto normal_at = [&](float time) { return geometric_normal(triangle_at(shot.meshes[m], t, time)); };
      for (int k = 0; k < 8; ++k) {
        const float begin = static_cast<float>(k) / 8, end = begin + 0.125f;
        const double difference = length(normal_at(end) - normal_at(begin));
        const float said = shader.variation(m, t, end - begin);
        EXPECT_GE(said + 1e-5, std::min<double>(difference, 3.9 / 8)) << "seed " << seed;  // the table ends there
        vary += said > 0.02f;
      }
      if (m == 1) {
        EXPECT_EQ(shader.variation(m, t, 1), 0);
      }
    }
  EXPECT_GT(vary, 50u);
}

// What a pixel's rays see together is shaded together unless one asks for something else; the picture says so.
TEST(Clusters, AutomaticIsPixel) {
  const Shot shot = flying_ball(true);
  for (const ShadingKind shading : {ShadingKind::normal, ShadingKind::flat, ShadingKind::whitted}) {
    RenderParams params = tc(shading, Clusters::automatic, 2);
    const Image automatic = render(shot, params);
    params.clusters = Clusters::pixel;
    const Image chosen = render(shot, params);
    EXPECT_EQ(values(automatic, "R"), values(chosen, "R"));
    std::string said;
    for (const Attribute& attribute : automatic.attributes)
      if (attribute.name == "kairos:clusters") said = std::get<std::string>(attribute.value);
    EXPECT_EQ(said, "pixel");
  }
}

// Few samples over all that a pixel's rays see, against some in each of their segments, along the very same rays: in
// the mean over seeds the same light, in all of the picture and in its columns.
TEST(ListedShading, TheMeanIsThatOfSegmentsByThemselves) {
  Shot shot = flying_ball(true);
  shot.lights.push_back(PointLight{{1.5f, 1, -3}, {6, 6, 6}});  // the ball's shadow goes over the board
  Renderer renderer(shot);
  const uint64_t first_seed = test::seed();
  constexpr int kSeeds = 32;
  std::vector<double> sum(17), squares(17);  // of differences: columns, and all
  for (int i = 0; i < kSeeds; ++i) {
    RenderParams params = tc(ShadingKind::whitted, Clusters::pixel, 2);
    params.seed = first_seed + static_cast<uint64_t>(i);
    RenderStats few;
    const Image listed = renderer.render(params, &few);
    params.clusters = Clusters::off;
    RenderStats many;
    const Image single = renderer.render(params, &many);
    EXPECT_LT(2 * few.shading_samples, many.shading_samples);
    std::vector<double> difference(17);
    for (size_t p = 0; p < 16 * 12; ++p) {
      const double d = static_cast<double>(values(listed, "G")[p]) - static_cast<double>(values(single, "G")[p]);
      difference[p % 16] += d / 12;
      difference[16] += d / (16 * 12);
    }
    for (size_t c = 0; c < 17; ++c) {
      sum[c] += difference[c] / kSeeds;
      squares[c] += difference[c] * difference[c] / kSeeds;
    }
  }
  for (size_t c = 0; c < 17; ++c) {
    const double error = std::sqrt(std::max(0.0, squares[c] - sum[c] * sum[c]) / (kSeeds - 1));
    EXPECT_LE(std::abs(sum[c]), 6 * error + 1e-6) << "column " << c << ", 16: all";
  }
}

// Colours are shared along the list; surfaces are not.
TEST(ListedShading, EveryPartHasItsOwnNormalAndAlbedo) {
  const Shot shot = flying_ball(false);
  RenderParams params = tc(ShadingKind::whitted, Clusters::pixel, 1);
  params.aovs = {Aov::normal, Aov::albedo, Aov::depth, Aov::coverage};
  const Image listed = render(shot, params);
  params.clusters = Clusters::off;
  const Image single = render(shot, params);
  for (const char* channel : {"normal.X", "normal.Y", "normal.Z", "albedo.R", "albedo.B", "depth.Z", "coverage.A"})
    for (size_t i = 0; i < values(single, channel).size(); ++i) {
      if (std::isinf(values(single, channel)[i])) continue;
      EXPECT_NEAR(values(listed, channel)[i], values(single, channel)[i], 2e-6) << channel << " " << i;
    }
  EXPECT_NE(values(listed, "R"), values(single, "R"));
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
