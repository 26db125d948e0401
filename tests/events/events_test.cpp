// Events against what is known without them: closed forms, and the light at any instant by brute force.
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include <kairos/events.h>
#include <kairos/make_scene.h>

#include "error_matchers.h"
#include "events/coverage.h"
#include "math/sampler.h"
#include "recorded_events.h"
#include "seed.h"

namespace kairos {
namespace {

/// A half-plane at z = -1 whose edge flies over the picture in a second.
struct FlyingEdge {
  double angle, speed, begin;  // pixels a second, and from the picture's middle at time 0
  float before, after;

  std::shared_ptr<const Scene> scene() const {
    const Vec3d normal{std::cos(angle), -std::sin(angle), 0}, along{-normal.y, normal.x, 0};  // rows go down
    const auto corner = [&](double time, double back, double side) {
      const Vec3d p = normal * ((begin + speed * time - back) * kPixel) + along * (side * kPixel);
      return Vec3f{static_cast<float>(p.x), static_cast<float>(p.y), -1};
    };
    MeshDescription mesh;
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.times = {-1, 2};
    for (const double time : mesh.times)
      mesh.positions.push_back(
          {corner(time, 0, -40), corner(time, 0, 40), corner(time, 300, 40), corner(time, 300, -40)});
    SceneDescription description;
    description.meshes = {mesh};
    description.materials = {painted(after)};
    description.cameras = {camera()};
    description.background = {before, before, before};
    return make_scene(description);
  }

  /// The light of a pixel: how much of it the edge has covered.
  double light(int x, int y, double time, double shift = 0) const {
    const double to_middle = (x + 0.5 - kWidth / 2.0) * std::cos(angle) + (y + 0.5 - kHeight / 2.0) * std::sin(angle);
    const double covered = Coverage(std::cos(angle), std::sin(angle)).at(begin + speed * time + shift - to_middle);
    return before + (static_cast<double>(after) - before) * covered;
  }
};

TEST(Events, OfAStraightEdgeHaveExactStampsForAnyNumberOfRays) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  for (const int rays : {1, 4, 16}) {
    FlyingEdge edge;
    edge.angle = rays == 4 ? 0 : uniform(0, 6.28);
    edge.speed = uniform(60, 150);  // slower ones are cut off where a chunk ends
    edge.begin = uniform(-12, -2);
    edge.before = static_cast<float>(uniform(0.1, 1));
    edge.after = static_cast<float>(edge.before * (rays == 16 ? uniform(10, 50) : uniform(0.1, 0.5)));
    const EventOptions options = flat_options(rays);
    EventList collector;
    record_events(*edge.scene(), options, collector);
    const auto pixels = by_pixel(collector.events);
    constexpr double kRounding = 2e-4;  // pixels: of positions in single precision
    constexpr double kLevel = 1e-3;     // what that does to the level that a pixel begins with
    size_t count = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        double level = std::log(edge.light(x, y, 0) + kDark);
        const auto at = pixels.find({x, y});
        for (const Event& event : at == pixels.end() ? std::vector<Event>() : at->second) {
          level += event.polarity * 0.2;
          const double time = static_cast<double>(event.time) * 1e-9;
          // The level lies between what is seen a moment earlier and later.
          const double early = std::log(edge.light(x, y, time, -kRounding) + kDark),
                       late = std::log(edge.light(x, y, time, kRounding) + kDark);
          EXPECT_LE(std::min(early, late), level + kLevel) << "pixel " << x << ' ' << y << " at " << time;
          EXPECT_GE(std::max(early, late), level - kLevel) << "pixel " << x << ' ' << y << " at " << time;
          ++count;
        }
        EXPECT_LT(std::abs(std::log(edge.light(x, y, 1) + kDark) - level), 0.2 + 1e-3);  // none is missing
      }
    EXPECT_GT(count, 20u);
  }
}

TEST(Events, OfEdgesThatAreTooSlowToBeFollowedDoNotComeAllAtOnce) {
  std::mt19937 random(test::seed());
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  FlyingEdge edge;
  edge.angle = uniform(0, 6.28);
  edge.speed = uniform(1, 3);  // over a cell in several tenths of a second, of which a twentieth is followed
  edge.begin = uniform(-1, 0);
  edge.before = 0.05f;
  edge.after = 1;
  EventOptions options = flat_options(1);
  EventList collector;
  record_events(*edge.scene(), options, collector);
  EXPECT_GT(collector.events.size(), 30u);
  for (const auto& [pixel, events] : by_pixel(collector.events))
    for (size_t i = 1; i < events.size(); ++i)
      EXPECT_GT(events[i].time - events[i - 1].time, 10000) << "pixel " << pixel.first << ' ' << pixel.second;
}

