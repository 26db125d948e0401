// Light that is shared through cells of surfaces.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "seed.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

constexpr IntegratorKind kKinds[] = {IntegratorKind::qmc, IntegratorKind::tc};

/// All meshes slide along x by so much while the shutter is open.
void slide_all(Shot& shot, float way) {
  for (Mesh& mesh : shot.meshes) {
    mesh.positions.push_back(mesh.positions[0]);
    for (Vec3f& p : mesh.positions[1]) p.x += way;
    mesh.key_times = {0, 1};
  }
}

/// Of `columns` squares of random colours side by side, in the plane z = -10.
Mesh chequered(int columns, std::mt19937& random) {
  std::uniform_real_distribution<float> shade(0, 1);
  Mesh mesh;
  mesh.positions.resize(1);
  for (int c = 0; c < columns; ++c) {
    const auto first = static_cast<uint32_t>(mesh.positions[0].size());
    const auto left = static_cast<float>(c - columns / 2);
    const Vec4f colour{shade(random), c % 3 == 0 ? 0 : shade(random), shade(random), 1};
    for (const auto& corner : {Vec3f{left, -20, -10}, {left + 1, -20, -10}, {left + 1, 20, -10}, {left, 20, -10}}) {
      mesh.positions[0].push_back(corner);
      mesh.colors.push_back(colour);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

/// A floor under a lamp that is half hidden by a box, a mirror and glass; seen from above, along -z.
Shot lit_room(float way) {
  Shot shot;
  shot.materials = {lambert({0.7f, 0.6f, 0.5f}), lamp({9, 8, 7}), mirror({0.8f, 0.8f, 0.8f}), glass(1.5f)};
  shot.meshes = {parallelogram({-20, -20, -10}, {40, 0, 0}, {0, 40, 0}, 0),
                 parallelogram({-7, -3, -3}, {0, 6, 0}, {4, 0, 0}, 1), box({-3, -2, -8}, {-1, 2, -6}, 0),
                 parallelogram({1, -3, -9.5f}, {1, 0, 0}, {0, 2, 0}, 2), ball({2, 2, -8.5f}, 1, 8, 3)};
  if (way != 0) slide_all(shot, way);
  shot.projection.width = 100;
  shot.projection.height = 70;
  shot.projection.orthographic = true;
  shot.projection.view_height = 7;
  return shot;
}

RenderParams cell_params(IntegratorKind kind, Cells cells, int spp, uint64_t seed) {
  RenderParams params;
  params.integrator = kind;
  params.shading = ShadingKind::whitted;
  params.cells = cells;
  params.spp = spp;
  params.tc_rays = std::max(1, spp / 4);
  params.shading_samples = 4;
  params.seed = seed;
  return params;
}

std::vector<float> colours_of(const Image& image) {
  std::vector<float> all;
  for (const char* name : {"R", "G", "B"}) {
    const auto& values = image.find(name)->values;
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

double mean_product(const std::vector<float>& a, const std::vector<float>& b, const std::vector<float>& c,
                    const std::vector<float>& d) {  // of a - b and c - d
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i] - b[i]) * static_cast<double>(c[i] - d[i]);
  return sum / static_cast<double>(a.size());
}

TEST(SurfaceCells, LightIsSharedAndColoursAreNot) {
  // Nothing stands in the way of the even light, so that all cells find the same, and what differs within a cell is the
  // surface: its pictures, and a mirror and a lamp beside it.
  std::mt19937 random(test::seed());
  Shot shot;
  shot.materials = {lambert({1, 1, 1}), mirror({0.5f, 0.25f, 1}), lamp({0.25f, 0.5f, 0.125f})};
  shot.meshes = {chequered(41, random), parallelogram({-21, -20, -10}, {1, 0, 0}, {0, 40, 0}, 1),
                 parallelogram({20, -20, -10}, {1, 0, 0}, {0, 40, 0}, 2)};
  shot.materials[0].roughness = 0.5f;
  slide_all(shot, 3);
  shot.lights = {EnvironmentLight{}};
  std::get<EnvironmentLight>(shot.lights[0]).radiance = {0.5f, 0.5f,
                                                         0.5f};  // white: some squares are black in a colour
  shot.projection.width = 45;
  shot.projection.height = 3;
  shot.projection.orthographic = true;
  shot.projection.view_height = 3;  // cells are two squares wide
  for (const IntegratorKind kind : kKinds)
    for (const ShadingKind shading : {ShadingKind::whitted, ShadingKind::path}) {
      RenderParams params = cell_params(kind, Cells::off, 16, random());
      params.shading = shading;
      params.max_depth = shading == ShadingKind::path ? 0 : 8;
      if (shading == ShadingKind::path) shot.materials[0].roughness = 1;  // one lobe, all but even
      const auto alone = colours_of(render(shot, params));
      params.cells = Cells::on;
      const auto shared = colours_of(render(shot, params));
      const float bar = shading == ShadingKind::path ? 0.15f : 1e-5f;  // paths look in one direction
      for (size_t i = 0; i < alone.size(); ++i) ASSERT_NEAR(shared[i], alone[i], bar) << i;
    }
}

TEST(SurfaceCells, ACropAndAnyNumberOfThreadsGiveTheSameBits) {
  std::mt19937 random(test::seed());
  const Shot shot = lit_room(0.7f);
  for (const IntegratorKind kind :
       {IntegratorKind::qmc, IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic}) {
    RenderParams params = cell_params(kind, Cells::on, 4, random());
    params.aovs = {Aov::normal, Aov::albedo};
    params.threads = 2;
    const Image whole = render(shot, params);
    params.threads = 1;
    params.crop = Crop{61, 67, 60, 66};  // of four squares
    const Image crop = render(shot, params);
    for (const Channel& channel : crop.channels)
      for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 6; ++x)
          ASSERT_EQ(channel.values[static_cast<size_t>(y * 6 + x)],
                    whole.find(channel.name)->values[static_cast<size_t>((y + 60) * 100 + x + 61)])
              << channel.name << ' ' << x << ' ' << y;
    params.cells = Cells::off;
    const Image alone = render(shot, params);
    EXPECT_NE(crop.find("G")->values, alone.find("G")->values);
    if (kind == IntegratorKind::automatic) continue;  // chooses other rays
    for (const char* name : {"normal.Z", "albedo.G"})
      EXPECT_EQ(crop.find(name)->values, alone.find(name)->values) << "what is no light is not shared";
  }
}

TEST(SurfaceCells, TakeNoiseAndLeaveTheMean) {
  // The floor, on which the edge of a shadow lies, passes thirty pixels: a shading sample serves all of them, so that
  // there is less noise although only a quarter of what is seen is shaded. The lamp and its edges, which are no light
  // that is shared, are out of sight.
  std::mt19937 random(test::seed());
  Shot shot = lit_room(3);
  shot.meshes.resize(3);
  for (size_t m = 1; m < 3; ++m)
    for (auto& key : shot.meshes[m].positions)
      for (Vec3f& p : key) p.x -= 4;
  shot.projection.width = 64;
  shot.projection.height = 32;
  shot.projection.view_height = 3.2;
  for (const IntegratorKind kind : kKinds) {
    const auto picture = [&](Cells cells, int spp) {
      return colours_of(render(shot, cell_params(kind, cells, spp, random())));
    };
    const auto a = picture(Cells::on, 16), b = picture(Cells::on, 16);
    const auto c = picture(Cells::off, 16), d = picture(Cells::off, 16);
    const double noise = mean_product(a, b, a, b) / 2, alone = mean_product(c, d, c, d) / 2;
    const double bias = mean_product(a, c, b, d);
    EXPECT_LT(noise, alone);
    EXPECT_LT(std::abs(bias), alone / 2);
    for (const float v : a) ASSERT_TRUE(std::isfinite(v) && v >= 0);
  }
}

/// Of a crop of 32x32 pixels of a frame that is large enough for a race.
std::vector<float> raced_crop(Shot shot, Cells cells, IntegratorKind kind, uint64_t seed, int spp = 8) {
  shot.projection.width = 200;
  shot.projection.height = 120;
  RenderParams params = cell_params(kind, cells, spp, seed);
  params.crop = Crop{64, 96, 32, 64};
  return colours_of(render(shot, params));
}

TEST(SurfaceCells, AutoSharesLightWhereThatTakesNoise) {
  std::mt19937 random(test::seed());
  Shot sky_lit = lit_room(0), point_lit = lit_room(0.7f), even = lit_room(0.7f);
  point_lit.meshes.erase(point_lit.meshes.begin() + 1);  // the lamp
  PointLight bulb;
  bulb.position = {0, 0, -2};
  bulb.intensity = {30, 30, 30};
  point_lit.lights = {bulb};
  even.meshes.resize(1);  // the floor, of which all sees all of the sky
  sky_lit.lights = even.lights = {ConstantLight{{1, 1, 1}}};
  // High walls, so that each point of the floor sees a part of the sky.
  sky_lit.meshes = {sky_lit.meshes[0], parallelogram({-4, -20, -10}, {0, 40, 0}, {0, 0, 12}, 0),
                    parallelogram({4, -20, -10}, {0, 40, 0}, {0, 0, 12}, 0)};
  slide_all(sky_lit, 0.7f);
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic}) {
    const uint64_t seed = random();
    EXPECT_NE(raced_crop(sky_lit, Cells::automatic, kind, seed), raced_crop(sky_lit, Cells::off, kind, seed));
    EXPECT_EQ(raced_crop(point_lit, Cells::automatic, kind, seed), raced_crop(point_lit, Cells::off, kind, seed));
    EXPECT_EQ(raced_crop(even, Cells::automatic, kind, seed), raced_crop(even, Cells::off, kind, seed));
  }
  // In front of mirrors, samples that go where they are needed are worth more.
  const uint64_t seed = random();
  EXPECT_NE(raced_crop(sky_lit, Cells::automatic, IntegratorKind::automatic, seed, 16),
            raced_crop(sky_lit, Cells::off, IntegratorKind::automatic, seed, 16));
  sky_lit.meshes.push_back(parallelogram({0, -20, -5}, {2, 0, 1}, {0, 40, 0}, 2));
  EXPECT_EQ(raced_crop(sky_lit, Cells::automatic, IntegratorKind::automatic, seed, 16),
            raced_crop(sky_lit, Cells::off, IntegratorKind::automatic, seed, 16));
}

