// Small scenes, recorded: what tests of events share.
#pragma once

#include <algorithm>
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

}  // namespace kairos
