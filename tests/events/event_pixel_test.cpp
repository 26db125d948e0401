// A pixel alone: light in closed form, and the events that a sensor makes of it.
#include "events/event_pixel.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "seed.h"

namespace kairos {
namespace {

EventSensor bare() {
  EventSensor sensor;
  sensor.dark = 1e-9;
  return sensor;
}

/// Light that follows a function, in pieces so short that parabolas are the same.
std::vector<LightPiece> pieces_of(const std::function<double(double)>& light, double end, int count) {
  std::vector<LightPiece> pieces;
  for (int i = 0; i < count; ++i) {
    const double from = end * i / count, to = end * (i + 1) / count;
    pieces.push_back({from, to, light(from), light(0.5 * (from + to)), light(to)});
  }
  return pieces;
}

std::vector<Event> fire(const EventSensor& sensor, const std::vector<LightPiece>& light, int x = 0, int y = 0) {
  PixelState state;
  std::vector<Event> events;
  EventPixels(sensor, 7).see(state, x, y, light, events);
  return events;
}

double seconds(const Event& event) { return static_cast<double>(event.time) * 1e-9; }

TEST(EventPixel, FiresAtEvenStepsOfTheLogarithmInBothDirections) {
  // exp(3 t) up to t = 1, and down again.
  const auto events = fire(bare(), pieces_of([](double t) { return std::exp(3 * (t < 1 ? t : 2 - t)); }, 2, 4000));
  // 15 thresholds fit into 3, but the last of them is the turn itself: rounding decides about it.
  std::vector<double> expected;
  for (int k = 1; k <= 14; ++k) expected.push_back(0.2 * k / 3);
  ASSERT_GE(events.size(), 28u);
  for (size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(seconds(events[k]), expected[k], 1e-8);
  for (const Event& event : events) EXPECT_EQ(event.polarity, seconds(event) < 1 + 1e-6 ? 1 : -1);
}

TEST(EventPixel, RefractoryTimeHoldsDropsOrLooksAnew) {
  const auto ramp = pieces_of([](double t) { return std::exp(t); }, 1, 2000);  // an event each 0.2 s
  EventSensor sensor = bare();
  sensor.refractory = 0.25;
  const auto times = [&](Refractory mode) {
    sensor.refractory_mode = mode;
    std::vector<double> result;
    for (const Event& event : fire(sensor, ramp)) result.push_back(seconds(event));
    return result;
  };
  const auto near = [](std::vector<double> got, const std::vector<double>& wanted) {
    ASSERT_EQ(got.size(), wanted.size());
    for (size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], wanted[i], 1e-7);
  };
  near(times(Refractory::hold), {0.2, 0.45, 0.7, 0.95});
  near(times(Refractory::drop), {0.2, 0.6});       // 0.4 and 0.8 are lost
  near(times(Refractory::resample), {0.2, 0.65});  // sees again at 0.45, and then needs 0.2
}

TEST(EventPixel, LeaksAtItsRateWhereNothingChanges) {
  EventSensor sensor = bare();
  sensor.leak = 4;
  const auto events = fire(sensor, {{0, 0.9, 0.5, 0.5, 0.5}, {0.9, 2.1, 0.5, 0.5, 0.5}});
  ASSERT_EQ(events.size(), 8u);
  for (size_t k = 0; k < events.size(); ++k) {
    EXPECT_NEAR(seconds(events[k]), 0.25 * static_cast<double>(k + 1), 2e-9);
    EXPECT_EQ(events[k].kind, EventKind::leak);
  }
}

TEST(EventPixel, FollowsAStepAsAOnePoleLowPassDoes) {
  EventSensor sensor = bare();
  sensor.cutoff = 10;
  const double before = 0.1, after = 1;
  const auto events = fire(sensor, {{0, 1, before, before, before}, {1, 3, after, after, after}});
  const double time_constant = 1 / (2 * std::numbers::pi * 10 * (255 * after + 20) / 275);
  const double rise = std::log(after / before);
  ASSERT_EQ(events.size(), 11u);
  for (size_t k = 0; k < events.size(); ++k)
    EXPECT_NEAR(seconds(events[k]), 1 - time_constant * std::log(1 - 0.2 * static_cast<double>(k + 1) / rise), 2e-6);
}

TEST(EventPixel, ShotNoiseComesAtItsRateAndIsLessInTheLight) {
  EventSensor sensor = bare();
  sensor.shot_noise = 20;
  const auto mean = [&](double light) {
    double sum = 0;
    constexpr int kPixels = 400;
    for (int x = 0; x < kPixels; ++x) {
      const auto events = fire(sensor, {{0, 3, light, light, light}, {3, 5, light, light, light}}, x, 3);
      for (const Event& event : events) EXPECT_EQ(event.kind, EventKind::shot);
      sum += static_cast<double>(events.size()) / 5 / kPixels;
    }
    return sum;
  };
  // 40 000 and 10 000 events are expected: five deviations are 2.5 % and 5 %.
  EXPECT_NEAR(mean(1e-6), 20, 0.5);
  EXPECT_NEAR(mean(1), 5, 0.25);
}

TEST(EventPixel, ThresholdsDifferFromPixelToPixelAndStay) {
  EventSensor sensor = bare();
  sensor.mismatch = 0.04;
  const auto ramp = pieces_of([](double t) { return std::exp(4 * t); }, 1, 1000);
  double sum = 0, squares = 0;
  constexpr int kPixels = 300;
  for (int x = 0; x < kPixels; ++x) {
    const auto events = fire(sensor, ramp, x, 1);
    ASSERT_GT(events.size(), 2u);
    const double threshold = 4 * seconds(events[0]);
    EXPECT_NEAR(4 * (seconds(events[1]) - seconds(events[0])), threshold, 1e-6);
    sum += threshold;
    squares += threshold * threshold;
  }
  const double mean = sum / kPixels;
  EXPECT_NEAR(mean, 0.2, 0.012);
  EXPECT_NEAR(std::sqrt(squares / kPixels - mean * mean), 0.04, 0.01);
}

TEST(EventPixel, ABurstAtAJumpHasAscendingStamps) {
  const auto events = fire(bare(), {{0, 1, 0.01, 0.01, 0.01}, {1, 2, 1, 1, 1}});
  ASSERT_EQ(events.size(), 23u);  // ln(100) / 0.2
  for (size_t k = 0; k < events.size(); ++k) EXPECT_EQ(events[k].time, 1000000000 + static_cast<int64_t>(k));
}

TEST(EventPixel, DoesNotDependOnHowLightIsCutOrHandedOver) {
  std::mt19937 random(test::seed());
  for (const std::string preset : {"v2e-noisy", "ideal", "metavision"}) {
    EventSensor sensor = *event_sensor(preset);
    const auto light = pieces_of([](double t) { return 0.3 + 0.25 * std::sin(9 * t); }, 3, 300);
    const auto whole = fire(sensor, light, 5, 6);
    PixelState state;
    std::vector<Event> events;
    const EventPixels pixels(sensor, 7);
    for (size_t begin = 0; begin < light.size();) {
      const size_t count = std::min<size_t>(1 + random() % 40, light.size() - begin);
      pixels.see(state, 5, 6, std::span(light).subspan(begin, count), events);
      begin += count;
    }
    EXPECT_EQ(events, whole) << preset;
    EXPECT_GT(whole.size(), 10u);
  }
}

}  // namespace
}  // namespace kairos