/// Triangles that fly in front of the camera, each of one colour.
struct FlyingTriangles {
  struct One {
    std::array<std::array<Vec3f, 3>, 2> at;  // times 0 and 1
    float grey;
  };
  std::vector<One> all;

  explicit FlyingTriangles(std::mt19937& random) {
    const auto uniform = [&](double low, double high) {
      return static_cast<float>(std::uniform_real_distribution(low, high)(random));
    };
    for (int i = 0; i < 12; ++i) {
      One one;
      const Vec3f middle{uniform(-1, 1), uniform(-1, 1), uniform(-3, -2)},
          way{uniform(-1, 1), uniform(-1, 1), uniform(-0.5, 0.5)};
      for (size_t v = 0; v < 3; ++v) {
        const Vec3f corner = middle + Vec3f{uniform(-0.7, 0.7), uniform(-0.7, 0.7), uniform(-0.3, 0.3)};
        one.at[0][v] = corner;
        one.at[1][v] = corner + way + Vec3f{uniform(-0.2, 0.2), uniform(-0.2, 0.2), 0};
      }
      one.grey = uniform(0.02, 1);
      all.push_back(one);
    }
  }

  std::shared_ptr<const Scene> scene() const {
    SceneDescription description;
    for (const One& one : all) {
      MeshDescription mesh;
      mesh.triangles = {{0, 1, 2}};
      mesh.times = {-1, 2};  // longer than any recording: edges are on their way when it begins
      mesh.material = static_cast<uint32_t>(description.materials.size());
      for (const float time : {-1.0f, 2.0f}) {
        std::vector<Vec3f> corners;
        for (size_t v = 0; v < 3; ++v) corners.push_back(lerp(one.at[0][v], one.at[1][v], time));
        mesh.positions.push_back(corners);
      }
      description.meshes.push_back(mesh);
      description.materials.push_back(painted(one.grey));
    }
    description.cameras = {camera()};
    description.background = {0.1f, 0.1f, 0.1f};
    return make_scene(description);
  }

  /// What is nearest along the ray through a film point.
  double light(double x, double y, double time) const {
    const Vec3d ray{(x - kWidth / 2.0) * kPixel, (kHeight / 2.0 - y) * kPixel, -1};
    double nearest = std::numeric_limits<double>::infinity(), seen = 0.1f;
    for (const One& one : all) {
      std::array<Vec3d, 3> p;
      for (size_t v = 0; v < 3; ++v) p[v] = lerp(to_double(one.at[0][v]), to_double(one.at[1][v]), time);
      const double a = dot(ray, cross(p[1], p[2])), b = dot(ray, cross(p[2], p[0])), c = dot(ray, cross(p[0], p[1]));
      if (!((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0))) continue;
      const double dist = -(a * p[0].z + b * p[1].z + c * p[2].z) / (a + b + c);
      if (dist < nearest) {
        nearest = dist;
        seen = one.grey;
      }
    }
    return seen;
  }
};

TEST(Events, ClaimABrightnessWithinOneThresholdOfTheTrueOneAtAnyInstant) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const FlyingTriangles triangles(random);
  constexpr int kRays = 4, kInstants = 100;
  EventOptions options = flat_options(kRays);
  options.render.seed = seed;
  options.edges = EdgeModel::step;
  options.sensor.off = 0.3;
  EventList collector;
  record_events(*triangles.scene(), options, collector);
  EXPECT_GT(collector.events.size(), 30u);
  const Sampler sampler(SamplerKind::owen_sobol, kRays, options.render.seed);
  const auto light = [&](int x, int y, double time) {
    double sum = 0;
    for (uint32_t i = 0; i < kRays; ++i) {
      const SamplePoint point = sampler.point(sampler.pixel(x, y), i);
      sum += triangles.light(x + static_cast<double>(point.x), y + static_cast<double>(point.y), time) / kRays;
    }
    return sum;
  };
  int apart = 0;
  for (const auto& beyond : beyond_threshold(collector, options, kInstants, random, light))
    apart += *std::max_element(beyond.begin(), beyond.end()) > 1e-4;
  // An edge may lie so near to a pixel's ray at time 0, or to a corner, that rounding decides what is seen.
  EXPECT_LE(apart, 5) << "of " << kWidth * kHeight << " pixels";
}

