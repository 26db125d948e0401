// Pixels that are exposed at their own times: rolling shutters, curves and interval maps, directly rendered.
#include <cmath>
#include <map>
#include <mutex>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/picture.h>
#include <kairos/render.h>

#include "error_matchers.h"
#include "image/texture.h"
#include "render/busy_shot.h"
#include "seed.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

constexpr int kWidth = 24, kHeight = 16;
constexpr double kOpen = 2, kClose = 2.5;  // of shots, scene time

Shot shot_of(std::mt19937& random, bool blended) {
  Shot shot = test::busy_shot(random, {test::Motion::still, test::Motion::deform, test::Motion::translation}, blended,
                              kWidth, kHeight);
  shot.shutter_open = kOpen;
  shot.shutter_close = kClose;
  return shot;
}

/// Opens at 0.05 s of the shot, line after line; all of it lies in the shot.
Shutter rolling() {
  Shutter shutter;
  shutter.open = 0.05;
  shutter.close = 0.15;
  shutter.open_line = shutter.close_line = 0.02;
  return shutter;
}
TimeWeight trapezoid() { return TimeWeight({{0, 0}, {0.25, 1}, {0.5, 1}, {1, 0}}); }

Exposure exposure_of(const Shutter& shutter, const Shot& shot) {
  return {shutter, kOpen, shot.projection.width, shot.projection.height, shot.shutter_open, shot.shutter_close};
}

/// Reduces records of the whole shutter pixel by pixel.
class Afterwards : public PixelConsumer {
 public:
  explicit Afterwards(const Exposure& exposure) : exposure_(exposure) {}
  RecordNeeds needs() const override { return {RecordNeeds::Time::curves, false, false}; }
  void add(const PixelRecord& record) override {
    const PixelMeans means = reduce(record, exposure_.weight(record.x, record.y));
    const std::lock_guard<std::mutex> lock(mutex_);
    colours[{record.x, record.y}] = means.colour;
  }
  std::map<std::pair<int, int>, Vec3f> colours;

 private:
  const Exposure& exposure_;
  std::mutex mutex_;
};

Vec3f pixel(const Image& image, int x, int y) {
  const size_t at =
      static_cast<size_t>(y - image.top) * static_cast<size_t>(image.width) + static_cast<size_t>(x - image.left);
  return {image.channels[0].values[at], image.channels[1].values[at], image.channels[2].values[at]};
}

// Rays that look at a line's window alone see what rays of the whole shutter see in it: colours of a flat surface do
// not depend on where shading samples lie, and without alignment both have the same rays.
TEST(Exposure, ARayOfALineSeesWhatARayOfTheWholeShutterSeesInItsWindow) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const bool blended : {false, true})
    for (const bool curved : {false, true}) {
      const Shot shot = shot_of(random, blended);
      Shutter shutter = rolling();
      if (curved) shutter.curve = trapezoid();
      const Exposure exposure = exposure_of(shutter, shot);
      RenderParams params;
      params.integrator = IntegratorKind::tc;
      params.tc_rays = 1;  // of more, places depend on what is needed of them
      params.shading = ShadingKind::flat;
      params.seed = seed;
      Afterwards afterwards(exposure);
      PixelConsumer* const consumer = &afterwards;
      Renderer(shot).render(params, {&consumer, 1});
      params.exposure = exposure;
      const Image directly = render(shot, params);
      for (const auto& [place, colour] : afterwards.colours)
        for (int i = 0; i < 3; ++i)
          EXPECT_NEAR(pixel(directly, place.first, place.second)[i], colour[i], 2e-4)
              << place.first << "," << place.second << (blended ? " blended" : "") << (curved ? " curved" : "");
    }
}

