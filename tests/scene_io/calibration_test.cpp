// What rays cost: files that say so, prices made of them, and what is measured.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "error_matchers.h"
#include "policy/ray_prices.h"
#include "scene_io/calibration_file.h"
#include "soup.h"

namespace kairos {
namespace {

const std::string kGood = R"({"kairos_calibration": 1, "shading": "normal", "nanoseconds":
  {"discrete_sample": 200, "still_ray": 50, "tc_ray": {"1": 1600, "4": 1000, "16": 800}}})";

/// The same with something else in it.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const size_t place = text.find(from);
  EXPECT_NE(place, text.npos) << from;
  return text.replace(place, from.size(), to);
}

TEST(CalibrationFile, IsReadAsItIsWritten) {
  const CalibrationFile file = parse_calibration(kGood, "c.json");
  EXPECT_EQ(file.shading, ShadingKind::normal);
  EXPECT_EQ(file.calibration.discrete_sample, 200);
  EXPECT_EQ(file.calibration.still_ray, 50);
  EXPECT_EQ(file.calibration.tc_ray, (std::array<double, 3>{1600, 1000, 800}));
  CalibrationFile odd = file;
  odd.calibration = {200.0 / 3, 0, {1e3 / 7, 1e3 / 9, 1e3 / 11}};
  const CalibrationFile again = parse_calibration(calibration_text(odd), "c.json");
  EXPECT_EQ(again.calibration.discrete_sample, odd.calibration.discrete_sample);
  EXPECT_EQ(again.calibration.still_ray, 0);
  EXPECT_EQ(again.calibration.tc_ray, odd.calibration.tc_ray);
}

TEST(CalibrationFile, NumbersThatMakeNoSenseAreRefused) {
  const auto refused = [](const std::string& text, const std::string& word) {
    expect_error([&] { parse_calibration(text, "c.json"); }, {"c.json", word});
  };
  refused("", "line 1");
  refused("[1]", "object");
  refused(kGood.substr(0, 80), "line");
  refused(with("\"kairos_calibration\": 1", "\"kairos_calibration\": 2"), "only version 1");
  refused(with("\"kairos_calibration\": 1, ", ""), "kairos_calibration");
  refused(with("\"shading\": \"normal\"", "\"shading\": 3"), "shading");
  refused(with("\"normal\"", "\"\""), "shading");
  refused(with("\"normal\"", "\"" + std::string(100, 'n') + "\""), "shading");
  refused(with("\"still_ray\": 50, ", ""), "still_ray");
  refused(with("\"4\": 1000, ", ""), "'4'");
  refused(with("\"4\": 1000", "\"4\": 1000, \"5\": 1"), "5");
  refused(with("200", "0"), "nanoseconds.discrete_sample");
  refused(with("200", "-200"), "nanoseconds.discrete_sample");
  refused(with("200", "NaN"), "line 2");
  refused(with("200", "1e999"), "c.json");
  refused(with("200", "1e10"), "nanoseconds.discrete_sample");
  refused(with("200", "\"200\""), "nanoseconds.discrete_sample");
  refused(with("50", "-1"), "nanoseconds.still_ray");
  refused(with("1600", "0"), "nanoseconds.tc_ray.1");
  refused(with("800", "900000000"), "a million times");
  refused(with("200", "0.001"), "a million times");
}

TEST(RayPrices, OfACalibrationAreItsRatios) {
  const RayPrices prices = prices_of(parse_calibration(kGood, "").calibration);
  EXPECT_EQ(prices.still_ray, 0.25);
  EXPECT_EQ(prices.tc_ray, (std::array<double, 3>{8, 5, 4}));
  EXPECT_EQ(tc_ray_price(prices, 0.5), 8);
  EXPECT_EQ(tc_ray_price(prices, 1), 8);
  EXPECT_EQ(tc_ray_price(prices, 2), 6.5);
  EXPECT_EQ(tc_ray_price(prices, 4), 5);
  EXPECT_EQ(tc_ray_price(prices, 8), 4.5);
  EXPECT_EQ(tc_ray_price(prices, 16), 4);
  EXPECT_EQ(tc_ray_price(prices, 1024), 4);
  const auto refused = [](Calibration calibration) {
    expect_error([&] { prices_of(calibration); }, {"nanoseconds"}, ErrorCode::bad_usage);
  };
  refused({});
  refused({1, 1, {1, 0, 1}});
  refused({1, -1, {1, 1, 1}});
  refused({1, 1, {1, 1, std::nan("")}});
  refused({1, 1, {1, INFINITY, 1}});
}

/// Triangles that deform in front of others that stand still.
Shot small_shot(bool moves) {
  std::mt19937 random(test::seed());
  Shot shot;
  shot.meshes = {test::random_soup(random, test::Motion::deform, 6), test::random_soup(random, test::Motion::still, 6)};
  shot.meshes[1].positions.resize(1);
  if (!moves) shot.meshes.erase(shot.meshes.begin());
  shot.materials.resize(shot.meshes.size());
  shot.projection.width = 32;
  shot.projection.height = 24;
  return shot;
}

TEST(Calibrate, MeasuresAPictureInWhichSomethingMoves) {
  const Shot shot = small_shot(true);
  const Calibration measured = Renderer(shot).calibrate();
  const RayPrices prices = prices_of(measured);  // within its bounds
  EXPECT_GT(measured.discrete_sample, 1);
  EXPECT_LT(measured.discrete_sample, 1e6);
  for (const double price : prices.tc_ray) {
    EXPECT_GT(price, 0.1);
    EXPECT_LT(price, 1000);
  }
  EXPECT_LT(prices.still_ray, 10);

  const Shot still = small_shot(false);
  expect_error([&] { Renderer(still).calibrate(); }, {"nothing moves"});
  expect_error([&] { Renderer(shot).calibrate({}, [](double) { return false; }); }, {}, ErrorCode::cancelled);
}

TEST(Calibrate, NumbersAloneDecideAboutThePicture) {
  const Shot shot = small_shot(true);
  RenderParams params;
  params.spp = 128;
  params.calibration = {100, 10, {100, 100, 100}};
  params.threads = 1;
  RenderStats stats;
  const auto picture = [&] { return render(shot, params, &stats).find("R")->values; };
  const auto cheap = picture();
  EXPECT_GT(stats.tc_pixels, 0u);
  EXPECT_LE(stats.tc_pixels, stats.moving_pixels);
  EXPECT_LE(stats.moving_pixels, 32u * 24u);
  EXPECT_EQ(stats.prices, prices_of(*params.calibration));
  params.threads = 2;
  EXPECT_EQ(picture(), cheap);
  params.calibration = {200, 20, {200, 200, 200}};
  EXPECT_EQ(picture(), cheap) << "only ratios count";
  params.calibration = {1, 0, {1e6, 1e6, 1e6}};
  EXPECT_NE(picture(), cheap);
  EXPECT_EQ(stats.tc_pixels, 0u) << "too dear";
  params.calibration->discrete_sample = 0;
  expect_error(picture, {"discrete sample"}, ErrorCode::bad_usage);
}

}  // namespace
}  // namespace kairos
