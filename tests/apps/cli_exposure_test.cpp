// Shutters on the command line: units, rolling, curves, maps.
#include <nlohmann/json.hpp>

#include "cli.h"
#include "image/read_exr.h"
#include "image/write_exr.h"

namespace kairos {
namespace {

using nlohmann::json;

class CliExposure : public CliTest {
 protected:
  /// The stats of a rendering.
  json stats(const std::string& options) const {
    const CliResult result =
        run("render scene.json -o out.exr --tc-rays 1 --fps 25 --shading normal --stats-file s.json " + options);
    EXPECT_EQ(result.status, 0) << options << "\n" << result.err;
    log = result.err;
    return json::parse(read(path("s.json")), nullptr, false);
  }
  std::string refusal(const std::string& options) const {
    const CliResult result = run("render scene.json -o out.exr --quiet " + options);
    EXPECT_NE(result.status, 0) << options;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    return result.err;
  }
  mutable std::string log;
};

TEST_F(CliExposure, ShuttersHaveUnits) {
  const auto shutter = [&](const std::string& text) {
    return stats("--shutter " + text).at("shutter").get<std::array<double, 2>>();
  };
  const auto expect = [&](const std::string& text, double open, double close) {
    const auto [first, last] = shutter(text);
    EXPECT_NEAR(first, open, 1e-12) << text;
    EXPECT_NEAR(last, close, 1e-12) << text;
  };
  expect("0,0.5", 0, 0.02);
  expect("0.25f,0.5f", 0.01, 0.02);
  expect("180deg", 0, 0.02);
  expect("90deg@-45deg", -0.005, 0.005);
  expect("25%", 0, 0.01);
  expect("1/250s", 0, 0.004);
  expect("4ms@10ms", 0.01, 0.014);
  expect("-100us,0.5s", -1e-4, 0.5);
  expect("500ns", 0, 5e-7);
  for (const char* text : {"4m", "1/0s", "1/250", "deg", "0,1,2", "-4ms", "1ms@", "nan"})
    EXPECT_NE(refusal("--shutter " + std::string(text)).find("--shutter"), std::string::npos) << text;
}

TEST_F(CliExposure, ResolvedTimesStandInLogHeaderAndStats) {
  const json all = stats("--shutter 1ms --rolling top:20ms --anchor middle --curve triangle");
  const json& exposure = all.at("exposure");
  EXPECT_NEAR(exposure.at("line_times")[0].get<double>(), 1e-3, 1e-12);  // of 20 lines
  EXPECT_NEAR(exposure.at("interval")[0].get<double>(), -9.5e-3, 1e-12);
  EXPECT_NEAR(all.at("shutter")[0].get<double>(), -9.5e-3, 1e-12);
  EXPECT_NEAR(all.at("shutter")[1].get<double>(), 10.5e-3, 1e-12);
  EXPECT_NE(
      log.find("lines 0 to 19 from the top, 1 ms each: the first is exposed from -9.5 ms to -8.5 ms, the last from "
               "9.5 ms to 10.5 ms"),
      std::string::npos)
      << log;
  const Image image = read_exr(path("out.exr"));
  const auto attribute = [&](const std::string& name) {
    for (const Attribute& a : image.attributes)
      if (a.name == name) return a.value;
    return decltype(Attribute::value)();
  };
  EXPECT_EQ(std::get<std::string>(attribute("kairos:exposure_scan")), "top");
  EXPECT_EQ(std::get<std::string>(attribute("kairos:exposure_curve")), "points:0 0,0.5 1,1 0");
  EXPECT_NEAR((std::get<std::array<double, 2>>(attribute("kairos:exposure_line"))[1]), 1e-3, 1e-12);
  EXPECT_NEAR(std::get<double>(attribute("expTime")), 1e-3, 1e-12);
}

TEST_F(CliExposure, APartOfASensorHasItsOwnLines) {
  const json exposure =
      stats("--shutter 1ms --rolling bottom:30us/line --sensor-lines 100,40 --anchor last").at("exposure");
  EXPECT_EQ(exposure.at("first_line"), 40);
  EXPECT_NEAR(exposure.at("interval")[0].get<double>(), -99 * 30e-6, 1e-12);
  const json reset = stats("--shutter 1ms --rolling left:32ms:reset --normalise energy").at("exposure");
  EXPECT_EQ(reset.at("line_times")[0], 0);
  EXPECT_NEAR(reset.at("line_times")[1].get<double>(), 1e-3, 1e-12);  // of 32 columns
  EXPECT_NE(refusal("--rolling top:1ms --sensor-lines 20,1").find("--sensor-lines"), std::string::npos);
}

// The map says what the lines say.
TEST_F(CliExposure, MapsGivePixelsTheirIntervals) {
  Image map;
  map.width = map.frame_width = 32;
  map.height = map.frame_height = 20;
  Channel open{"open", Channel::Storage::exact, {}}, close = {"close", Channel::Storage::exact, {}};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 32; ++x) {
      open.values.push_back(0.01f * static_cast<float>(y));
      close.values.push_back(0.01f * static_cast<float>(y) + 0.1f);
    }
  map.channels = {open, close};
  write_exr(map, path("map.exr"), {});
  stats("--interval-map map.exr");
  const Image mapped = read_exr(path("out.exr"));
  stats("--shutter 0.1s --rolling top:10ms/line");
  const Image rolled = read_exr(path("out.exr"));
  double most = 0;
  for (size_t i = 0; i < mapped.channels[0].values.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(mapped.find("G")->values[i] - rolled.find("G")->values[i])));
  EXPECT_LT(most, 1e-3);
  EXPECT_NE(refusal("--interval-map out.exr").find("'open' and 'close'"), std::string::npos);
  EXPECT_NE(refusal("--interval-map map.exr --size 8x8").find("map of 32x20 pixels"), std::string::npos);
  EXPECT_NE(refusal("--interval-map map.exr --rolling top:1ms").find("--rolling"), std::string::npos);
}

TEST_F(CliExposure, CurvesAreChecked) {
  for (const char* text : {"round", "trapezoid:0.8,0.2", "trapezoid:1", "points:0 1", "points:0 1,2 1",
                           "points:1 1,0 1", "bezier:1", "bezier:0.5,0.5,0.9,0,0.1,1,0.6,1,0.9,0", "points:0 1;1 1"})
    EXPECT_NE(refusal("--curve '" + std::string(text) + "'").find("--curve"), std::string::npos) << text;
  EXPECT_NE(refusal("--curve 'points:0 -1,1 3'").find("--signed-curve"), std::string::npos);
  // The curve of a Bezier that is straight is the trapezoid.
  const auto curve =
      stats(
          "--curve bezier:0.3,0.6,0.1,0.3333333333333,0.2,0.66666666666667,0.73333333333333,0.6666666666667,"
          "0.86666666666667,0.33333333333333")
          .at("exposure")
          .at("curve");
  for (const json& point : curve) {
    const double time = point[0], weight = point[1];
    EXPECT_NEAR(weight, time < 0.3 ? time / 0.3 : time <= 0.6 ? 1 : (1 - time) / 0.4, 1e-4);
  }
}

TEST_F(CliExposure, WhatHasNoDurationIsAStillFrame) {
  const json all = stats("--shutter 0,0 --curve triangle");
  EXPECT_EQ(all.at("shutter")[0], all.at("shutter")[1]);
  EXPECT_FALSE(all.contains("exposure"));
}

}  // namespace
}  // namespace kairos