/// Of the light of the whole area, which no ray knows. Straight edges are exact, corners within a ray's cell are not.
TEST(Events, ClaimTheBrightnessOfPixelsAreas) {
  std::mt19937 random(test::seed());
  constexpr int kScenes = 4, kInstants = 8, kGrid = 16;
  constexpr double kSlack = 0.02;
  std::map<EdgeModel, double> excess, share;
  for (int scene = 0; scene < kScenes; ++scene) {
    const FlyingTriangles triangles(random);
    const auto light = [&](int x, int y, double time) {
      double sum = 0;
      for (int row = 0; row < kGrid; ++row)
        for (int column = 0; column < kGrid; ++column)
          sum += triangles.light(x + (column + 0.5) / kGrid, y + (row + 0.5) / kGrid, time);
      return sum / (kGrid * kGrid);
    };
    for (const EdgeModel model : {EdgeModel::area, EdgeModel::step}) {
      EventOptions options = flat_options(16);
      options.render.seed = random();
      options.edges = model;
      options.chunk = 10;  // slow edges are followed all over a pixel, for a tenth of it
      EventList collector;
      record_events(*triangles.scene(), options, collector);
      EXPECT_GT(collector.events.size(), 30u);
      for (const auto& pixel : beyond_threshold(collector, options, kInstants, random, light))
        for (const double beyond : pixel) {
          excess[model] += std::max(beyond, 0.0);
          share[model] += beyond > kSlack ? 1.0 / (kScenes * kWidth * kHeight * kInstants) : 0;
        }
    }
  }
  EXPECT_LT(share[EdgeModel::area], 0.08);
  EXPECT_LT(excess[EdgeModel::area], 0.75 * excess[EdgeModel::step]);
}

TEST(Events, AreTheSameForAnyNumberOfThreadsAndNearlySoForOtherChunks) {
  std::mt19937 random(test::seed());
  const auto scene = FlyingTriangles(random).scene();
  EventOptions options = flat_options(4);
  const std::vector<Event> one = record(*scene, options);
  options.render.threads = 3;
  options.labels = true;  // which change nothing else
  EXPECT_EQ(record(*scene, options), one);

  FlyingEdge edge{0.4, 60, -6, 0.1f, 0.9f};
  const std::vector<Event> quarters = record(*edge.scene(), flat_options(4));
  options = flat_options(4);
  options.chunk = 1;
  std::vector<Event> whole = record(*edge.scene(), options);
  ASSERT_EQ(quarters.size(), whole.size());
  const auto pixel_first = [](const Event& a, const Event& b) {
    return std::tuple(a.y, a.x, a.time) < std::tuple(b.y, b.x, b.time);
  };
  std::vector<Event> sorted = quarters;
  std::sort(sorted.begin(), sorted.end(), pixel_first);
  std::sort(whole.begin(), whole.end(), pixel_first);
  for (size_t i = 0; i < sorted.size(); ++i) {
    EXPECT_EQ(sorted[i].x, whole[i].x);
    EXPECT_NEAR(static_cast<double>(sorted[i].time), static_cast<double>(whole[i].time), 2000) << "ns";
  }
}

