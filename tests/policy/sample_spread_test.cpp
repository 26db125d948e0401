// How many discrete samples a pixel gets, from how differently the first of them look.
#include "policy/sample_spread.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "integrators/contrast.h"
#include "policy/duel.h"
#include "policy/race.h"
#include "policy/time_split.h"

namespace kairos {
namespace {

std::vector<PixelLook> looks(std::initializer_list<double> contrasts) {
  std::vector<PixelLook> result;
  for (const double contrast : contrasts) result.push_back({contrast, 1});
  return result;
}

/// Of samples that take 100 ns, and 8 rays that are as dear as RayPrices{} says or so many times dearer, whose squared
/// error falls with this power of their number.
RacedPixel raced(double speed, double tc_error, double discrete_error, double dearer = 1, double exponent = 2) {
  RacedPixel pixel;
  pixel.speed = speed;
  pixel.discrete_error = discrete_error;
  pixel.sample_time = 100;
  const auto counts = raced_counts(8, 64);
  for (size_t i = 0; i < counts.size(); ++i) {
    const double error = tc_error * std::pow(counts[i] / 8.0, -exponent);
    pixel.tc[i] = {counts[i], {error, error}, dearer * counts[i] * RayPrices{}.tc_ray[0] * 100};
  }
  return pixel;
}
Race race_of(int pixels, const std::vector<RacedPixel>& each, double times = 1) {
  Race race(64, RayPrices{}, false, std::nullopt);
  for (int i = 0; i < pixels; ++i)
    for (const RacedPixel& pixel : each) race.add(pixel);
  for (size_t lane = 0; lane < Race::kLanes; ++lane) race.give(lane, times);
  return race;
}

TEST(Duel, OfFewPixelsIsNotWonByWhatFewOfThemShow) {
  const auto is_won = [](size_t pixels, size_t one_in) {
    Duel duel;
    for (size_t i = 0; i < pixels; ++i) duel.add(1e-6, i % one_in == 0 ? 1.0 : 0.0);
    return duel.is_won();
  };
  EXPECT_TRUE(is_won(32, 1));
  EXPECT_TRUE(is_won(320, 4));
  EXPECT_FALSE(is_won(32, 5)) << "as much may be seen in the one pixel that was not looked at";
}

TEST(Race, IsWonBySpeed) {
  EXPECT_EQ(race_of(0, {}).winner(5), nullptr) << "nobody ran";
  const Race race = race_of(100, {raced(0.1, 1, 0.5), raced(0.6, 0.5, 1), raced(5, 0.9, 1)});
  EXPECT_EQ(race.winner(0.2), nullptr);
  EXPECT_NE(race.winner(0.5), nullptr);
  EXPECT_NE(race.winner(2), nullptr) << "hardly seen: as the next slower ones";
  EXPECT_EQ(race.winner(9), nullptr) << "a tie";
  EXPECT_EQ(race.winner(1000), nullptr) << "never seen";
  Race by_one(64, RayPrices{}, false, std::nullopt);
  by_one.add(raced(2, 0, 100));
  for (int i = 0; i < 100; ++i) by_one.add(raced(2, 0.1, 0.1));
  by_one.give(*by_one.lane(2), 1);
  EXPECT_EQ(by_one.winner(2), nullptr) << "won by a single pixel";
}

TEST(Race, GivesAsManyRaysAsWereFoundToCostTheBudget) {
  const auto rays = [](const Race& race) { return race.winner(2) != nullptr ? race.winner(2)->mean_rays() : 0; };
  EXPECT_NEAR(rays(race_of(100, {raced(2, 0.1, 1)})), 8, 1e-9) << "of the price 8, 64 samples buy 8";
  EXPECT_NEAR(rays(race_of(100, {raced(2, 0.1, 1, 2)})), 4, 1e-9) << "twice as dear";
  EXPECT_NEAR(rays(race_of(100, {raced(2, 0.1, 1, 0.5)})), 16, 1e-9);
  EXPECT_EQ(rays(race_of(100, {raced(2, 0.4, 1, 2)})), 0) << "with half of the rays, four times the error";
  EXPECT_NEAR(rays(race_of(100, {raced(2, 0.4, 1, 2, 1)})), 4, 1e-9) << "but twice, as was found";
  EXPECT_NEAR(rays(race_of(100, {raced(2, 5, 1, 0.25)})), 32, 1e-9) << "with four times the rays, a sixteenth of it";
  EXPECT_EQ(rays(race_of(100, {raced(2, 0, 1, 10)})), 0) << "not one ray is to be had";
  EXPECT_NEAR(race_of(100, {raced(2, 0.1, 1, 0.5)}).tc_error(2), 0.025, 1e-9);
  EXPECT_EQ(race_of(100, {raced(2, 0.1, 1, 0.5)}).discrete_error(), 1);
  // With four times the budget, against as many more samples: those gain 8.4 dB.
  EXPECT_EQ(rays(race_of(100, {raced(2, 2, 1)})), 0);
  EXPECT_NEAR(rays(race_of(100, {raced(2, 2, 1, 1, 2.5)}, 4)), 32, 1e-9);
  EXPECT_EQ(rays(race_of(100, {raced(2, 0.5, 1, 1, 0.8)}, 4)), 0);
  // What was measured holds for all; counts tell where it is more and where less.
  Race measured(64, RayPrices{}, true, std::nullopt);
  for (int i = 0; i < 100; ++i) {
    measured.add(raced(2, 0.1, 1, 4));
    measured.add(raced(20, 0.1, 1, 4));
  }
  measured.give(*measured.lane(2), 1);
  EXPECT_NEAR(rays(measured), 8, 1e-9);
}

TEST(Race, DoesWithoutManyRaysWhereTimeIsShort) {
  EXPECT_EQ(raced_counts(8, 64), (std::array<uint32_t, 3>{2, 8, 32}));
  EXPECT_EQ(raced_counts(8, 64, true), (std::array<uint32_t, 3>{2, 8, 0}));
  Race race(64, RayPrices{}, false, std::nullopt);
  RacedPixel pixel = raced(2, 0.1, 1, 0.5);
  pixel.tc[2] = {};
  for (int i = 0; i < 100; ++i) race.add(pixel);
  ASSERT_TRUE(race.give(*race.lane(2), 1));
  EXPECT_NEAR(race.winner(2)->mean_rays(), 16, 1e-9) << "half as dear";
  EXPECT_NEAR(race.tc_error(*race.lane(2)), 0.025, 1e-9) << "as the error fell up to 8";
}

TEST(SampleSpread, PaysInLitPicturesWhereTheyAreVeryUneven) {
  const auto pays = [](uint32_t budget, const std::vector<PixelLook>& seen) {
    return SampleSpread(budget / 2, 16 * budget, budget, seen).pays_if_lit(budget, seen);
  };
  std::vector<PixelLook> alike, uneven, fairly;
  for (int i = 0; i < 100; ++i) {
    alike.push_back({0.5, 1});
    uneven.push_back({i < 90 ? 1e-4 : 2, 1});
    fairly.push_back({i < 30 ? 0.01 : i < 90 ? 0.1 : 0.5, 1});
  }
  EXPECT_FALSE(pays(16, alike)) << "nothing is won";
  EXPECT_TRUE(pays(16, uneven));
  EXPECT_FALSE(pays(16, fairly)) << "contrasts of eight noisy samples";
  EXPECT_TRUE(pays(64, fairly));
}

TEST(Race, CorrectsTheStillLayerWhereThatIsWorthIt) {
  const auto raced_both = [](double corrected_error) {
    Race race(64, RayPrices{}, false, 0.5);
    RacedPixel pixel = raced(2, 0.1, 1);
    for (auto& rays : pixel.tc) rays.error[1] *= corrected_error;
    for (int i = 0; i < 100; ++i) race.add(pixel);
    race.give(*race.lane(2), 1);
    return race;
  };
  const Race corrected = raced_both(0.01), alone = raced_both(0.9);
  ASSERT_NE(corrected.winner(2), nullptr);
  ASSERT_NE(alone.winner(2), nullptr);
  EXPECT_EQ(corrected.winner(2)->plan_over_time(0).discrete, 64u);
  EXPECT_EQ(alone.winner(2)->plan_over_time(0).discrete, 0u) << "a tenth less of error for a third of the rays";
  EXPECT_LT(corrected.winner(2)->mean_rays(), 0.9 * alone.winner(2)->mean_rays());
  EXPECT_NEAR(alone.tc_cost(*alone.lane(2)), 64, 1e-6);
  // What fewer rays happened to miss counts for them, too.
  Race missed(64, RayPrices{}, false, std::nullopt);
  RacedPixel pixel = raced(2, 0.1, 1);
  pixel.tc[0].error[0] = 1e-6;
  for (int i = 0; i < 100; ++i) missed.add(pixel);
  missed.give(*missed.lane(2), 0.25);
  EXPECT_GT(missed.tc_error(*missed.lane(2)), 0.2);
}

/// Half of the pixels have a contrast and stand still, and in the others things move by two pixels.
std::vector<Contestant> half_moving(double contrast_square, int of_each = 1000) {
  std::vector<Contestant> pixels;
  for (int i = 0; i < of_each; ++i) {
    pixels.push_back({{contrast_square, 1}, std::nullopt, 1});
    pixels.push_back({{contrast_square, 1}, 2.0, 1});
  }
  return pixels;
}

TEST(TimeSplit, GivesTimeToWhereItMakesThePictureBetter) {
  const auto moving_rays = [](Race& race) { return race.winner(2) != nullptr ? race.winner(2)->mean_rays() : 0; };
  // What stands still has hardly an error: most of its time goes to the rays, but for the least that it needs.
  Race needy = race_of(100, {raced(2, 0.5, 1)});
  const auto rest = split_time(needy, 64, 1e-6, half_moving(1));
  EXPECT_GT(moving_rays(needy), 8 * 1.3);
  ASSERT_TRUE(rest);
  EXPECT_LE(rest->first(), 16u);
  EXPECT_GE(rest->first(), 8u);
  // Of few pixels nobody knows that.
  Race unsure = race_of(100, {raced(2, 0.5, 1)});
  split_time(unsure, 64, 1e-6, half_moving(1, 101));
  EXPECT_LT(moving_rays(unsure), 8.5);
  // The other way round, the rays get less than their share.
  Race rich = race_of(100, {raced(2, 1e-6, 1)});
  EXPECT_GE(split_time(rich, 64, 1, half_moving(1))->first(), 32u);
  EXPECT_LT(moving_rays(rich), 8);
  EXPECT_GT(moving_rays(rich), 0);
  // Rays that lose with as much time as samples, but not with more of it.
  Race late = race_of(100, {raced(2, 1.1, 1, 1, 2.5)});
  EXPECT_EQ(moving_rays(late), 0);
  split_time(late, 64, 1e-6, half_moving(1));
  EXPECT_GT(moving_rays(late), 8);
  // Never more than there is.
  for (const double scale : {1e-6, 1e-2, 1.0, 1e2})
    for (const double tc_error : {1e-6, 1e-2, 0.5}) {
      Race race = race_of(100, {raced(2, tc_error, 1)});
      const auto spread = split_time(race, 64, scale, half_moving(0.5));
      const double discrete = spread ? spread->count(0.5) : 64;
      EXPECT_LE(moving_rays(race) * RayPrices{}.tc_ray[0] + discrete, 1.15 * 2 * 64) << scale << ' ' << tc_error;
    }
}

TEST(Contrast, IsTheRangeOfWhatADisplayShows) {
  const Vec3f background{0.5f, 0, 0};
  Contrast contrast(background);
  RecordBuilder record;
  record.begin_pixel(0, 0, background);
  const auto add = [&](Vec3f colour) {
    const uint32_t knot = record.add_knot(0.5f, colour, {}, {}), part = record.part_count();
    record.add_part({{}, knot});
    record.add_ray({{}, 1, 0.5f, part, 1, 1});
    contrast.add(record, record.rays().size() - 1);
  };
  contrast.begin_pixel();
  EXPECT_EQ(contrast.square(), 0);
  add({0.5f, 0.25f, 0});
  EXPECT_EQ(contrast.square(), 0) << "one ray";
  add({0.5f, 0.75f, 0});
  EXPECT_EQ(contrast.square(), 0.25);
  add({9, 0.5f, -1});
  EXPECT_EQ(contrast.square(), 0.5) << "9 is shown as 1, -1 as 0";
  record.add_ray({{}, 1, 0.5f, 0, 0, 0});
  contrast.add(record, record.rays().size() - 1);
  EXPECT_EQ(contrast.square(), 0.5 - 0.25 + 0.75 * 0.75) << "the background has no green";
  contrast.begin_pixel();
  add({std::numeric_limits<float>::quiet_NaN(), 0.5f, 0.5f});
  add({0.5f, 0.5f, 0.5f});
  EXPECT_TRUE(std::isfinite(contrast.square()));
}

TEST(SampleSpread, OnlyOwenSobolAndRandomPointsOfAutomaticHaveOne) {
  RenderParams params;
  params.integrator = IntegratorKind::automatic;
  params.spp = 16;
  EXPECT_TRUE(spreads_samples(params));
  params.spp = 15;
  EXPECT_FALSE(spreads_samples(params)) << "too few to begin with";
  params.spp = 64;
  params.sampler = SamplerKind::multi_jitter;
  EXPECT_FALSE(spreads_samples(params)) << "its first points do not fill the pixel";
  params.sampler = SamplerKind::random;
  EXPECT_TRUE(spreads_samples(params));
  for (const IntegratorKind kind : {IntegratorKind::qmc, IntegratorKind::mixed, IntegratorKind::tc}) {
    params.integrator = kind;
    EXPECT_FALSE(spreads_samples(params));
  }
}

TEST(SampleSpread, CountsArePowersOfTwoWithinTheirBounds) {
  for (const uint32_t budget : {16u, 17u, 100u, 256u, 1u << 20}) {
    const uint32_t first = first_samples(budget), most = most_samples(budget);
    EXPECT_GT(4 * first, budget);
    EXPECT_LE(2 * first, budget);
    EXPECT_LE(most, Sampler::kMaxCount);
    const SampleSpread spread(first, most, budget, looks({0, 0, 0, 1e-3, 1}));
    uint32_t before = first;
    for (const double contrast : {0.0, 1e-12, 1e-6, 1e-4, 1e-2, 0.1, 1.0, 3.0}) {
      const uint32_t count = spread.count(contrast);
      EXPECT_TRUE(std::has_single_bit(count));
      EXPECT_GE(count, before) << "more contrast, fewer samples";
      EXPECT_LE(count, most);
      before = count;
    }
    EXPECT_EQ(spread.count(0), first);
  }
}

TEST(SampleSpread, GivesEdgesWhatSmoothPixelsSave) {
  // A fifth of the pixels are edges: half of the samples of the others are worth two more budgets to each of these, a
  // little less since they are dearer.
  const SampleSpread spread(32, 1024, 64, looks({0, 0, 0, 0, 1}));
  EXPECT_EQ(spread.count(1), 128u);
  EXPECT_EQ(spread.count(0), 32u);
  // On average the budget is kept.
  for (const double share : {0.02, 0.1, 0.3, 0.6}) {
    std::vector<PixelLook> contrasts(1000);
    for (size_t i = 0; i < contrasts.size(); ++i)
      if (static_cast<double>(i) < share * 1000) contrasts[i].contrast_square = 0.01 + 0.003 * static_cast<double>(i);
    const SampleSpread some(32, 1024, 64, contrasts);
    double sum = 0;
    for (const PixelLook& look : contrasts) sum += some.count(look.contrast_square);
    EXPECT_LT(sum / 1000, 1.1 * 64) << share;
    EXPECT_GT(sum / 1000, 0.5 * 64) << share;
  }
}

TEST(SampleSpread, WhatIsSavedOnCheapPixelsBuysLess) {
  const auto count_at = [](double price) {
    return SampleSpread(32, 4096, 64, {{0, price}, {0, price}, {0, price}, {0, price}, {0, price}, {0, price}, {1, 1}})
        .count(1);
  };
  EXPECT_EQ(count_at(2), 256u);
  EXPECT_EQ(count_at(1), 128u) << "it would get more than its first samples say";
  EXPECT_EQ(count_at(0.1), 64u);
}

TEST(SampleSpread, ItsGainIsWhatOneWouldPayForTheSameError) {
  const auto same = looks({0.9, 1, 1.1});
  EXPECT_EQ(SampleSpread(32, 1024, 64, same).gain(64, same), 1);
  // All edges get four times the budget, at no more time.
  const auto few = looks({0, 0, 0, 0, 0, 0, 0, 0, 0, 1});
  const SampleSpread spread(32, 1024, 64, few);
  EXPECT_DOUBLE_EQ(spread.gain(64, few), spread.count(1) / 64.0);
  EXPECT_GT(spread.count(1), 128u);
  EXPECT_EQ(spread.gain(64, looks({0, 0})), 1) << "nothing to gain";
}

TEST(SampleSpread, LeavesPixelsAloneThatAreAllAlike) {
  const SampleSpread spread(32, 1024, 64, looks({0.8, 0.9, 1, 1.1, 1.2}));
  for (const double contrast : {0.8, 1.0, 1.2}) EXPECT_EQ(spread.count(contrast), 64u);
  const SampleSpread blank(32, 1024, 64, looks({0, 0, 0, 0}));
  EXPECT_EQ(blank.count(0), 32u);
  EXPECT_EQ(blank.count(1), 1024u) << "a speck on an empty picture";
}

}  // namespace
}  // namespace kairos