// The second formulation: rays of one instant, whose times are drawn from the line's own curve.
TEST(Exposure, DiscreteRaysDrawnFromALinesCurveAgree) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed, IntegratorKind::automatic})
    for (const Scan scan : {Scan::top, Scan::right}) {
      const Shot shot = shot_of(random, true);
      Shutter shutter = rolling();
      shutter.scan = scan;
      if (scan == Scan::top)
        shutter.curve = trapezoid();
      else
        shutter.open_line = shutter.close_line = 0.01;
      RenderParams params;
      params.shading = ShadingKind::flat;
      params.seed = seed;
      params.exposure = exposure_of(shutter, shot);
      params.integrator = IntegratorKind::qmc;
      params.spp = 4096;
      const Image discrete = render(shot, params);
      params.integrator = kind;
      params.spp = 1024;
      params.tc_rays = 256;
      // auto has about as many, whatever it would think of their prices: in so small a picture it looks at nothing
      // else.
      params.calibration = {100, 10, {300, 300, 300}};
      const Image continuous = render(shot, params);
      double sum = 0, difference = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          for (int i = 0; i < 3; ++i) {
            const double d = static_cast<double>(pixel(discrete, x, y)[i] - pixel(continuous, x, y)[i]);
            sum += d * d;
            difference += d;
          }
      constexpr int kValues = 3 * kWidth * kHeight;
      EXPECT_LT(std::sqrt(sum / kValues), 0.008) << "integrator " << static_cast<int>(kind);
      EXPECT_LT(std::abs(difference / kValues), 0.0008) << "integrator " << static_cast<int>(kind);
    }
}

/// Looks at every part.
class InWindows : public PixelConsumer {
 public:
  RecordNeeds needs() const override { return {}; }
  void add(const PixelRecord& record) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const TimeRange window = record.window;
    const auto look = [&](const PixelRay& ray) {
      if (!ray.is_over_time()) outside += !(ray.time >= window.begin && ray.time < window.end);
      for (const SeenPart& part : record.parts_of(ray)) {
        ++parts;
        outside += !(part.where.begin >= window.begin && part.where.end <= window.end);
        for (const Knot& knot : record.knots_of(part))
          foreign += !(knot.time >= window.begin && knot.time <= window.end);
      }
    };
    for (const PixelRay& ray : record.rays) look(ray);
    for (const PixelRay& ray : record.still.rays) look(ray);
  }
  size_t parts = 0, outside = 0, foreign = 0;

 private:
  std::mutex mutex_;
};

TEST(Exposure, NothingIsSeenOutsideOfAPixelsWindow) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  Shot shot = shot_of(random, true);
  shot.lights = {EnvironmentLight{}};
  Pixels sky{2, 1, {}, {1, 0, 0, 1, 0, 0, 1, 1}};
  shot.light_textures = {std::make_shared<const Texture>(std::move(sky), Texture::Encoding::linear)};
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed})
    for (const ShadingKind shading : {ShadingKind::normal, ShadingKind::flat}) {
      RenderParams params;
      params.integrator = kind;
      params.tc_rays = params.spp = 4;
      params.shading = shading;
      params.exposure = exposure_of(rolling(), shot);
      InWindows consumer;
      PixelConsumer* const consumers = &consumer;
      Renderer(shot).render(params, {&consumers, 1});
      EXPECT_GT(consumer.parts, 10u);
      EXPECT_EQ(consumer.outside, 0u) << static_cast<int>(kind) << " " << static_cast<int>(shading);
      EXPECT_EQ(consumer.foreign, 0u) << static_cast<int>(kind) << " " << static_cast<int>(shading);
    }
}

// A bar that moves to the right at an even speed leans: each line sees it where it is while that line is exposed.
TEST(Exposure, AMovingBarLeansByItsSpeedTimesTheLineTime) {
  Shot shot;
  shot.projection.orthographic = true;
  shot.projection.view_height = kHeight;  // a unit is a pixel
  shot.projection.width = kWidth;
  shot.projection.height = kHeight;
  shot.shutter_open = kOpen;
  shot.shutter_close = kClose;
  Mesh bar = parallelogram({-8, -10, -5}, {2, 0, 0}, {0, 20, 0}, 0);
  bar.key_times = {0, 1};
  bar.positions.push_back(bar.positions[0]);
  constexpr double kSpeed = 20;  // pixels a second
  for (Vec3f& p : bar.positions[1]) p.x += static_cast<float>(kSpeed * (kClose - kOpen));
  shot.meshes = {bar};
  shot.materials.resize(1);
  shot.materials[0].base_color = {1, 1, 1};
  for (const bool rows : {true, false}) {
    const Shutter shutter = [&] {
      Shutter s = rolling();
      if (!rows) s.open_line = s.close_line = 0;
      return s;
    }();
    RenderParams params;
    params.integrator = IntegratorKind::tc;
    params.tc_rays = 64;
    params.shading = ShadingKind::flat;
    params.exposure = exposure_of(shutter, shot);
    const Image image = render(shot, params);
    for (int y = 0; y < kHeight; ++y) {
      double mass = 0, place = 0;
      for (int x = 0; x < kWidth; ++x) {
        const auto value = static_cast<double>(pixel(image, x, y).x);
        mass += value;
        place += value * (x + 0.5);
      }
      const ExposureInterval line = line_interval(shutter, y);
      const double middle = 0.5 * (line.open + line.close);
      EXPECT_NEAR(mass, 2, 0.01) << y;
      EXPECT_NEAR(place / mass, kWidth / 2.0 - 7 + kSpeed * middle, 0.05) << y;
    }
  }
}

