// Events against light in closed form: turning edges, gratings, wires, discs, and walls on which there are none.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "events/coverage.h"
#include "recorded_events.h"
#include "seed.h"

namespace kairos {
namespace {

/// light(x, y, time): of a pixel. A level at an event must lie between what is seen `slack` seconds earlier and later.
/// level_slack: of what a pixel begins with. Returns the number of events of those pixels that are looked at.
size_t expect_levels(const Collector& collector, double slack, const std::function<bool(int x, int y)>& looked_at,
                     const std::function<double(int x, int y, double time)>& light, double level_slack = 0.02) {
  size_t count = 0;
  for (const auto& [pixel, events] : collector.by_pixel()) {
    const auto [x, y] = pixel;
    if (!looked_at(x, y)) continue;
    double level = std::log(light(x, y, 0) + kDark);
    for (const Event& event : events) {
      level += event.polarity * 0.2;
      const double time = static_cast<double>(event.time) * 1e-9;
      const double early = std::log(light(x, y, time - slack) + kDark),
                   late = std::log(light(x, y, time + slack) + kDark);
      EXPECT_LE(std::min(early, late), level + level_slack) << "pixel " << x << ' ' << y << " at " << time;
      EXPECT_GE(std::max(early, late), level - level_slack) << "pixel " << x << ' ' << y << " at " << time;
      ++count;
    }
  }
  return count;
}

/// A point of the film, in pixels from its middle, right and down, at z = -1.
Vec3f on_film(double right, double down) {
  return {static_cast<float>(right * kPixel), static_cast<float>(-down * kPixel), -1};
}

SceneDescription scene_of(const MeshDescription& mesh, float before, float after) {
  SceneDescription description;
  description.meshes = {mesh};
  description.materials = {painted(after)};
  description.cameras = {camera()};
  description.background = {before, before, before};
  return description;
}

TEST(EventOracles, OfATurningEdge) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const double hub_x = uniform(-1, 1), hub_y = uniform(-1, 1), first = uniform(0, 6.28), turn = uniform(1, 1.5);
  const auto angle = [&](double time) { return first + turn * time; };  // of the edge's normal
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  constexpr int kKeys = 1025;
  for (int k = 0; k < kKeys; ++k) {
    const double time = -1 + 3.0 * k / (kKeys - 1), cos = std::cos(angle(time)), sin = std::sin(angle(time));
    mesh.times.push_back(time);
    std::vector<Vec3f> corners;
    for (const auto& [back, side] : {std::pair{0.0, -40.0}, {0.0, 40.0}, {60.0, 40.0}, {60.0, -40.0}})
      corners.push_back(on_film(hub_x - back * cos - side * sin, hub_y - back * sin + side * cos));
    mesh.positions.push_back(corners);
  }
  const auto light = [&](int x, int y, double time) {
    const double cos = std::cos(angle(time)), sin = std::sin(angle(time));
    const double past = -((x + 0.5 - kWidth / 2.0 - hub_x) * cos + (y + 0.5 - kHeight / 2.0 - hub_y) * sin);
    return 0.1 + 0.9 * Coverage(cos, sin).at(past);
  };
  EventOptions options = flat_options(16);
  options.shot.motion_tolerance = 1e-3;
  options.chunk = 10;  // slow edges are followed all over a ray's cell
  Collector collector;
  record_events(*make_scene(scene_of(mesh, 0.1f, 1)), options, collector);
  // Away from the hub: there the edge turns a good deal while it passes a ray's cell.
  const auto far = [&](int x, int y) {
    return std::hypot(x + 0.5 - kWidth / 2.0 - hub_x, y + 0.5 - kHeight / 2.0 - hub_y) > 3;
  };
  constexpr double kOff = 0.015;  // pixels, three of them away from the hub
  EXPECT_GT(expect_levels(collector, kOff / (3 * turn), far, light), 100u);
}

/// Its cells see it through points: the light of a pixel is nearly that of its area, of which a sine is left in
/// proportion to sin(pi f) / (pi f).
TEST(EventOracles, OfAMovingGrating) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  constexpr int kTexels = 512, kWaves = 8;
  const double period = uniform(7, 9), speed = uniform(6, 12), mean = 0.5, swing = 0.35;  // pixels, a second
  Pixels picture;
  picture.width = kTexels;
  picture.height = 1;
  for (int i = 0; i < kTexels; ++i) {
    const double phase = 2 * std::numbers::pi * kWaves * (i + 0.5) / kTexels;
    for (int c = 0; c < 4; ++c)
      picture.values.push_back(c == 3 ? 1.0f : static_cast<float>(mean + swing * std::sin(phase)));
  }
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.times = {-1, 2};
  const double length = kWaves * period;  // of the picture, on the film
  for (const double time : mesh.times)
    mesh.positions.push_back({on_film(speed * time - 2 * length, -20), on_film(speed * time - 2 * length, 20),
                              on_film(speed * time + 2 * length, 20), on_film(speed * time + 2 * length, -20)});
  mesh.uvs = {{-2, 0}, {-2, 1}, {2, 1}, {2, 0}};
  SceneDescription description = scene_of(mesh, 0.5f, 1);
  description.pictures["grating"] = picture;
  description.materials[0].base_color_texture.picture = "grating";
  const auto light = [&](int x, int, double time) {
    const double f = 1 / period, place = x + 0.5 - kWidth / 2.0 - speed * time;
    return mean +
           swing * std::sin(std::numbers::pi * f) / (std::numbers::pi * f) * std::sin(2 * std::numbers::pi * f * place);
  };
  EventOptions options = flat_options(64);
  options.looks = 8;  // and as many more as it takes
  Collector collector;
  record_events(*make_scene(description), options, collector);
  // Pixels: 64 points, and not the area; and at the least light there is, a part of it, as pictures are smoothed, too.
  constexpr double kOff = 0.08;
  EXPECT_GT(expect_levels(
                collector, kOff / speed, [](int, int) { return true; }, light),
            500u);
}

