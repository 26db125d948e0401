#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/render.h>

namespace kairos::render_test {
namespace {

// A rectangle [x0, x1] x [y0, y1] in pixels of the frame below (y downwards), at a distance; moves to the right by
// `motion` pixels while the shutter is open.
Mesh bar(float x0, float x1, float y0, float y1, float motion = 0, float dist = 1);

constexpr int kWidth = 40, kHeight = 24;

Mesh bar(float x0, float x1, float y0, float y1, float motion, float dist) {
  Mesh mesh;
  mesh.name = "bar";
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const int keys = motion == 0 ? 1 : 2;
  for (int key = 0; key < keys; ++key) {
    const float shift = motion * static_cast<float>(key);
    const auto at = [&](float x, float y) { return Vec3f{x + shift - kWidth / 2, kHeight / 2 - y, -dist}; };
    mesh.positions.push_back({at(x0, y1), at(x1, y1), at(x1, y0), at(x0, y0)});
  }
  if (keys == 2) mesh.key_times = {0, 1};
  return mesh;
}

// One world unit is one pixel.
Shot shot_of(std::vector<Mesh> meshes) {
  Shot shot;
  shot.meshes = std::move(meshes);
  shot.materials.resize(3);
  shot.materials[0].base_color = {1, 0.5f, 0.25f};
  shot.materials[1].base_color = {0, 1, 0};
  shot.projection.width = kWidth;
  shot.projection.height = kHeight;
  shot.projection.orthographic = true;
  shot.projection.view_height = kHeight;
  return shot;
}

RenderParams flat(IntegratorKind integrator, int samples) {
  RenderParams params;
  params.integrator = integrator;
  params.shading = ShadingKind::flat;
  params.tc_rays = params.spp = samples;
  return params;
}

float at(const Image& image, const char* channel, int x, int y) {
  const Channel* found = image.find(channel);
  if (found == nullptr) throw std::runtime_error(std::string("no channel ") + channel);
  return found->values[static_cast<size_t>((y - image.top) * image.width + x - image.left)];
}

bool same_pixels(const Image& a, const Image& b) {
  for (size_t i = 0; i < a.channels.size(); ++i)
    if (a.channels[i].values != b.channels[i].values) return false;
  return a.channels.size() == b.channels.size();
}

const IntegratorKind kAll[] = {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed,
                               IntegratorKind::automatic};

TEST(Render, RowZeroIsTheTopAndColumnZeroTheLeft) {
  const Shot shot = shot_of({bar(3, 7, 2, 5)});
  for (const auto integrator : kAll) {
    const Image image = render(shot, flat(integrator, 4));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool inside = x >= 3 && x < 7 && y >= 2 && y < 5;
        EXPECT_EQ(at(image, "R", x, y), inside ? 1.0f : 0.0f) << x << " " << y;
        EXPECT_EQ(at(image, "B", x, y), inside ? 0.25f : 0.0f) << x << " " << y;
      }
  }
}

TEST(Render, PerspectiveSeesWhatItsFieldOfViewSays) {
  Shot shot = shot_of({bar(0, kWidth, 6, kHeight - 6, 0, 6)});
  shot.projection.orthographic = false;
  // The bar is 12 units high, 6 away: 90 degrees. Half of the frame's height, then, needs tan(vfov / 2) = 2.
  shot.projection.vfov = 2 * std::atan(2.0);
  const Image image = render(shot, flat(IntegratorKind::tc, 4));
  for (int y = 0; y < kHeight; ++y)
    EXPECT_EQ(at(image, "R", kWidth / 2, y), y >= 6 && y < kHeight - 6 ? 1.0f : 0.0f) << y;
}

TEST(Render, OneTimeContinuousRayIsExactInTime) {
  // 2 pixels wide, moving by 16: seen for an eighth of the shutter wherever it passes as a whole.
  Shot shot = shot_of({bar(4, 6, 0, kHeight, 16)});
  shot.background = {0, 0, 1};
  RenderParams params = flat(IntegratorKind::tc, 1);
  params.aovs = {Aov::coverage, Aov::segments, Aov::depth, Aov::mesh, Aov::albedo, Aov::normal};
  const Image image = render(shot, params);
  for (int x = 6; x < 20; ++x)
    for (int y = 0; y < kHeight; ++y) {
      EXPECT_NEAR(at(image, "coverage.A", x, y), 0.125, 1e-6);
      EXPECT_NEAR(at(image, "R", x, y), 0.125, 1e-6);
      EXPECT_NEAR(at(image, "B", x, y), 0.125 * 0.25 + 0.875, 1e-6);
      EXPECT_NEAR(at(image, "albedo.G", x, y), 0.125 * 0.5, 1e-6);
      EXPECT_NEAR(at(image, "normal.Z", x, y), 0.125, 1e-6);
      EXPECT_NEAR(at(image, "depth.Z", x, y), 1, 1e-6);
      EXPECT_EQ(at(image, "mesh.id", x, y), 1);
      EXPECT_GE(at(image, "segments.Y", x, y), 1);
    }
  EXPECT_TRUE(std::isinf(at(image, "depth.Z", 30, 3)));
  EXPECT_EQ(at(image, "mesh.id", 30, 3), 0);
  EXPECT_EQ(at(image, "B", 30, 3), 1);
}

TEST(Render, NearerThingsHideFartherOnesOnlyWhileTheyDo) {
  Shot shot = shot_of({bar(0, kWidth, 0, kHeight, 0, 5), bar(4, 6, 0, kHeight, 16, 2)});
  shot.meshes[1].material = 1;
  RenderParams params = flat(IntegratorKind::tc, 1);
  params.aovs = {Aov::coverage, Aov::depth, Aov::mesh};
  const Image image = render(shot, params);
  for (int x = 6; x < 20; ++x) {
    EXPECT_NEAR(at(image, "R", x, 7), 0.875, 1e-6);
    EXPECT_NEAR(at(image, "G", x, 7), 0.875 * 0.5 + 0.125, 1e-6);
    EXPECT_NEAR(at(image, "coverage.A", x, 7), 1, 1e-6);
    EXPECT_NEAR(at(image, "depth.Z", x, 7), 2, 1e-6);
    EXPECT_EQ(at(image, "mesh.id", x, 7), 1);
  }
}

TEST(Render, DiscreteRaysConvergeToTheSame) {
  Shot shot = shot_of({bar(4.3f, 5.1f, 3.2f, 18.7f, 21), bar(10, 13, 1, 9, -4, 0.5f)});
  shot.meshes[1].material = 1;
  const Image tc = render(shot, flat(IntegratorKind::tc, 256)), qmc = render(shot, flat(IntegratorKind::qmc, 4096));
  double sum = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) sum += std::pow(at(tc, "G", x, y) - at(qmc, "G", x, y), 2);
  EXPECT_LT(std::sqrt(sum / (kWidth * kHeight)), 2e-3);
}