// Cycles samples the time of a pixel in row y, counted from below, as (1 - y / H)(1 - d) + u d of its shutter, with u
// uniform. docs/shutters.md says which options here are that.
TEST(Exposure, RollingShuttersOfCyclesAreWhatTheManualSays) {
  constexpr int kRows = 60;
  constexpr double kFrame = 1.0 / 24;
  for (const double duration : {0.0, 0.25, 1.0})
    for (const double position : {0.0, -0.25, -0.5}) {  // starts at the frame, is centred on it, ends there
      constexpr double kShutter = 0.5;                  // frames
      Shutter ours;
      ours.open = (position + kShutter * (1 - duration) / kRows) * kFrame;
      ours.close = ours.open + kShutter * duration * kFrame;
      ours.open_line = ours.close_line = kShutter * (1 - duration) / kRows * kFrame;
      const double shot_open = 1 + position * kFrame, shot_close = shot_open + kShutter * kFrame;
      const Exposure exposure(ours, 1, 8, kRows, shot_open, shot_close);
      double unshifted = 0;  // how far off the rows would be that begin with the shutter
      for (int y = 0; y < kRows; ++y) {
        const int from_below = kRows - 1 - y;
        const auto cycles = [&](double u) {
          return (1 - static_cast<double>(from_below) / kRows) * (1 - duration) + u * duration;
        };
        const TimeWeight weight = exposure.weight(3, y);
        const double slack = duration == 0 ? Exposure::kShortest : 1e-6;
        EXPECT_NEAR(weight.begin(), cycles(0), slack) << duration << " " << position << " " << y;
        EXPECT_NEAR(weight.end(), cycles(1), slack) << duration << " " << position << " " << y;
        unshifted = std::max(unshifted, std::abs(static_cast<double>(y) / kRows * (1 - duration) - cycles(0)));
      }
      EXPECT_NEAR(unshifted, (1 - duration) / kRows, 1e-9);
    }
}

TEST(Exposure, GlobalResetGathersMoreLightLineByLine) {
  Shot shot;
  shot.background = {1, 1, 1};
  shot.projection.width = 4;
  shot.projection.height = kHeight;
  shot.shutter_open = kOpen;
  shot.shutter_close = kClose;
  Shutter shutter;
  shutter.open = 0;
  shutter.close = 0.1;
  shutter.close_line = 0.02;
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed})
    for (const Normalise normalise : {Normalise::energy, Normalise::mean}) {
      shutter.normalise = normalise;
      RenderParams params;
      params.integrator = kind;
      params.tc_rays = params.spp = 4;
      params.exposure = exposure_of(shutter, shot);
      const Image image = render(shot, params);
      for (int y = 0; y < kHeight; ++y)
        EXPECT_NEAR(pixel(image, 1, y).x, normalise == Normalise::mean ? 1 : (0.1 + 0.02 * y) / 0.1, 1e-5)
            << y << " integrator " << static_cast<int>(kind);
    }
}

TEST(Exposure, CropsAndThreadsHaveTheSameBits) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = shot_of(random, true);
  Shutter shutter = rolling();
  shutter.scan = Scan::bottom;
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed}) {
    RenderParams params;
    params.integrator = kind;
    params.tc_rays = params.spp = 4;
    params.exposure = exposure_of(shutter, shot);
    const Image whole = render(shot, params);
    params.crop = Crop{5, 11, 3, 12};
    params.threads = 1;
    const Image part = render(shot, params);
    for (int y = 3; y < 12; ++y)
      for (int x = 5; x < 11; ++x) EXPECT_EQ(pixel(part, x, y), pixel(whole, x, y)) << x << "," << y;
  }
}