TEST(SurfaceCells, AreHalvedWhereLightChangesFast) {
  // A bright wall stands on the floor, and across the pixels next to it light falls to a small part.
  std::mt19937 random(test::seed());
  Shot shot;
  shot.materials = {lambert({0.7f, 0.7f, 0.7f}), lamp({8, 8, 8})};
  shot.meshes = {parallelogram({-20, -20, -10}, {40, 0, 0}, {0, 40, 0}, 0),
                 parallelogram({0, -20, -10}, {0, 40, 0}, {0, 0, 0.1f}, 1)};
  shot.projection.width = shot.projection.height = 32;
  shot.projection.orthographic = true;
  shot.projection.view_height = 3.2;
  const auto picture = [&](Cells cells, int spp) {
    return colours_of(render(shot, cell_params(IntegratorKind::qmc, cells, spp, random())));
  };
  const auto shared = picture(Cells::on, 64), alone = picture(Cells::off, 64), other = picture(Cells::off, 64);
  double off = 0, brightest = 0;
  for (size_t x = 0; x < 32; ++x) {  // means over columns
    double difference = 0, light = 0;
    for (size_t y = 0; y < 32; ++y) {
      light += static_cast<double>(alone[y * 32 + x] + other[y * 32 + x]) / 64;
      difference += static_cast<double>(shared[y * 32 + x]) / 32;
    }
    off = std::max(off, std::abs(difference - light));
    brightest = std::max(brightest, light);
  }
  EXPECT_LT(off, 0.25 * brightest);
}

TEST(SurfaceCells, NarrowHighlightsAreNobodyElses) {
  std::mt19937 random(test::seed());
  Shot shot;
  shot.materials = {lambert({0.2f, 0.2f, 0.2f}), lamp({60, 60, 60})};
  shot.materials[0].roughness = 0.2f;
  shot.meshes = {ball({0, 0, -10}, 1, 16, 0), parallelogram({-2, 1, -6}, {0, 1, 0}, {1, 0, 0}, 1)};
  shot.projection.width = shot.projection.height = 24;
  shot.projection.orthographic = true;
  shot.projection.view_height = 2;
  for (const IntegratorKind kind : kKinds) {
    const uint64_t seed = random();
    const auto shared = colours_of(render(shot, cell_params(kind, Cells::on, 4, seed)));
    const auto alone = colours_of(render(shot, cell_params(kind, Cells::off, 4, seed)));
    for (size_t i = 0; i < alone.size(); ++i) ASSERT_NEAR(shared[i], alone[i], 1e-5f) << i;
  }
}

}  // namespace
}  // namespace kairos