/// A turned facet's |normal|, which changes while it is seen: what is between two looks is found to a bound.
TEST(Events, OfColoursThatChangeAreExactToAFractionOfAThreshold) {
  // A square around the view axis that turns about it: x and y of its normal are 0, so tilt it and turn about y.
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  constexpr int kKeys = 65;
  constexpr double kTurn = 1.2;  // radians in a second, from -0.6 on
  for (int k = 0; k < kKeys; ++k) {
    const double time = static_cast<double>(k) / (kKeys - 1), angle = -0.6 + kTurn * time;
    mesh.times.push_back(time);
    std::vector<Vec3f> corners;
    for (const auto& [u, v] : {std::pair{-9.0, -9.0}, {9.0, -9.0}, {9.0, 9.0}, {-9.0, 9.0}})
      corners.push_back({static_cast<float>(u * std::cos(angle)), static_cast<float>(v),
                         static_cast<float>(-20 + u * std::sin(angle))});
    mesh.positions.push_back(corners);
  }
  SceneDescription description;
  description.meshes = {mesh};
  description.cameras = {camera()};
  const auto scene = make_scene(description);
  EventOptions options = flat_options(1);
  options.render.shading = ShadingKind::normal;
  options.sensor.on = options.sensor.off = 0.05;
  options.looks = 2;
  options.labels = true;
  EventList collector;
  record_events(*scene, options, collector);
  const auto middle = by_pixel(collector.events)[{kWidth / 2, kHeight / 2}];
  ASSERT_GT(middle.size(), 6u);
  const auto brightness = [&](double time) {
    const double angle = -0.6 + kTurn * time;
    return std::log(0.2126 * std::abs(std::sin(angle)) + 0.0722 * std::cos(angle) + kDark);
  };
  double level = brightness(0);
  for (size_t i = 0; i < collector.events.size(); ++i) {
    if (std::abs(collector.events[i].x + 0.5 - kWidth / 2.0) > 2 || std::abs(collector.events[i].y - 4) > 2) continue;
    // There the facet is all that is seen: z (1 + x tan angle) = 20 along the ray to x, here that of the film's middle.
    EXPECT_FALSE(collector.labels[i].edge);
    EXPECT_EQ(collector.labels[i].surface, 1u);
    const double angle = -0.6 + kTurn * static_cast<double>(collector.events[i].time) * 1e-9;
    const double x = (collector.events[i].x + 0.5 - kWidth / 2.0) * kPixel, half = 0.6 * kPixel;
    const auto depth = [&](double at) { return 20 / (1 + at * std::tan(angle)); };
    EXPECT_NEAR(collector.labels[i].depth, depth(x), std::abs(depth(x + half) - depth(x - half)) + 0.01);
  }
  for (const Event& event : middle) {
    level += 0.05 * event.polarity;
    // Keys are straight: the angle is off by a part of (turn / keys)^2 / 8.
    EXPECT_NEAR(brightness(static_cast<double>(event.time) * 1e-9), level, 0.05 * 0.1);
  }
}

TEST(Events, OptionsOutOfRangeAreRefusedInOneLine) {
  const auto scene = FlyingEdge{0, 10, 0, 0.1f, 1}.scene();
  const auto refused = [&](const std::function<void(EventOptions&)>& spoil, const std::string& word) {
    EventOptions options = flat_options(4);
    spoil(options);
    expect_error([&] { record(*scene, options); }, {word}, ErrorCode::bad_usage);
  };
  refused([](EventOptions& o) { o.rays = 5; }, "rays per pixel");
  refused([](EventOptions& o) { o.to = o.from; }, "end after");
  refused([](EventOptions& o) { o.sensor.on = 0; }, "thresholds");
  refused([](EventOptions& o) { o.sensor.dark = std::nan(""); }, "dark");
  refused([](EventOptions& o) { o.sensor.bayer = "RGBW"; }, "Bayer");
}

/// Keeps, besides, what each chunk says at its end.
class ChunkKeeper : public EventList {
 public:
  void end_chunk(const std::function<std::vector<uint8_t>()>& state) override {
    states.push_back(state());
    counts.push_back(events.size());
  }
  std::vector<std::vector<uint8_t>> states;
  std::vector<size_t> counts;  // of events so far
};

TEST(Events, GoOnWhereARecordingWasCutOff) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const auto scene = FlyingTriangles(random).scene();
  EventOptions options = flat_options(4);
  options.chunk = 0.125;
  options.labels = true;
  options.sensor = *event_sensor("v2e-noisy");
  options.sensor.refractory = 1e-3;
  ChunkKeeper whole;
  const EventStats stats = record_events(*scene, options, whole);
  ASSERT_EQ(whole.states.size(), 8u);
  const size_t cut = random() % 7;
  options.resume = whole.states[cut];
  EventList rest;
  const EventStats both = record_events(*scene, options, rest);
  EXPECT_EQ(both.on, stats.on);
  EXPECT_EQ(both.meshes, stats.meshes);
  const auto begin = whole.events.begin() + static_cast<std::ptrdiff_t>(whole.counts[cut]);
  EXPECT_GT(rest.events.size(), 0u);
  EXPECT_EQ(rest.events, std::vector<Event>(begin, whole.events.end()));
  EXPECT_EQ(rest.labels.size(), rest.events.size());
  // What was kept may have been damaged.
  const size_t size = random() % options.resume.size();
  options.resume.resize(std::max<size_t>(size, 1));
  expect_error([&] { record_events(*scene, options, rest); }, {"unfinished", "broken"});
}

}  // namespace
}  // namespace kairos
