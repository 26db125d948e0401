// How many rays of which kind a pixel gets, and by which prices.
#include "policy/allotment.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "policy/ray_prices.h"

namespace kairos {
namespace {

TEST(Allotment, SpendsTheBudgetOverThePictureAndGoesByWorth) {
  RayPrices dear_alone;  // rays are cheaper together
  dear_alone.tc_ray = {12, 9, 6};
  RayPrices odd;  // as a file may have them
  odd.tc_ray = {8, 4, 1};
  for (const RayPrices& prices : {RayPrices{}, dear_alone, odd})
    for (const double speed : {0.0, 0.3, 1.0, 10.0, 1000.0})
      for (const uint32_t budget : {1u, 4u, 16u, 64u, 100u, 256u, 4096u}) {
        double spent = 0;
        int tc_pixels = 0;
        constexpr int kSize = 32;
        for (int y = 0; y < kSize; ++y)
          for (int x = 0; x < kSize; ++x) {
            const PixelPlan plan = Allotment(budget, prices).plan(speed, dither(x, y));
            EXPECT_EQ(plan.discrete, budget);
            tc_pixels += plan.tc_rays > 0;
            spent += plan.tc_rays > 0
                         ? plan.tc_rays * tc_ray_price(prices, plan.tc_rays) + plan.discrete * prices.still_ray
                         : budget;
            EXPECT_TRUE(std::has_single_bit(plan.tc_rays) || plan.tc_rays == 0);
            EXPECT_LE(plan.tc_rays, budget);
            if (plan.tc_rays > 0) {
              EXPECT_GT(worth(2 * plan.tc_rays, speed), budget);
            }
          }
        EXPECT_TRUE(tc_pixels == 0 || tc_pixels == kSize * kSize);
        const double share = spent / (kSize * kSize * budget);
        EXPECT_LE(share, kMostOver + 0.02) << budget << ' ' << speed;
        if (prices != odd) {
          EXPECT_GE(share, 0.98) << budget << ' ' << speed;  // there, more rays may cost as much
        }
      }
  EXPECT_EQ(Allotment(256, RayPrices{}).plan(0.1, 0.5).tc_rays, 0u) << "slow motion is not worth it";
  EXPECT_EQ(Allotment(256, RayPrices{}, 100).plan(50, 0.5).tc_rays, 0u) << "discrete samples are as good";
  EXPECT_EQ(Allotment(4, RayPrices{}).plan(1000, 0.5).tc_rays, 0u) << "too little for one";
  EXPECT_GT(Allotment(256, RayPrices{}).plan(50, 0.5).tc_rays, 0u);
}

// By definition: where the mean error over pixels is less than that of the samples, by what is required.
TEST(Allotment, ChoosesTimeContinuousRaysFromTheSpeedOnAtWhichTheyAreWorthIt) {
  constexpr int kPixels = 1000;
  size_t chosen = 0, refused = 0;
  for (const uint32_t budget : {16u, 64u, 100u, 256u})
    for (const double dearer : {0.2, 0.5, 1.0})
      for (const double gain : {1.0, 3.0}) {
        RayPrices prices;
        for (double& price : prices.tc_ray) price *= dearer;
        const Allotment allotment(budget, prices, gain), eager(budget, prices, 1e-9);
        for (double speed = 0.05; speed < 12; speed += 0.15) {
          double error = 0;
          for (int i = 0; i < kPixels; ++i)
            error += 1 / worth(eager.plan(speed, (i + 0.5) / kPixels).tc_rays, speed) / kPixels;
          const double gained = 1 / error / (kRequiredGain * gain * budget);
          if (std::abs(gained - 1) < 0.01) continue;  // the share of pixels is only known to a thousandth
          const bool is_chosen = allotment.plan(speed, 0.5).tc_rays > 0;
          EXPECT_EQ(is_chosen, gained > 1) << budget << ' ' << dearer << ' ' << gain << ' ' << speed;
          ++(is_chosen ? chosen : refused);
        }
      }
  EXPECT_GT(std::min(chosen, refused), 100u);
}

TEST(Allotment, TracesNoMoreStillRaysThanTheirNoiseIsWorth) {
  const PixelPlan plan{4, 64};
  EXPECT_EQ(still_rays(plan, 1), 64u);
  EXPECT_EQ(still_rays(plan, 0.5), 64u);
  EXPECT_EQ(still_rays(plan, 0.25), 32u);
  EXPECT_EQ(still_rays(plan, 0.001), 4u);
}

TEST(RayPrices, FollowTheWork) {
  const auto work_of = [](double nodes, double triangles, double hits, double evaluations) {
    RayWork work;
    work.nodes = nodes;
    work.triangles = work.root_solves = triangles;
    work.hits = work.segments = hits;
    work.evaluations = evaluations;
    return work;
  };
  const RayWork little = work_of(3, 10, 2, 2), much = work_of(3, 40, 20, 12);
  SampleWork sample, dear;
  sample.instant = work_of(3, 8, 1, 0);
  dear.instant = work_of(6, 16, 2, 0);
  Surroundings still, moving, lit;
  still.anything_still = still.still_layer = lit.anything_still = lit.still_layer = true;
  lit.light = 5000;
  const RayPrices a = estimate_prices({{much, little, little}, sample}, still);
  EXPECT_GT(a.tc_ray[1], 1);
  EXPECT_GT(a.tc_ray[0], 2 * a.tc_ray[1]) << "each number has its own";
  EXPECT_GT(a.tc_ray[1], a.tc_ray[2]) << "what a pixel pays once is shared";
  EXPECT_NEAR(without_shares(a).tc_ray[1], a.tc_ray[1] - 1, 1e-9);
  EXPECT_GT(a.still_ray, 0);
  EXPECT_LT(a.still_ray, 1);
  EXPECT_EQ(estimate_prices({{much, little, little}, sample}, moving).still_ray, 0);
  EXPECT_LT(estimate_prices({{much, little, little}, dear}, still).tc_ray[2], 0.8 * a.tc_ray[2])
      << "discrete rays are dearer, too";
  EXPECT_EQ(estimate_prices({}, still), RayPrices{}) << "nothing is known";
  // Where shading is most of the time, what counts is how often it is done.
  EXPECT_NEAR(estimate_prices({{much, much, much}, sample}, lit).tc_ray[2], 12, 3);
  // The pixel's later rays, one by one, come upon what the first has brought near.
  RayWork later = much;
  later.fresh = 1.0 / 16;
  EXPECT_LT(tc_ray_time(later, still), 0.95 * tc_ray_time(much, still));
  EXPECT_GT(idle_sample_time(sample, still), resting_sample_time(sample, still));
  EXPECT_GT(sample_time(sample, still), idle_sample_time(sample, still));
}

}  // namespace
}  // namespace kairos
