// A study's arithmetic: curves, intervals, comparisons, what is measured in which order.
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/web_page.h"
#include "study/countdown.h"
#include "study/curve.h"
#include "study/measure.h"
#include "study/pictures.h"
#include "study/plan.h"
#include "study/statistics.h"
#include "study/summary.h"

namespace kairos::study {
namespace {

TEST(StudyCurve, IsStraightOverTheLogarithmOfTime) {
  const Curve curve({{8, 40}, {1, 20}, {2, 26}});  // in any order
  EXPECT_DOUBLE_EQ(*curve.psnr_at(1), 20);
  EXPECT_NEAR(*curve.psnr_at(std::sqrt(2)), 23, 1e-12);
  EXPECT_NEAR(*curve.psnr_at(4), 33, 1e-12);
  EXPECT_NEAR(*curve.psnr_at(8), 40, 1e-12);
  EXPECT_NEAR(*curve.seconds_at(33), 4, 1e-12);
  EXPECT_NEAR(*curve.seconds_at(23), std::sqrt(2), 1e-12);
  EXPECT_NEAR(*curve.seconds_at(20), 1, 1e-12);
  EXPECT_NEAR(*curve.seconds_at(40), 8, 1e-12);
}

TEST(StudyCurve, GoesOnForAQuarterOfTheTimeAndNoFarther) {
  const Curve curve({{1, 20}, {2, 26}, {8, 40}});
  EXPECT_NEAR(*curve.psnr_at(10), 40 + 7 * std::log2(1.25), 1e-12);
  EXPECT_NEAR(*curve.psnr_at(0.8), 20 - 6 * std::log2(1.25), 1e-12);
  EXPECT_FALSE(curve.psnr_at(10.01));
  EXPECT_FALSE(curve.psnr_at(0.79));
  EXPECT_NEAR(*curve.seconds_at(40 + 7 * std::log2(1.2)), 9.6, 1e-12);
  EXPECT_NEAR(*curve.seconds_at(20 - 6 * std::log2(1.2)), 1 / 1.2, 1e-12);
  EXPECT_FALSE(curve.seconds_at(43));
  EXPECT_FALSE(curve.seconds_at(17));
}

TEST(StudyCurve, TakesTheFirstTimeOfAQualityThatIsReachedTwice) {
  const Curve curve({{1, 20}, {2, 30}, {4, 25}, {8, 35}});
  EXPECT_NEAR(*curve.seconds_at(30), 2, 1e-12);
  EXPECT_NEAR(*curve.seconds_at(25), std::sqrt(2), 1e-12);
  EXPECT_NEAR(*curve.psnr_at(4), 25, 1e-12);
}

TEST(StudyCurve, LeavesOutWhatIsNoMeasurement) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Curve curve({{1, 20}, {2, kInfinity}, {0, 50}, {4, NAN}, {4, 30}, {4, 28}});
  EXPECT_NEAR(*curve.psnr_at(2), 25, 1e-12) << "of two points at one time, the better";
  EXPECT_FALSE(Curve({}).psnr_at(1));
  EXPECT_FALSE(Curve({}).seconds_at(20));
  const Curve one({{3, 33}});
  EXPECT_EQ(one.psnr_at(3), 33);
  EXPECT_EQ(one.seconds_at(33), 3);
  EXPECT_FALSE(one.psnr_at(3.1));
  EXPECT_FALSE(one.seconds_at(32));
  EXPECT_FALSE(Curve({{1, 20}, {2, 20}}).seconds_at(19)) << "a flat curve was never below";
  EXPECT_FALSE(Curve({{1, 20}, {2, 20}}).seconds_at(21));
}

TEST(StudyStatistics, QuantilesAreStudents) {
  // Tables of the distribution.
  const std::pair<size_t, double> known[] = {{1, 12.7062}, {2, 4.3027},  {4, 2.7764},  {9, 2.2622},
                                             {11, 2.2010}, {20, 2.0860}, {60, 2.0003}, {1000000, 1.9600}};
  for (const auto& [degrees, quantile] : known) EXPECT_NEAR(student_quantile(degrees), quantile, 1e-3) << degrees;
}

TEST(StudyStatistics, IntervalsAreExact) {
  const std::array<double, 5> values{3, 1, 5, 2, 4};  // mean 3, standard deviation sqrt(2.5)
  const Estimate e = estimate(values);
  EXPECT_DOUBLE_EQ(e.median, 3);
  EXPECT_NEAR(e.high - 3, 2.7764 * std::sqrt(2.5 / 5), 1e-4);
  EXPECT_NEAR(3 - e.low, e.high - 3, 1e-12);
  EXPECT_DOUBLE_EQ(estimate(std::array<double, 4>{1, 2, 4, 10}).median, 3);
  const Estimate single = estimate(std::array<double, 1>{7});
  EXPECT_EQ(single.median, 7);
  EXPECT_TRUE(std::isnan(single.low) && std::isnan(single.high)) << "one value says nothing about spread";
  const Estimate ratios = estimate_of_ratios(std::array<double, 3>{1, 2, 4});
  EXPECT_DOUBLE_EQ(ratios.median, 2);
  EXPECT_NEAR(ratios.high / 2, 2 / ratios.low, 1e-9) << "even for a ratio and its inverse";
  EXPECT_NEAR(std::log(ratios.high / 2), 4.3027 * std::log(2) / std::sqrt(3), 1e-4);
}

/// A run of the entry {"s", normal}.
Run run_of(Method method, int amount, int seed, double seconds, double psnr) {
  Run run;
  run.entry = {"s", ShadingKind::normal};
  run.setting = {method, amount, 0, 0};
  run.seed = seed;
  run.seconds = seconds;
  run.error = {std::pow(10, -psnr / 10), psnr, 0.5};
  return run;
}

const Comparison* find(const EntrySummary& summary, const std::string& series, Comparison::At at, double value) {
  for (const Comparison& c : summary.comparisons)
    if (c.series == series && c.baseline == "owen-sobol" && c.at == at && c.value == value) return &c;
  return nullptr;
}

TEST(StudySummary, DifferencesAreTakenWithinEachSeed) {
  StudyOptions options;
  options.methods = {Method::owen_sobol, Method::automatic};
  options.budgets = {4, 16};
  std::vector<study::Run> runs;
  for (int seed = 1; seed <= 3; ++seed) {
    // Seeds are of very different quality, but auto is always 2, 3 or 4 dB above, and needs half of the time.
    const double offset = 3.5 * seed;
    for (const auto& [spp, seconds, psnr] : {std::tuple{4, 1.0, 25.0}, {16, 4.0, 37.0}}) {
      runs.push_back(run_of(Method::owen_sobol, spp, seed, seconds, psnr + offset));
      runs.push_back(run_of(Method::automatic, spp, seed, seconds / 2, psnr + offset - 6 + 1 + seed));
    }
  }
  runs.push_back(run_of(Method::automatic, 16, 1, 1e-3, 90));
  runs.back().entry.scene = "another";
  ReferenceRun reference;
  reference.error.psnr = 53.5;
  const EntrySummary summary = summarize({"s", ShadingKind::normal}, series_of(options), runs, reference);

  ASSERT_EQ(summary.series.size(), 2u);
  EXPECT_DOUBLE_EQ(summary.series[0].points[1].psnr.median, 44);
  EXPECT_TRUE(summary.series[0].points[1].near_reference) << "44 dB against 53.5";
  EXPECT_FALSE(summary.series[0].points[0].near_reference);
  EXPECT_DOUBLE_EQ(summary.series[1].points[0].seconds.median, 0.5);

  const Comparison* at_spp = find(summary, "auto", Comparison::At::spp, 4);
  ASSERT_TRUE(at_spp != nullptr && at_spp->gain);
  // auto at 1 s lies half way (over the logarithm) between its points: (25 + 37) / 2 - 5 + seed against 25.
  EXPECT_NEAR(at_spp->gain->median, 3, 1e-9);
  EXPECT_NEAR(at_spp->gain->high, 3 + 4.3027 / std::sqrt(3), 1e-4);
  EXPECT_DOUBLE_EQ(at_spp->seconds, 1);
  EXPECT_DOUBLE_EQ(at_spp->baseline_psnr, 32);
  const Comparison* at_level = find(summary, "auto", Comparison::At::psnr, 35);
  ASSERT_TRUE(at_level != nullptr && at_level->gain && at_level->speed);
  EXPECT_NEAR(at_level->gain->median, 3, 1e-9);
  EXPECT_NEAR(at_level->speed->median, std::pow(2, 3 / 6.0), 1e-9) << "6 dB per doubling";
  EXPECT_EQ(find(summary, "auto", Comparison::At::psnr, 50), nullptr) << "not reached by the first seed";
}

TEST(StudySummary, ComparesAtTheTimeOfTimeContinuousRays) {
  StudyOptions options;
  options.methods = {Method::owen_sobol, Method::tc, Method::automatic};
  options.budgets = {4, 16, 64};
  options.tc_rays = {4, 16, 64};
  options.shading_samples = {8};
  std::vector<study::Run> runs;
  for (int seed = 1; seed <= 2; ++seed) {
    for (const auto& [spp, seconds, psnr] : {std::tuple{4, 1.0, 20.0}, {16, 4.0, 30.0}, {64, 16.0, 40.0}}) {
      runs.push_back(run_of(Method::owen_sobol, spp, seed, seconds, psnr));
      runs.push_back(run_of(Method::automatic, spp, seed, seconds, psnr + 1));
    }
    // 4 rays take 2 s, half way from 4 to 16 samples: 25 dB.
    for (const auto& [rays, seconds, psnr] : {std::tuple{4, 2.0, 28.0}, {16, 8.0, 42.0}, {64, 32.0, 56.0}}) {
      runs.push_back(run_of(Method::tc, 0, seed, seconds, psnr + seed));
      runs.back().setting.tc_rays = rays;
      runs.back().setting.shading_samples = 8;
    }
  }
  const EntrySummary summary = summarize({"s", ShadingKind::normal}, series_of(options), runs, std::nullopt);
  const Comparison* four = find(summary, "tc", Comparison::At::tc_rays, 4);
  ASSERT_TRUE(four != nullptr && four->gain);
  EXPECT_DOUBLE_EQ(four->seconds, 2);
  EXPECT_NEAR(four->baseline_psnr, 25, 1e-9);
  EXPECT_NEAR(four->gain->median, 4.5, 1e-9) << "29 and 30 dB";
  const Comparison* automatic = find(summary, "auto", Comparison::At::tc_rays, 16);
  ASSERT_TRUE(automatic != nullptr && automatic->gain && automatic->speed);
  EXPECT_DOUBLE_EQ(automatic->seconds, 8);
  EXPECT_NEAR(automatic->gain->median, 1, 1e-9);
  EXPECT_NEAR(automatic->speed->median, std::pow(4, 0.1), 1e-9) << "10 dB per factor of four";
  EXPECT_EQ(find(summary, "tc", Comparison::At::tc_rays, 64), nullptr) << "32 s: the baseline ends at 16";
  EXPECT_NE(comparisons_csv({summary}).find("s,normal,tc,owen-sobol,tc_rays,4,2,25,4.5,"), std::string::npos);
}

TEST(StudyPlan, SettingsComeOnceAndByCost) {
  StudyOptions options;
  options.tc_rays = {1, 8};
  options.shading_samples = {4, 7, 32};
  const std::vector<Series> all = series_of(options);
  std::vector<std::string> names;
  for (const Series& series : all) names.push_back(series.name);
  EXPECT_EQ(names, (std::vector<std::string>{"random", "multi-jitter", "owen-sobol", "tc-1", "tc", "mixed", "auto"}));
  EXPECT_EQ(all[4].settings, (std::vector<Setting>{{Method::tc, 0, 1, 7}, {Method::tc, 0, 8, 7}}));
  EXPECT_EQ(all[5].settings[1], (Setting{Method::mixed, 32, 8, 0}));
  const std::vector<Setting> settings = settings_of(all);
  EXPECT_EQ(settings.size(), 4u * 7 + 3 + 1 + 2) << "tc-1-7 is in two series";
  for (size_t i = 1; i < settings.size(); ++i) EXPECT_LE(rough_cost(settings[i - 1]), rough_cost(settings[i]));
  EXPECT_EQ(name_of(all[5].settings[0]), "mixed-1-4");
  const RenderParams params = params_of({Method::multi_jitter, 12, 0, 0});
  EXPECT_EQ(params.integrator, IntegratorKind::qmc);
  EXPECT_EQ(params.sampler, SamplerKind::multi_jitter);
  EXPECT_EQ(params.spp, 12);
  EXPECT_EQ(params.filter, FilterKind::box);
}

TEST(StudyErrors, CodesAreEvenOverTheLogarithm) {
  Image reference;
  reference.width = 4;
  reference.height = 1;
  Image image = reference;
  for (const char* name : {"R", "G", "B"}) {
    reference.channels.push_back({name, Channel::Storage::colour, {0.5f, 0.5f, 0, 2}});
    image.channels.push_back({name, Channel::Storage::colour, {0.5f, 0.51f, 1, -0.5f}});
  }
  const std::vector<uint8_t> codes = error_codes(reference, image);
  EXPECT_EQ(codes[0], 0);
  EXPECT_NEAR(codes[1], 127.5, 0.6) << "0.01 is half way from 1e-4 to 1";
  EXPECT_EQ(codes[2], 255);
  EXPECT_EQ(codes[3], 255);
  EXPECT_EQ(difference_of(0), 0);
  EXPECT_NEAR(difference_of(128), 0.01, 2e-4);
  EXPECT_EQ(difference_of(255), 1);
  const PictureError error = error_of(reference, image, "it");
  EXPECT_NEAR(error.mse, (1e-4 + 1 + 1.5 * 1.5) / 4, 1e-6) << "2 counts as 1";
  EXPECT_NEAR(error.relative_mse, (1e-4 / 0.26 + 1 / 0.01 + 2.5 * 2.5 / 4.01) / 4, 1e-4) << "and here as 2";
  EXPECT_NEAR(error.psnr, -10 * std::log10(error.mse), 1e-9);
}

TEST(StudyKeys, AreTimedAndTheFastestComesFirst) {
  Shot shot;
  shot.meshes.resize(1);
  shot.meshes[0].triangles = {{0, 1, 2}};
  shot.meshes[0].key_times = {0, 1};
  shot.meshes[0].positions = {{{-1, 0, -2}, {1, 0, -2}, {0, 1, -2}}, {{0, 0, -2}, {2, 0, -2}, {1, 1, -2}}};
  shot.projection.width = shot.projection.height = 16;
  Renderer renderer(shot);
  const std::vector<KeysTime> times = time_keys(renderer, {ShadingKind::normal, 0, 1, Clock::wall}, {0, 3, 9}, {});
  ASSERT_EQ(times.size(), 3u);
  int sum = 0;
  for (size_t i = 0; i < times.size(); ++i) {
    EXPECT_GT(times[i].seconds, 0);
    EXPECT_GE(times[i].seconds, times[i > 0 ? i - 1 : 0].seconds);
    sum += times[i].keys;
  }
  EXPECT_EQ(sum, 12);
  RenderStats few, many;
  RenderParams params = params_of({Method::owen_sobol, 4, 0, 0});
  const Image own = renderer.render(params, &few);
  params.discrete_keys = 9;
  EXPECT_GT(error_of(own, renderer.render(params, &many), "more keys").psnr, 60) << "the same motion";
}

TEST(StudyPictures, TheBoxOfTheLargestExcessIsFound) {
  constexpr int kWidth = 9, kHeight = 6;
  std::vector<uint8_t> a(kWidth * kHeight, 100), b = a;
  a[2 * kWidth + 6] = 250;
  a[3 * kWidth + 7] = 240;
  b[0] = 255;
  const PixelBox gain = largest_excess(a, b, kWidth, {0, 0, 2, 2}), loss = largest_excess(b, a, kWidth, {0, 0, 3, 2});
  EXPECT_EQ(gain.x, 6);
  EXPECT_EQ(gain.y, 2);
  EXPECT_EQ(gain.width, 2);
  EXPECT_EQ(loss.x, 0);
  EXPECT_EQ(loss.y, 0);
  EXPECT_EQ(loss.width, 3);
}

TEST(StudyPictures, Base64IsThatOfTheStandard) {
  const auto of = [](std::string_view text) {
    return base64(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
  };
  EXPECT_EQ(of(""), "");  // RFC 4648, 10
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(of("\xff\xfe\xfd"), "//79");
}

TEST(StudyCountdown, CountsWhatIsLeftByWhatWasMeasured) {
  Countdown countdown(100);
  EXPECT_FALSE(countdown.seconds_left(0));
  countdown.skip(20);
  EXPECT_FALSE(countdown.seconds_left(0)) << "what an earlier run did says nothing about speed";
  countdown.finish(10, 5);
  EXPECT_DOUBLE_EQ(*countdown.seconds_left(0), 35);
  EXPECT_DOUBLE_EQ(*countdown.seconds_left(10), 30);
  EXPECT_DOUBLE_EQ(countdown.fraction(10), 0.4);
}

}  // namespace
}  // namespace kairos::study
