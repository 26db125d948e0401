// What made each event: a surface, what it hides, how far off it is and where it goes.
#include <map>

#include <gtest/gtest.h>

#include <kairos/events.h>
#include <kairos/make_scene.h>

#include "recorded_events.h"
#include "seed.h"

namespace kairos {
namespace {

/// A strip flies to the right in front of a wall that rises.
TEST(Events, AreLabelledWithTheSurfacesThatMakeThem) {
  constexpr double kSpeed = 60, kRise = 3, kStrip = 5;  // pixels a second; pixels
  const auto quad = [](double left, double right, double shift_x, double shift_y, float z) {
    MeshDescription mesh;
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.times = {0, 1};
    for (const double time : mesh.times) {
      std::vector<Vec3f> corners;
      for (const auto& [x, y] : {std::pair{left, -50.0}, {right, -50.0}, {right, 50.0}, {left, 50.0}})
        corners.push_back({static_cast<float>((x + shift_x * time) * kPixel) * -z,
                           static_cast<float>((y + shift_y * time) * kPixel) * -z, z});
      mesh.positions.push_back(corners);
    }
    return mesh;
  };
  constexpr double kBegin = -20;  // of the strip's right edge, from the picture's middle
  SceneDescription description;
  description.meshes = {quad(-99, 99, 0, kRise, -2), quad(kBegin - kStrip, kBegin, kSpeed, 0, -1)};
  description.meshes[1].material = 1;
  description.materials = {painted(0.2f), painted(0.9f)};
  description.cameras = {camera()};
  const auto scene = make_scene(description);
  for (const EdgeModel model : {EdgeModel::area, EdgeModel::step}) {
    EventOptions options = flat_options(4);
    options.render.seed = test::seed();
    options.edges = model;
    options.labels = true;
    options.sensor.shot_noise = 20;
    EventList collector;
    record_events(*scene, options, collector);
    ASSERT_EQ(collector.labels.size(), collector.events.size());
    std::map<std::pair<EventKind, int>, int> counts;
    for (size_t i = 0; i < collector.events.size(); ++i) {
      const Event& event = collector.events[i];
      const EventLabel& label = collector.labels[i];
      const bool signal = event.kind == EventKind::signal;
      ++counts[{event.kind, event.polarity}];
      EXPECT_EQ(label.edge, signal);
      const double front = kBegin + kSpeed * static_cast<double>(event.time) * 1e-9 + kWidth / 2.0;
      if (signal) {
        EXPECT_EQ(label.surface, 2u);
        EXPECT_EQ(label.behind, 1u);
      } else {
        EXPECT_EQ(label.behind, label.surface);
        // Whole pixels that show one of them.
        const bool is_strip = event.x + 1 < front && event.x > front - kStrip;
        const bool is_wall = event.x > front || event.x + 1 < front - kStrip;
        EXPECT_TRUE(label.surface == 2 ? !is_wall : label.surface == 1 && !is_strip) << label.surface;
      }
      EXPECT_NEAR(label.depth, label.surface == 2 ? 1 : 2, 1e-4);
      EXPECT_NEAR(label.flow[0], label.surface == 2 ? kSpeed : 0, 0.01);
      EXPECT_NEAR(label.flow[1], label.surface == 2 ? 0 : -kRise, 0.01);
    }
    for (const EventKind kind : {EventKind::signal, EventKind::shot})
      for (const int polarity : {1, -1}) EXPECT_GT((counts[{kind, polarity}]), 20);
  }
}

/// A tent whose sides have other colours under |normal| flies past: its ridge hides nothing.
TEST(Events, OfARidgeAreNoOutlines) {
  SceneDescription description;
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  mesh.times = {0, 1};
  for (const float shift : {-2.0f, 2.0f})
    mesh.positions.push_back({{shift - 9, -20, -4},
                              {shift, -20, -3},
                              {shift, 20, -3},
                              {shift - 9, 20, -4},
                              {shift + 60, -20, -30},
                              {shift + 60, 20, -30}});
  description.meshes = {mesh};
  description.cameras = {camera()};
  EventOptions options = flat_options(4);
  options.render.shading = ShadingKind::normal;
  options.labels = true;
  EventList collector;
  record_events(*make_scene(description), options, collector);
  EXPECT_GT(collector.events.size(), 50u);
  for (const EventLabel& label : collector.labels) {
    EXPECT_FALSE(label.edge);
    EXPECT_EQ(label.surface, 1u);
    EXPECT_EQ(label.behind, 1u);
  }
}

}  // namespace
}  // namespace kairos
