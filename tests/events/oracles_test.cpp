// Events against light in closed form: turning edges, gratings, wires, discs, and walls on which there are none.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <kairos/event_compare.h>
#include <kairos/image.h>
#include <kairos/render.h>

#include "events/coverage.h"
#include "recorded_events.h"
#include "seed.h"

namespace kairos {
namespace {

/// light(x, y, time): of a pixel. A level at an event must lie between what is seen `slack` seconds earlier and later.
/// level_slack: of what a pixel begins with. Returns the number of events of those pixels that are looked at.
size_t expect_levels(const EventList& collector, double slack, const std::function<bool(int x, int y)>& looked_at,
                     const std::function<double(int x, int y, double time)>& light, double level_slack = 0.02) {
  size_t count = 0;
  for (const auto& [pixel, events] : by_pixel(collector.events)) {
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
  EventList collector;
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
  EventList collector;
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
  EventList collector;
  record_events(*make_scene(scene_of(mesh, 0.1f, 1)), flat_options(1), collector);
  EXPECT_GT(expect_levels(
                collector, 1e-3 / speed, [](int, int) { return true; }, light),
            100u);
}

/// Two edges of one surface fly over each pixel, in directions of their own; where they cross, in which pixels are
/// looked at apart, their coverages are no sum.
TEST(EventOracles, OfEdgesThatCrossGetBetterWithMoreRays) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  constexpr int kScenes = 4, kInstants = 12, kGrid = 20;
  std::array<double, 3> excess{}, apart{};  // of 1, 4 and 16 rays; apart: at pixels that no corner passes
  for (int number = 0; number < kScenes; ++number) {
    // A wedge that flies to where it points.
    const double angle = uniform(0, 6.28), opening = uniform(0.5, 1.2), speed = uniform(8, 14);
    const std::array<double, 2> normals{angle + opening, angle - opening};
    const auto tip = [&](double time) {
      const double far = speed * (time - 0.5);
      return std::array{far * std::cos(angle), far * std::sin(angle)};
    };
    MeshDescription mesh;
    mesh.triangles = {{0, 1, 2}};
    mesh.times = {-1, 2};
    for (const double time : mesh.times) {
      const auto [x, y] = tip(time);
      std::vector<Vec3f> corners{on_film(x, y)};
      // Along its two sides, backwards: at right angles to their normals.
      for (const double side : {angle + opening + std::numbers::pi / 2, angle - opening - std::numbers::pi / 2})
        corners.push_back(on_film(x + 60 * std::cos(side), y + 60 * std::sin(side)));
      mesh.positions.push_back(corners);
    }
    const auto past = [&](double x, double y, double time, size_t side) {
      const auto [tip_x, tip_y] = tip(time);
      return (tip_x - x) * std::cos(normals[side]) + (tip_y - y) * std::sin(normals[side]);
    };
    const auto light = [&](int x, int y, double time) {
      double covered = 0;
      for (int i = 0; i < kGrid * kGrid; ++i) {
        const double right = x + (i % kGrid + 0.5) / kGrid - kWidth / 2.0,
                     down = y + (i / kGrid + 0.5) / kGrid - kHeight / 2.0;
        covered += past(right, down, time, 0) > 0 && past(right, down, time, 1) > 0;
      }
      return 0.1 + 0.9 * covered / (kGrid * kGrid);
    };
    const auto scene = make_scene(scene_of(mesh, 0.1f, 1));
    const auto seed = random();
    for (size_t i = 0; i < excess.size(); ++i) {
      EventOptions options = flat_options(std::array{1, 4, 16}[i]);
      options.chunk = 10;
      EventList collector;
      record_events(*scene, options, collector);
      std::mt19937 instants(seed);
      const auto pixels = beyond_threshold(collector, options, kInstants, instants, light);
      for (size_t pixel = 0; pixel < pixels.size(); ++pixel) {
        // How far the tip's way is from the pixel's middle.
        const double x = static_cast<double>(pixel % kWidth) + 0.5 - kWidth / 2.0,
                     y = static_cast<double>(pixel / kWidth) + 0.5 - kHeight / 2.0;
        const bool crossed = std::abs(x * std::sin(angle) - y * std::cos(angle)) < 1;
        for (const double beyond : pixels[pixel]) (crossed ? excess : apart)[i] += std::max(beyond, 0.0);
      }
    }
  }
  EXPECT_LT(excess[2], 0.75 * excess[0]) << excess[0] << ' ' << excess[1] << ' ' << excess[2];
  for (const double beyond : apart) EXPECT_LT(beyond, 1) << "where one edge passes after the other";
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
      EventList collector;
      record_events(*scene, options, collector);
      std::mt19937 instants(seed);
      for (const auto& pixel : beyond_threshold(collector, options, kInstants, instants, light))
        for (const double beyond : pixel) excess[i] += std::max(beyond, 0.0);
    }
  }
  EXPECT_LT(excess[2], 0.6 * excess[0]);
}