TEST(Exposure, ScansCountLinesFromTheirSide) {
  Shot shot;
  shot.projection.width = kWidth;
  shot.projection.height = kHeight;
  shot.shutter_open = kOpen;
  shot.shutter_close = kClose;
  const auto begin = [&](Scan scan, int x, int y) {
    Shutter shutter = rolling();
    shutter.open_line = shutter.close_line = 0.01;
    shutter.scan = scan;
    return exposure_of(shutter, shot).weight(x, y).begin();
  };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_EQ(begin(Scan::top, x, y), begin(Scan::bottom, 0, kHeight - 1 - y));
      EXPECT_EQ(begin(Scan::left, x, y), begin(Scan::right, kWidth - 1 - x, 0));
      EXPECT_NEAR(begin(Scan::top, x, y), (0.05 + 0.01 * y) / 0.5, 1e-6);
      EXPECT_NEAR(begin(Scan::left, x, y), (0.05 + 0.01 * x) / 0.5, 1e-6);
    }
}

TEST(Exposure, AMapGivesEveryPixelItsOwnInterval) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = shot_of(random, false);
  // The map of a rolling shutter is that shutter.
  const Shutter by_lines = rolling();
  auto map = std::make_shared<IntervalMap>();
  map->width = kWidth;
  map->height = kHeight;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const ExposureInterval line = line_interval(by_lines, y);
      map->open.push_back(static_cast<float>(line.open));
      map->close.push_back(static_cast<float>(line.close));
    }
  Shutter by_map;
  by_map.map = map;
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = 4;
  params.exposure = exposure_of(by_lines, shot);
  const Image expected = render(shot, params);
  params.exposure = exposure_of(by_map, shot);
  const Image mapped = render(shot, params);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(pixel(mapped, x, y)[i], pixel(expected, x, y)[i], 1e-4);
}

TEST(Exposure, InstantsAreSharp) {
  Shutter shutter = rolling();
  shutter.close = shutter.open;
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Shot shot = shot_of(random, true);
  RenderParams params;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = 4;
  params.exposure = exposure_of(shutter, shot);
  const Image image = render(shot, params);
  for (const float value : image.channels[0].values) EXPECT_TRUE(std::isfinite(value));
  const TimeWeight weight = params.exposure->weight(3, 5);
  EXPECT_LE(weight.end() - weight.begin(), 1.01 * Exposure::kShortest);
  EXPECT_NEAR(weight.sum(), 1, 1e-9);
}

TEST(Exposure, RefusesWhatCannotBe) {
  Shot shot;
  shot.projection.width = kWidth;
  shot.projection.height = kHeight;
  shot.shutter_open = kOpen;
  shot.shutter_close = kClose;
  const auto says = [&](const char* what, const std::function<void(Shutter&)>& change) {
    Shutter shutter = rolling();
    change(shutter);
    expect_error([&] { exposure_of(shutter, shot); }, {what}, ErrorCode::bad_usage);
  };
  says("line 0 is exposed 0.01 s before what was recorded", [](Shutter& s) { s.open = -0.01; });
  says("line 12 is exposed 0.01 s after", [](Shutter& s) { s.close_line = 0.03; });
  says("closes before it opens", [](Shutter& s) { s.close_line = -0.02; });
  says("finite", [](Shutter& s) { s.open = NAN; });
  says("integral is zero", [](Shutter& s) { s.curve = TimeWeight({{0, 1}, {1, -1}}); });
  says("map of 2x2", [](Shutter& s) {
    s.map = std::make_shared<IntervalMap>(IntervalMap{2, 2, {0, 0, 0, 0}, {0.1f, 0.1f, 0.1f, 0.1f}});
  });
  RenderParams params;
  Shutter negative = rolling();
  negative.curve = TimeWeight({{0, 2}, {1, -1}});
  params.exposure = exposure_of(negative, shot);
  expect_error([&] { render(shot, params); }, {"negative"}, ErrorCode::bad_usage);
  params.exposure = Exposure(rolling(), kOpen, 8, 8, kOpen, kClose);
  expect_error([&] { render(shot, params); }, {"another shot or frame"}, ErrorCode::bad_usage);
}

}  // namespace
}  // namespace kairos