TEST(Render, BitIdenticalForAnyNumberOfThreadsAndAnyCrop) {
  Shot shot = shot_of({bar(4, 6, 0, kHeight, 16), bar(8, 30, 3.3f, 17.1f, -9, 2)});
  shot.meshes[0].name = "front";
  for (const auto integrator : kAll)
    for (const auto filter : {FilterKind::box, FilterKind::gaussian, FilterKind::blackman_harris}) {
      RenderParams params = flat(integrator, 9);
      params.filter = filter;
      params.shading = ShadingKind::normal;
      params.aovs = {Aov::depth, Aov::normal, Aov::albedo, Aov::coverage, Aov::segments, Aov::mesh};
      params.threads = 1;
      const Image one = render(shot, params);
      params.threads = 2;
      EXPECT_TRUE(same_pixels(one, render(shot, params)));
      params.crop = Crop{5, 23, 7, 20};
      const Image part = render(shot, params);
      ASSERT_EQ(part.width, 18);
      ASSERT_EQ(part.height, 13);
      for (const Channel& channel : part.channels)
        for (int y = 7; y < 20; ++y)
          for (int x = 5; x < 23; ++x)
            ASSERT_EQ(at(part, channel.name.c_str(), x, y), at(one, channel.name.c_str(), x, y))
                << channel.name << " " << x << " " << y;
    }
}

TEST(Render, AnotherSeedGivesAnotherNoise) {
  const Shot shot = shot_of({bar(4.4f, 6.7f, 0.3f, 8, 16)});
  for (const auto sampler : {SamplerKind::owen_sobol, SamplerKind::multi_jitter, SamplerKind::random}) {
    RenderParams params = flat(IntegratorKind::qmc, 5);
    params.sampler = sampler;
    const Image first = render(shot, params), again = render(shot, params);
    params.seed = 1;
    EXPECT_TRUE(same_pixels(first, again));
    EXPECT_FALSE(same_pixels(first, render(shot, params)));
  }
}

