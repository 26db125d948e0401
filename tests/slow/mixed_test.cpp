// Time-continuous and discrete rays in one pixel: the mask of what moves, and that the mixture is neither biased nor
// noisier than its parts.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "camera/camera_rays.h"
#include "motion/motion_mask.h"
#include "soup.h"

namespace kairos {
namespace {

constexpr int kWidth = 48, kHeight = 32;

Shot shot_of(std::vector<Mesh> meshes) {
  Shot shot;
  shot.meshes = std::move(meshes);
  shot.background = {0.2f, 0.4f, 0.1f};
  shot.materials.resize(shot.meshes.size());
  for (size_t m = 0; m < shot.meshes.size(); ++m) {
    shot.meshes[m].material = static_cast<uint32_t>(m);
    shot.materials[m].base_color = {1.0f / static_cast<float>(m + 1), static_cast<float>(m % 3) / 2, 0.5f};
  }
  shot.projection.width = kWidth;
  shot.projection.height = kHeight;
  return shot;
}

Mesh still_soup(std::mt19937& random, uint32_t count) {
  Mesh mesh = test::random_soup(random, test::Motion::still, count);
  mesh.positions.resize(1);
  return mesh;
}

/// Of the whole frame.
MotionMask mask_of(const Shot& shot, double margin) {
  return {std::make_shared<const ScreenMotion>(shot, margin), Crop{0, kWidth, 0, kHeight}};
}

TEST(MotionMask, HoldsEveryPixelInWhichSomethingMovingIsSeen) {
  std::mt19937 random(test::seed());
  size_t moving = 0;  // of all kinds of motion together: four triangles may all lie beside the picture
  for (const test::Motion motion : test::kAllMotions) {
    if (motion == test::Motion::still) continue;
    const Shot shot = shot_of({still_soup(random, 5), test::random_soup(random, motion, 4)});
    const MotionMask mask = mask_of(shot, 0.5);
    const Tracer tracer(shot.meshes);
    Tracer::Workspace workspace;
    const CameraRays camera(shot.projection);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (const double offset : {0.01, 0.5, 0.99})
          for (const Segment& s : tracer.trace(camera.at(x + offset, y + offset), Visibility::all, workspace))
            if (s.mesh == 1) {
              ++moving;
              ASSERT_TRUE(mask.moves(x, y)) << x << ' ' << y << " motion " << int(motion);
            }
  }
  EXPECT_GT(moving, 0u);
}

TEST(MotionMask, KnowsTheDirectionOfMotionThatHasOne) {
  const auto triangle = [](Vec3f motion) {
    Mesh mesh;
    mesh.triangles = {{0, 1, 2}};
    mesh.positions = {{{-1, -1, -4}, {1, -1, -4}, {0, 1, -4}}};
    mesh.positions.push_back(mesh.positions[0]);
    for (Vec3f& p : mesh.positions[1]) p += motion;
    mesh.key_times = {0, 1};
    return mesh;
  };
  const int x = kWidth / 2, y = kHeight / 2;
  // The screen's second axis points down. There and back again is one direction.
  const MotionMask along = mask_of(shot_of({triangle({0.2f, -0.1f, 0}), triangle({-0.1f, 0.05f, 0})}), 0);
  ASSERT_TRUE(along.direction(x, y).has_value());
  EXPECT_NEAR(*along.direction(x, y), std::atan2(1, 2), 0.01);
  const MotionMask apart = mask_of(shot_of({triangle({0.2f, 0, 0}), triangle({0, 0.2f, 0})}), 0);
  EXPECT_FALSE(apart.direction(x, y).has_value());
  EXPECT_FALSE(along.direction(0, 0).has_value()) << "nothing moves there";
}

TEST(MotionMask, FollowsPathsPastTheCamera) {
  // From straight ahead to behind the camera on the right: on screen it leaves by the right border.
  Mesh bar;
  bar.triangles = {{0, 1, 2}};
  bar.key_times = {0, 1};
  bar.positions = {{{0, 0, -1}, {0.1f, 0, -1}, {0, 0.1f, -1}}, {{1, 0, 1}, {1.1f, 0, 1}, {1, 0.1f, 1}}};
  const MotionMask mask = mask_of(shot_of({bar}), 0);
  for (int x = kWidth / 2 + 1; x < kWidth; ++x) EXPECT_TRUE(mask.moves(x, kHeight / 2 - 1)) << x;
  EXPECT_FALSE(mask.moves(kWidth / 2 - 2, kHeight / 2 - 1));
}

TEST(MotionMask, KnowsHowFastAndLeavesOutWhatStandsStill) {
  Mesh bar;
  bar.triangles = {{0, 1, 2}};
  bar.key_times = {0, 1};
  const double pixel = 2 * std::tan(Projection{}.vfov / 2) / kHeight;  // at distance 1
  const float step = static_cast<float>(5 * pixel), size = static_cast<float>(2 * pixel);
  bar.positions = {{{0, 0, -1}, {size, 0, -1}, {0, size, -1}}, {{step, 0, -1}, {step + size, 0, -1}, {step, size, -1}}};
  Mesh still = bar;
  still.positions.resize(1);
  const MotionMask mask = mask_of(shot_of({bar, still}), 0);
  EXPECT_NEAR(mask.speed(kWidth / 2 + 3, kHeight / 2 - 1), 5, 0.05);
  EXPECT_NEAR(mask.depth(kWidth / 2 + 3, kHeight / 2 - 1), 1, 1e-3);
  EXPECT_FALSE(mask.moves(kWidth / 2 + 12, kHeight / 2 - 1));
  EXPECT_FALSE(mask.moves(kWidth / 2 + 3, kHeight / 2 + 4));
  EXPECT_FALSE(mask.moves(0, 0));
  EXPECT_TRUE(mask_of(shot_of({still}), 0).empty());
}

// Looking where samples are needed must not cost more than the samples.
TEST(Automatic, TakesNoMoreThanTheBudgetForSmallPictures) {
  std::mt19937 random(test::seed());
  Shot shot = shot_of({still_soup(random, 40)});
  for (const int side : {1, 12}) {
    shot.projection.width = shot.projection.height = side;
    RenderParams params;
    params.spp = 64;
    RenderStats stats;
    render(shot, params, &stats);
    EXPECT_EQ(stats.rays, static_cast<uint64_t>(64 * side * side));
  }
}

RenderParams params_of(IntegratorKind kind, int tc_rays, int spp, uint64_t seed) {
  RenderParams params;
  params.integrator = kind;
  params.shading = ShadingKind::flat;
  params.tc_rays = tc_rays;
  params.spp = spp;
  params.seed = seed;
  params.aovs = {Aov::coverage, Aov::depth};
  return params;
}

double mean_square_difference(const Image& a, const Image& b, const char* channel) {
  double sum = 0;
  const auto &va = a.find(channel)->values, &vb = b.find(channel)->values;
  for (size_t i = 0; i < va.size(); ++i) sum += (double(va[i]) - vb[i]) * (double(va[i]) - vb[i]);
  return sum / static_cast<double>(va.size());
}

/// Still and moving triangles that hide each other, in front of a background.
Shot busy_shot() {
  std::mt19937 random(test::seed());
  return shot_of({still_soup(random, 12), test::random_soup(random, test::Motion::deform, 8), still_soup(random, 12)});
}

TEST(Mixed, ConvergesToThePictureOfTimeContinuousRays) {
  const Shot shot = busy_shot();
  const Image reference = render(shot, params_of(IntegratorKind::tc, 4096, 1, 1));
  // Ten decibels less error for four times the rays, down to below the reference's own: a bias would stop it. A single
  // step has some luck in it.
  for (const char* channel : {"R", "G", "B", "coverage.A"}) {
    std::vector<double> errors;
    for (const int rays : {4, 16, 64, 256}) {
      const Image mixed = render(shot, params_of(IntegratorKind::mixed, rays, 4 * rays, 2));
      errors.push_back(mean_square_difference(mixed, reference, channel));
    }
    for (size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1] / 1.5) << channel << ' ' << i;
    EXPECT_LT(errors.back(), errors.front() / 100) << channel;
    EXPECT_LT(10 * std::log10(errors.back()), -60) << channel;
  }
}

TEST(Mixed, CheapStillRaysTakeTheNoiseOfWhatStandsStill) {
  const Shot shot = busy_shot();
  const Image reference = render(shot, params_of(IntegratorKind::tc, 4096, 1, 1));
  const auto error = [&](IntegratorKind kind, int spp) {
    return mean_square_difference(render(shot, params_of(kind, 4, spp, 2)), reference, "R");
  };
  EXPECT_LT(error(IntegratorKind::mixed, 64), 0.6 * error(IntegratorKind::tc, 4));
}

TEST(Mixed, IsQmcWhereNothingMoves) {
  std::mt19937 random(test::seed());
  const Shot shot = shot_of({still_soup(random, 30)});
  const auto channels_of = [&](IntegratorKind kind, SamplerKind sampler, int spp) {
    RenderParams params = params_of(kind, 4, spp, 3);
    params.sampler = sampler;
    const Image image = render(shot, params);
    std::vector<std::vector<float>> values;
    for (const char* channel : {"R", "G", "B", "coverage.A", "depth.Z"}) values.push_back(image.find(channel)->values);
    return values;
  };
  for (const SamplerKind sampler : {SamplerKind::owen_sobol, SamplerKind::multi_jitter, SamplerKind::random}) {
    const auto qmc = channels_of(IntegratorKind::qmc, sampler, 8);
    EXPECT_EQ(channels_of(IntegratorKind::mixed, sampler, 8), qmc);
    EXPECT_EQ(channels_of(IntegratorKind::automatic, sampler, 8), qmc);
  }
  EXPECT_EQ(channels_of(IntegratorKind::automatic, SamplerKind::multi_jitter, 64),
            channels_of(IntegratorKind::qmc, SamplerKind::multi_jitter, 64))
      << "points that are good only all together";
}

// One scene of six triangles says little, and errors differ by orders of magnitude between scenes: the mean of the
// logarithms of their ratios counts.
TEST(Mixed, AutomaticTakesMoreSamplesWhereTheyDiffer) {
  std::mt19937 random(test::seed());
  std::vector<Shot> shots;
  std::vector<Image> references;
  for (int i = 0; i < 16; ++i) {
    shots.push_back(shot_of({still_soup(random, 6)}));
    references.push_back(render(shots.back(), params_of(IntegratorKind::qmc, 1, 4096, 1)));
  }
  double before = INFINITY;
  // Over draws of 16 scenes the ratios were 0.53 +- 0.04, 0.25 +- 0.02 and 0.18 +- 0.03: where nothing is seen, little
  // is saved.
  for (const auto& [spp, most] : {std::pair(16, 0.75), std::pair(64, 0.35), std::pair(256, 0.3)}) {
    double sum = 0, log_ratio = 0;
    uint64_t rays = 0;
    for (size_t i = 0; i < shots.size(); ++i) {
      double automatic = 0, qmc = 0;
      for (const uint64_t seed : {2u, 3u}) {
        RenderStats stats;
        automatic += mean_square_difference(
            render(shots[i], params_of(IntegratorKind::automatic, 1, spp, seed), &stats), references[i], "R");
        qmc +=
            mean_square_difference(render(shots[i], params_of(IntegratorKind::qmc, 1, spp, seed)), references[i], "R");
        rays += stats.rays;
      }
      sum += automatic;
      log_ratio += std::log(automatic / qmc) / static_cast<double>(shots.size());
    }
    EXPECT_LT(std::exp(log_ratio), most) << spp;
    EXPECT_LT(sum, before / 4) << "no bias that stays";
    EXPECT_LT(static_cast<double>(rays) / 32, 1.25 * spp * kWidth * kHeight) << "with the looks beforehand";
    before = sum;
  }
}

TEST(Mixed, AutomaticIsTheSameForAnyCropAndThreads) {
  const Shot shot = busy_shot();
  RenderParams params = params_of(IntegratorKind::automatic, 1, 64, 5);
  params.threads = 1;
  const Image whole = render(shot, params);
  params.threads = 2;
  EXPECT_EQ(render(shot, params).find("R")->values, whole.find("R")->values);
  params.crop = Crop{7, 23, 11, 30};
  const Image part = render(shot, params);
  for (int y = 11; y < 30; ++y)
    for (int x = 7; x < 23; ++x)
      ASSERT_EQ(part.find("R")->values[static_cast<size_t>((y - 11) * 16 + x - 7)],
                whole.find("R")->values[static_cast<size_t>(y * kWidth + x)]);
}

TEST(Mixed, AutomaticTakesDiscreteSamplesOnStillOutlinesInFrontOfMotion) {
  constexpr int kWide = 192, kHigh = 128;                            // enough pixels for a race that knows what it says
  const double pixel = 2 * std::tan(Projection{}.vfov / 2) / kHigh;  // at distance 1
  const auto rectangle = [](float x0, float x1, float z) {
    Mesh mesh;
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.positions = {{{x0, -9, z}, {x1, -9, z}, {x1, 9, z}, {x0, 9, z}}};
    return mesh;
  };
  Mesh board = rectangle(0, 9, -2);  // its left edge moves from 40 pixels left of the middle to 40 pixels right
  board.key_times = {0, 1};
  board.positions.push_back(board.positions[0]);
  for (const size_t v : {0u, 3u}) {
    board.positions[0][v].x = static_cast<float>(-80 * pixel);
    board.positions[1][v].x = static_cast<float>(80 * pixel);
  }
  Shot shot = shot_of({rectangle(static_cast<float>(pixel / 2), 9, -1), board});
  shot.projection.width = kWide;
  shot.projection.height = kHigh;
  const auto picture = [&](IntegratorKind kind) {
    RenderParams params = params_of(kind, 1, 256, 3);
    params.sampler = SamplerKind::multi_jitter;  // the same number everywhere
    params.crop = Crop{0, kWide, 5, 6};
    return render(shot, params);
  };
  const Image qmc = picture(IntegratorKind::qmc), automatic = picture(IntegratorKind::automatic);
  const auto value = [](const Image& image, int x) { return image.find("G")->values[static_cast<size_t>(x)]; };
  EXPECT_EQ(value(automatic, kWide / 2), value(qmc, kWide / 2));
  EXPECT_NE(value(automatic, kWide / 2 - 6), value(qmc, kWide / 2 - 6)) << "here nothing is in front";
}

TEST(Mixed, AutomaticIsNoWorseThanQmcOfItsBudget) {
  const Shot shot = busy_shot();
  const Image reference = render(shot, params_of(IntegratorKind::tc, 4096, 1, 1));
  for (const int spp : {4, 16, 64, 256}) {
    double automatic = 0, qmc = 0;
    for (const uint64_t seed : {5u, 6u, 7u, 8u}) {
      automatic +=
          mean_square_difference(render(shot, params_of(IntegratorKind::automatic, 1, spp, seed)), reference, "R");
      qmc += mean_square_difference(render(shot, params_of(IntegratorKind::qmc, 1, spp, seed)), reference, "R");
    }
    EXPECT_LT(10 * std::log10(automatic / qmc), 0.3) << spp;
  }
}

}  // namespace
}  // namespace kairos