/// Exact with a single ray, however thin it is: what its second edge takes away, its first one has given.
TEST(EventOracles, OfAWireThinnerThanAPixel) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const double angle = uniform(0, 6.28), speed = uniform(60, 100), width = uniform(0.1, 0.9), begin = uniform(-12, -9);
  const double cos = std::cos(angle), sin = std::sin(angle);
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.times = {-1, 2};
  for (const double time : mesh.times) {
    std::vector<Vec3f> corners;
    for (const auto& [back, side] : {std::pair{0.0, -40.0}, {0.0, 40.0}, {width, 40.0}, {width, -40.0}})
      corners.push_back(
          on_film((begin + speed * time - back) * cos - side * sin, (begin + speed * time - back) * sin + side * cos));
    mesh.positions.push_back(corners);
  }
  const auto light = [&](int x, int y, double time) {
    const double past = begin + speed * time - (x + 0.5 - kWidth / 2.0) * cos - (y + 0.5 - kHeight / 2.0) * sin;
    const Coverage coverage(cos, sin);
    return 0.1 + 0.9 * (coverage.at(past) - coverage.at(past - width));
  };
  Collector collector;
  record_events(*make_scene(scene_of(mesh, 0.1f, 1)), flat_options(1), collector);
  EXPECT_GT(expect_levels(
                collector, 1e-3 / speed, [](int, int) { return true; }, light),
            100u);
}

/// Of curved outlines the error falls as the number of rays grows.
TEST(EventOracles, OfDiscsGetBetterWithMoreRays) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  constexpr int kDiscs = 3, kCorners = 48, kInstants = 6, kGrid = 24;
  std::array<double, 3> excess{};  // of 1, 4 and 16 rays
  for (int disc = 0; disc < kDiscs; ++disc) {
    const double radius = uniform(1, 2), way_x = uniform(6, 10), way_y = uniform(-4, 4);
    MeshDescription mesh;
    mesh.times = {-1, 2};
    for (uint32_t i = 2; i < kCorners; ++i) mesh.triangles.push_back({0, i - 1, i});
    for (const double time : mesh.times) {
      std::vector<Vec3f> corners;
      for (int i = 0; i < kCorners; ++i) {
        const double at = -2 * std::numbers::pi * i / kCorners;
        corners.push_back(
            on_film((time - 0.5) * way_x + radius * std::cos(at), (time - 0.5) * way_y + radius * std::sin(at)));
      }
      mesh.positions.push_back(corners);
    }
    const auto light = [&](int x, int y, double time) {
      double covered = 0;
      for (int i = 0; i < kGrid * kGrid; ++i)
        covered += std::hypot(x + (i % kGrid + 0.5) / kGrid - kWidth / 2.0 - (time - 0.5) * way_x,
                              y + (i / kGrid + 0.5) / kGrid - kHeight / 2.0 - (time - 0.5) * way_y) < radius;
      return 0.1 + 0.9 * covered / (kGrid * kGrid);
    };
    const auto scene = make_scene(scene_of(mesh, 0.1f, 1));
    const auto seed = random();
    for (size_t i = 0; i < excess.size(); ++i) {
      EventOptions options = flat_options(std::array{1, 4, 16}[i]);
      options.chunk = 10;
      Collector collector;
      record_events(*scene, options, collector);
      std::mt19937 instants(seed);
      for (const auto& pixel : beyond_threshold(collector, options, kInstants, instants, light))
        for (const double beyond : pixel) excess[i] += std::max(beyond, 0.0);
    }
  }
  EXPECT_LT(excess[2], 0.6 * excess[0]);
}

/// Edges within it are none, though a hundred triangles pass each ray.
TEST(EventOracles, OfAnEvenWallBeforeAMovingCameraThereAreNone) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  MeshDescription mesh;
  constexpr uint32_t kSide = 60;
  std::vector<Vec3f> corners;
  for (uint32_t row = 0; row <= kSide; ++row)
    for (uint32_t column = 0; column <= kSide; ++column)
      corners.push_back({static_cast<float>(column) / 5 - 6, static_cast<float>(row) / 5 - 6,
                         static_cast<float>(-1.5 + uniform(-0.02, 0.02))});
  for (uint32_t row = 0; row < kSide; ++row)
    for (uint32_t column = 0; column < kSide; ++column) {
      const uint32_t corner = row * (kSide + 1) + column;
      mesh.triangles.push_back({corner, corner + 1, corner + kSide + 2});
      mesh.triangles.push_back({corner, corner + kSide + 2, corner + kSide + 1});
    }
  mesh.positions = {corners};
  SceneDescription description = scene_of(mesh, 0, 0.7f);
  description.cameras[0].keys.clear();
  for (const double time : {-1.0, 2.0})
    description.cameras[0].keys.push_back({time,
                                           {uniform(-0.4, 0.4), uniform(-0.4, 0.4), uniform(-0.3, 0.3)},
                                           {uniform(-0.4, 0.4), uniform(-0.4, 0.4), -1.5},
                                           {uniform(-0.3, 0.3), 1, 0}});
  EventStats stats;
  EXPECT_TRUE(record(*make_scene(description), flat_options(4), &stats).empty());
  EXPECT_EQ(stats.edges + stats.steps, 0u);
}

}  // namespace
}  // namespace kairos