TEST(Render, WideFiltersSpreadAnEdge) {
  const Shot shot = shot_of({bar(20, kWidth, 0, kHeight)});
  RenderParams params = flat(IntegratorKind::tc, 4096);
  params.crop = Crop{18, 20, 10, 11};
  params.filter = FilterKind::box;
  EXPECT_EQ(at(render(shot, params), "R", 19, 10), 0);
  params.filter = FilterKind::gaussian;
  // The pixel's centre is one standard deviation from the edge.
  EXPECT_NEAR(at(render(shot, params), "R", 19, 10), 0.1587, 2e-3);
  EXPECT_EQ(at(render(shot, params), "R", 18, 10), 0) << "cut at 1.5 px";
}

TEST(Render, StatsCountWhatWasDone) {
  const Shot shot = shot_of({bar(0, kWidth, 0, kHeight)});
  RenderStats stats;
  RenderParams params = flat(IntegratorKind::tc, 3);
  params.shading = ShadingKind::normal;
  params.shading_samples = 5;
  params.clusters = Clusters::off;
  render(shot, params, &stats);
  EXPECT_EQ(stats.rays, 3u * kWidth * kHeight);
  EXPECT_EQ(stats.segments, stats.rays);
  EXPECT_EQ(stats.shading_samples, stats.rays) << "what stands still needs one";
  EXPECT_EQ(stats.counters.rays, stats.rays);
  EXPECT_TRUE(stats.instruction_set);
  EXPECT_GT(stats.accel_memory_bytes, 0u);
  Shot moving = shot_of({bar(-9, kWidth + 9, 0, kHeight, 1)});
  moving.meshes[0].triangles = {{0, 1, 2}};
  render(moving, params, &stats);
  EXPECT_GE(stats.shading_samples, 5 * stats.segments * 3 / 4);
  render(shot, flat(IntegratorKind::qmc, 7), &stats);
  EXPECT_EQ(stats.rays, 7u * kWidth * kHeight);
  EXPECT_EQ(stats.segments, stats.rays);
  EXPECT_FALSE(stats.instruction_set);
}

TEST(Render, ARendererGivesThePicturesOfItsShotInAnyOrder) {
  Shot shot = shot_of({bar(3, 7, 2, 5), bar(9, 19, 8, 20, 12, 2)});
  shot.lights = {ConstantLight{{0.5f, 0.5f, 0.5f}}};
  std::vector<RenderParams> all;
  for (const IntegratorKind integrator : kAll)
    for (const ShadingKind shading : {ShadingKind::flat, ShadingKind::whitted}) {
      RenderParams params = flat(integrator, 4);
      params.shading = shading;
      params.seed = all.size();
      params.discrete_keys = all.size() % 3 == 0 ? 5 : 0;
      if (all.size() % 2 == 0) params.aovs = {Aov::normal};
      all.push_back(params);
    }
  Renderer renderer(shot);
  for (int round = 0; round < 2; ++round)
    for (const RenderParams& params : all)
      EXPECT_TRUE(same_pixels(renderer.render(params), render(shot, params)))
          << "seed " << params.seed << ", round " << round;
}

TEST(Render, PartsAreBuiltOnceAndTheirTimeIsKnown) {
  const Shot shot = shot_of({bar(3, 7, 2, 5), bar(9, 19, 8, 20, 12, 2)});
  Renderer renderer(shot);
  RenderStats tc, qmc, mixed, again;
  renderer.render(flat(IntegratorKind::tc, 1), &tc);
  EXPECT_GT(tc.parts.tracer, 0);
  EXPECT_GT(tc.parts.shading, 0);
  EXPECT_EQ(tc.parts.discrete, 0) << "discrete rays are not needed";
  renderer.render(flat(IntegratorKind::qmc, 1), &qmc);
  EXPECT_GT(qmc.parts.discrete, 0);
  EXPECT_EQ(qmc.parts.tracer, 0);
  renderer.render(flat(IntegratorKind::mixed, 1), &mixed);
  EXPECT_GT(mixed.parts.motion_mask, 0);
  EXPECT_GT(mixed.parts.tracer, 0) << "of what moves alone";
  EXPECT_EQ(mixed.parts.discrete, qmc.parts.discrete);
  EXPECT_GE(mixed.build_seconds, mixed.parts.sum());
  RenderParams params = flat(IntegratorKind::mixed, 1);
  params.discrete_keys = 3;
  renderer.render(params, &again);
  EXPECT_EQ(again.parts.tracer, mixed.parts.tracer) << "built before, and counted as it was then";
  EXPECT_NE(again.parts.discrete, qmc.parts.discrete) << "other keys, another tree";
  params.discrete_keys = 130;
  EXPECT_THROW(renderer.render(params), Error);
}