/// A picture's borders are known to who looks at it alone: rays jump. Against many more of them.
TEST(EventOracles, OfTexturedPlanesGetBetterWithMoreRays) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  Pixels picture;
  picture.width = picture.height = 8;
  for (int i = 0; i < 64; ++i) {
    const auto grey = static_cast<float>(uniform(0.05, 1));
    picture.values.insert(picture.values.end(), {grey, grey, grey, 1});
  }
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  constexpr double kSeconds = 0.1;
  mesh.times = {0, kSeconds};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  const double turn = uniform(0, 6.28), far = uniform(4, 6);
  for (const double way : {-0.5, 0.5}) {
    std::vector<Vec3f> corners;
    for (const auto& [x, y] : {std::pair{-12.0, -12.0}, {-12.0, 12.0}, {12.0, 12.0}, {12.0, -12.0}})
      corners.push_back(
          on_film(x * std::cos(turn) - y * std::sin(turn) + way * far, x * std::sin(turn) + y * std::cos(turn)));
    mesh.positions.push_back(corners);
  }
  SceneDescription description = scene_of(mesh, 0.5f, 1);
  description.pictures["squares"] = picture;
  description.materials[0].base_color_texture.picture = "squares";
  const auto scene = make_scene(description);
  std::array<std::vector<Event>, 3> streams;
  for (size_t i = 0; i < streams.size(); ++i) {
    EventOptions options = flat_options(std::array{1, 16, 256}[i]);
    options.to = kSeconds;
    streams[i] = record(*scene, options);
  }
  ASSERT_GT(streams[2].size(), 50u);
  const auto off = [&](size_t i) { return compare_events(streams[2], streams[i], 20000000).brightness_rms; };
  EXPECT_LT(off(1), 0.6 * off(0));
  EXPECT_LT(off(1), 0.4) << "thresholds";
}

/// What rests is lit along ways that rest: each is asked once when anything is in between, in place of looks.
TEST(EventOracles, OfShadowsOnWhatRestsAreThoseThatLooksFind) {
  std::mt19937 random(test::seed());
  SceneDescription description = flying_things(random, true);
  description.lights = {DirectionalLight{{0.3f, -0.2f, -1}, {1, 1, 1}}, PointLight{{-1, 1, 0}, {2, 2, 2}},
                        ConstantLight{{0.3f, 0.3f, 0.3f}}};
  MeshDescription lamp;  // out of sight
  lamp.triangles = {{0, 1, 2}};
  lamp.positions = {{{3, 2, -1}, {4, 2, -1}, {3, 3, -1}}};
  lamp.material = static_cast<uint32_t>(description.materials.size());
  description.meshes.push_back(lamp);
  description.materials.push_back(painted(0));
  description.materials.back().emission = {20, 20, 20};
  const auto scene = make_scene(description);
  EventOptions options = flat_options(4);
  options.render.shading = ShadingKind::whitted;
  options.render.seed = random();
  options.sensor.on = options.sensor.off = 0.1;
  options.looks = 256;  // shadows that pass in less are missed
  EventStats exact, sampled;
  const std::vector<Event> found = record(*scene, options, &exact);
  options.render.shadows = Shadows::sampled;
  const std::vector<Event> looked_for = record(*scene, options, &sampled);
  const EventDifference difference = compare_events(looked_for, found, 1000000);
  EXPECT_GT(difference.reference, 100u);
  EXPECT_LT(static_cast<double>(difference.missing + difference.extra),
            0.05 * static_cast<double>(difference.reference));
  EXPECT_LT(difference.median, 2000) << "ns";
  EXPECT_LT(exact.shading_samples, sampled.shading_samples * 3 / 4);
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
