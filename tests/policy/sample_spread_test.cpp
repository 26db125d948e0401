// How many discrete samples a pixel gets, from how differently the first of them look.
#include "policy/sample_spread.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "integrators/contrast.h"
#include "policy/race.h"

namespace kairos {
namespace {

std::vector<PixelLook> looks(std::initializer_list<double> contrasts) {
  std::vector<PixelLook> result;
  for (const double contrast : contrasts) result.push_back({contrast, 1});
  return result;
}

TEST(Race, IsWonBySpeed) {
  Race race;
  EXPECT_FALSE(race.tc_wins(5)) << "nobody ran";
  for (int i = 0; i < 100; ++i) {
    race.add(0.1, 1, 0.5);
    race.add(0.6, 0.5, 1);
    race.add(5, 0.9, 1);
  }
  race.add(20, 0, 1);
  EXPECT_FALSE(race.tc_wins(0.2));
  EXPECT_TRUE(race.tc_wins(0.5));
  EXPECT_TRUE(race.tc_wins(2)) << "hardly seen: as the next slower ones";
  EXPECT_FALSE(race.tc_wins(9)) << "a tie";
  EXPECT_FALSE(race.tc_wins(1000)) << "one pixel says nothing";
  Race by_one;
  by_one.add(2, 0, 100);
  for (int i = 0; i < 100; ++i) by_one.add(2, 0.1, 0.1);
  EXPECT_FALSE(by_one.tc_wins(2)) << "won by a single pixel";
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
  EXPECT_EQ(count_at(1), 256u);
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