TEST(Render, TheCallerCanStopIt) {
  const Shot shot = shot_of({bar(0, kWidth, 0, kHeight, 3)});
  RenderParams params = flat(IntegratorKind::tc, 100000);  // minutes, if it were not stopped
  int calls = 0;
  const auto progress = [&](double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LT(fraction, 1);
    return ++calls < 3;
  };
  try {
    render(shot, params, nullptr, progress);
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(calls, 3);
}

TEST(Render, ProgressIsToldByTheThreadThatCalls) {
  const Shot shot = shot_of({bar(0, kWidth, 0, kHeight, 3)});
  const auto caller = std::this_thread::get_id();
  for (const int threads : {1, 2}) {
    RenderParams params = flat(IntegratorKind::tc, 64);
    params.threads = threads;
    int calls = 0;
    render(shot, params, nullptr, [&](double) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      ++calls;
      return true;
    });
    EXPECT_GE(calls, 2);  // at once, and at the end
    Renderer(shot).calibrate(params, [&](double) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      return true;
    });
  }
}

TEST(Render, WhatProgressThrowsReachesTheCaller) {
  const Shot shot = shot_of({bar(0, kWidth, 0, kHeight, 3)});
  const RenderParams params = flat(IntegratorKind::tc, 100000);  // minutes, if it were not stopped
  EXPECT_THROW(render(shot, params, nullptr, [](double) -> bool { throw std::logic_error("no"); }), std::logic_error);
}

TEST(Render, TwoRenderersAtOnce) {
  const Shot shot = shot_of({bar(2, 6, 1, 9, 3), bar(0, kWidth, 0, kHeight)});
  RenderParams params = flat(IntegratorKind::mixed, 16);
  const Image alone = render(shot, params);
  std::array<Image, 2> images;
  std::array<RenderStats, 2> stats;
  const auto work = [&](size_t i, int threads) {
    RenderParams own = params;
    own.threads = threads;
    Renderer renderer(shot);
    for (int round = 0; round < 4; ++round) images[i] = renderer.render(own, &stats[i], [](double) { return true; });
  };
  std::thread other([&] { work(0, 1); });
  work(1, 3);
  other.join();
  EXPECT_EQ(stats[0].threads, 1);
  EXPECT_EQ(stats[1].threads, 3);
  for (const Image& image : images) EXPECT_TRUE(same_pixels(alone, image));
}

TEST(Render, ProgressEndsAtOne) {
  double last = -1;
  render(shot_of({bar(0, 9, 0, 9)}), flat(IntegratorKind::qmc, 1), nullptr, [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    return true;
  });
  EXPECT_EQ(last, 1);
}

TEST(Render, RefusesParametersOutOfRange) {
  const Shot shot = shot_of({bar(0, 9, 0, 9)});
  const auto refused = [&](auto&& change) {
    RenderParams params;
    params.integrator = IntegratorKind::mixed;  // which looks at all of them
    change(params);
    try {
      render(shot, params);
      return false;
    } catch (const Error& e) {
      return e.code() == ErrorCode::bad_usage;
    }
  };
  EXPECT_TRUE(refused([](RenderParams& p) { p.tc_rays = 0; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.tc_rays = -1; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.tc_rays = (1 << 20) + 1; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.shading_samples = 0; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.threads = -1; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.crop = Crop{0, kWidth + 1, 0, 1}; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.crop = Crop{3, 3, 0, 1}; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.crop = Crop{-1, 3, 0, 1}; }));
  EXPECT_TRUE(refused([](RenderParams& p) { p.aovs = {Aov::depth, Aov::depth}; }));
  EXPECT_FALSE(refused([](RenderParams&) {}));
}

TEST(Render, NothingToSeeIsBackground) {
  Shot shot = shot_of({});
  shot.background = {0.5f, 0.25f, 2};
  for (const auto integrator : kAll) {
    const Image image = render(shot, flat(integrator, 3));
    EXPECT_EQ(at(image, "R", 3, 3), 0.5f);
    EXPECT_EQ(at(image, "B", 39, 23), 2.0f);
  }
}

}  // namespace
}  // namespace kairos::render_test
