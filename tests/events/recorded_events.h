// Small scenes, recorded: what tests of events share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <kairos/events.h>
#include <kairos/make_scene.h>

namespace kairos {

inline std::map<std::pair<int, int>, std::vector<Event>> by_pixel(const std::vector<Event>& events) {
  std::map<std::pair<int, int>, std::vector<Event>> pixels;
  for (const Event& event : events) pixels[{event.x, event.y}].push_back(event);
  return pixels;
}

inline constexpr int kWidth = 12, kHeight = 9;
inline constexpr double kDark = 1.0 / 255;
/// Frustum of 1 by 4/3 at z = -1: a pixel is 1/9.
inline constexpr double kPixel = 1.0 / kHeight;

inline Material painted(float grey) {
  Material material;
  material.base_color = {grey, grey, grey};
  return material;
}

inline CameraDescription camera() {
  CameraDescription description;
  description.vfov = 2 * std::atan(0.5);
  description.keys = {{}};
  return description;
}

inline EventOptions flat_options(int rays) {
  EventOptions options;
  options.render.shading = ShadingKind::flat;
  options.render.threads = 1;
  options.shot.width = kWidth;
  options.shot.height = kHeight;
  options.rays = rays;
  options.chunk = 0.25;
  return options;
}

inline std::vector<Event> record(const Scene& scene, const EventOptions& options, EventStats* stats = nullptr) {
  EventList collector;
  const EventStats got = record_events(scene, options, collector);
  EXPECT_TRUE(std::is_sorted(collector.events.begin(), collector.events.end()));
  EXPECT_EQ(got.on + got.off, collector.events.size());
  if (stats != nullptr) *stats = got;
  return collector.events;
}

/// How much farther than a threshold the brightness that events claim is from the true one: [pixel][instant], at random
/// instants. light(x, y, time): the true light.
template <class Light>
std::vector<std::vector<double>> beyond_threshold(const EventList& collector, const EventOptions& options, int instants,
                                                  std::mt19937& random, const Light& light) {
  auto pixels = by_pixel(collector.events);
  const double on = options.sensor.on, off = options.sensor.off;
  std::vector<std::vector<double>> all;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double first = std::log(light(x, y, 0) + kDark);
      std::vector<double>& beyond = all.emplace_back();
      for (int i = 0; i < instants; ++i) {
        const double time = std::uniform_real_distribution(0.0, 1.0)(random);
        double claimed = first;
        for (const Event& event : pixels[{x, y}])
          if (static_cast<double>(event.time) * 1e-9 <= time) claimed += event.polarity > 0 ? on : -off;
        const double apart = std::log(light(x, y, time) + kDark) - claimed;
        beyond.push_back(std::max(apart - on, -apart - off));
      }
    }
  return all;
}

/// Some triangles of their own colours that fly and turn before a wall, which is textured where there is a picture.
inline SceneDescription flying_things(std::mt19937& random, bool textured) {
  const auto uniform = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution(low, high)(random));
  };
  SceneDescription description;
  MeshDescription wall;
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall.positions = {{{-4, -4, -5}, {4, -4, -5}, {4, 4, -5}, {-4, 4, -5}}};
  wall.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  description.meshes = {wall};
  description.materials = {painted(0.6f)};
  if (textured) {
    Pixels picture;
    picture.width = picture.height = 8;
    for (int i = 0; i < 64; ++i) {
      const float grey = uniform(0.2, 1);
      picture.values.insert(picture.values.end(), {grey, grey, grey, 1});
    }
    description.pictures["squares"] = picture;
    description.materials[0].base_color_texture.picture = "squares";
  }
  for (int i = 0; i < 12; ++i) {
    MeshDescription mesh;
    mesh.triangles = {{0, 1, 2}};
    mesh.times = {-1, 0.5, 2};
    mesh.material = static_cast<uint32_t>(description.materials.size());
    const Vec3f middle{uniform(-0.8, 0.8), uniform(-0.6, 0.6), uniform(-3, -2)};
    std::array<Vec3f, 3> from_middle;
    for (Vec3f& corner : from_middle) corner = {uniform(-0.7, 0.7), uniform(-0.7, 0.7), uniform(-0.3, 0.3)};
    for (size_t k = 0; k < mesh.times.size(); ++k) {
      const Vec3f shift{uniform(-1.2, 1.2), uniform(-1.2, 1.2), uniform(-0.2, 0.2)};
      std::vector<Vec3f> corners;
      for (const Vec3f& corner : from_middle) corners.push_back(middle + shift + corner);
      mesh.positions.push_back(corners);
    }
    description.meshes.push_back(mesh);
    description.materials.push_back(painted(uniform(0.05, 1)));
  }
  description.cameras = {camera()};
  description.background = {0.1f, 0.1f, 0.1f};
  return description;
}

}  // namespace kairos
