#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/time_weight.h>

#include "error_matchers.h"
#include "seed.h"

namespace kairos {
namespace {

TEST(TimeWeight, ABoxCountsEveryInstantAlike) {
  const TimeWeight box;
  EXPECT_TRUE(box.is_box());
  EXPECT_EQ(box.at(0.3), 1);
  EXPECT_EQ(box.integral(0.25, 1), 0.75);
  EXPECT_EQ(box.moments(0.5, 1)[0], 0.25);
  EXPECT_EQ(box.moments(0.5, 1)[1], 0.25);
}

TEST(TimeWeight, KnowsRampsAndStepsInClosedForm) {
  const TimeWeight ramp({{0, 0}, {1, 1}});
  EXPECT_DOUBLE_EQ(ramp.at(0.25), 0.25);
  EXPECT_DOUBLE_EQ(ramp.integral(0, 1), 0.5);
  // The integrals of t (1 - t) and t t.
  EXPECT_DOUBLE_EQ(ramp.moments(0, 1)[0], 1.0 / 6);
  EXPECT_DOUBLE_EQ(ramp.moments(0, 1)[1], 1.0 / 3);
  const TimeWeight half({{0.25, 2}, {0.75, 2}});  // nothing before and after
  EXPECT_EQ(half.at(0.2), 0);
  EXPECT_EQ(half.at(0.8), 0);
  EXPECT_DOUBLE_EQ(half.integral(0, 1), 1);
  EXPECT_DOUBLE_EQ(half.integral(0, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(half.moments(0, 0.5)[0], 2 * (0.25 * 0.25));  // 2 (1 - 2 t) from 0.25 to 0.5
  const TimeWeight step({{0, 1}, {0.5, 1}, {0.5, 3}, {1, 3}});
  EXPECT_EQ(step.at(0.5), 3);
  EXPECT_DOUBLE_EQ(step.integral(0.25, 0.75), 1);
}

// By definition, with a sum over very many instants.
TEST(TimeWeight, MomentsOfRandomCurvesAreWhatManyInstantsSay) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 50; ++i) {
    std::vector<TimeWeight::Point> points(2 + random() % 5);
    for (auto& point : points) point = {uniform(random), 4 * uniform(random) - 1};
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    const TimeWeight weight(points);
    double begin = uniform(random), end = uniform(random);
    if (begin > end) std::swap(begin, end);
    constexpr int kSteps = 20000;
    double first = 0, second = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double place = (k + 0.5) / kSteps, value = weight.at(begin + (end - begin) * place);
      first += value * (1 - place) * (end - begin) / kSteps;
      second += value * place * (end - begin) / kSteps;
    }
    const auto moments = weight.moments(begin, end);
    EXPECT_NEAR(moments[0], first, 1e-3) << "seed " << seed;
    EXPECT_NEAR(moments[1], second, 1e-3) << "seed " << seed;
    EXPECT_NEAR(weight.integral(begin, end), first + second, 1e-3) << "seed " << seed;
  }
}

TEST(TimeWeight, StretchedItIsTheSameCurveElsewhere) {
  const TimeWeight step({{0, 1}, {0.5, 1}, {0.5, 3}, {1, 3}});
  const TimeWeight weight = step.stretched(0.5, 0.75, 8);
  EXPECT_EQ(weight.at(0.4), 0);
  EXPECT_DOUBLE_EQ(weight.at(0.6), 8);
  EXPECT_DOUBLE_EQ(weight.at(0.7), 24);
  EXPECT_DOUBLE_EQ(weight.sum(), 8 * 0.25 * 2);
  EXPECT_DOUBLE_EQ(weight.integral(0, 0.625), 8 * 0.125);
  const auto [first, second] = weight.moments(0.5, 0.625);
  EXPECT_DOUBLE_EQ(first, 0.5);
  EXPECT_DOUBLE_EQ(second, 0.5);
  EXPECT_DOUBLE_EQ(weight.variation(), 8 * (1 + 2 + 3));
  EXPECT_EQ(TimeWeight().variation(), 2);
  const TimeWeight box = TimeWeight().stretched(0.25, 0.5, 4);
  EXPECT_FALSE(box.is_box());
  EXPECT_DOUBLE_EQ(box.integral(0, 1), 1);
  EXPECT_DOUBLE_EQ(box.stretched(0, 0.5, 2).begin(), 0.125);
  EXPECT_THROW(box.stretched(0.5, 0.5, 1), Error);
  EXPECT_THROW(box.stretched(0, 1, INFINITY), Error);
}

TEST(TimeWeight, BeforeAQuantileLiesItsShareOfTheIntegral) {
  const uint32_t seed = test::seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 50; ++i) {
    std::vector<TimeWeight::Point> points(2 + random() % 5);
    for (auto& point : points) point = {uniform(random), random() % 3 == 0 ? 0 : uniform(random)};
    points[0].weight = 1;  // of something there is an integral
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    const TimeWeight weight = TimeWeight(points).stretched(0.25, 0.5, 3);
    if (!(weight.sum() > 1e-6)) continue;
    double before = 0;
    for (int k = 0; k <= 10; ++k) {
      const double share = k / 10.0, time = weight.quantile(share);
      EXPECT_GE(time, before);
      EXPECT_NEAR(weight.integral(0, time), share * weight.sum(), 1e-9 + 1e-9 * weight.sum());
      before = time;
    }
  }
}

TEST(TimeWeight, RefusesWhatIsNoCurve) {
  EXPECT_THROW(TimeWeight({{0, 1}}), Error);
  EXPECT_THROW(TimeWeight({{0, 1}, {1.5, 1}}), Error);
  EXPECT_THROW(TimeWeight({{0.5, 1}, {0.25, 1}}), Error);
  EXPECT_THROW(TimeWeight({{0, NAN}, {1, 1}}), Error);
  EXPECT_THROW(TimeWeight({{NAN, 1}, {1, 1}}), Error);
}

}  // namespace
}  // namespace kairos
