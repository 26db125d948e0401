// kairos query --pixel: what a pixel did is what the picture shows.
#include <nlohmann/json.hpp>

#include "cli.h"
#include "image/read_exr.h"

namespace kairos {
namespace {

using nlohmann::json;

class CliPixelQuery : public CliTest {};

TEST_F(CliPixelQuery, PrintsTheRecordOfThePictureBitForBit) {
  for (const char* options :
       {"--integrator tc --tc-rays 3 --shading flat", "--integrator qmc --spp 5 --filter gaussian",
        "--integrator mixed --tc-rays 2 --spp 16 --shading flat --seed 7", "--spp 64",
        "--tc-rays 4 --shading whitted --clusters off --shading-samples 3"}) {
    ASSERT_EQ(run(std::string("render scene.json --quiet -o out.exr ") + options).status, 0);
    const Image image = read_exr(path("out.exr"));
    for (const auto& [x, y] : {std::pair(16, 10), std::pair(2, 3), std::pair(20, 18), std::pair(8, 9)}) {
      const CliResult result =
          run("query scene.json --pixel " + std::to_string(x) + "," + std::to_string(y) + " " + options);
      ASSERT_EQ(result.status, 0) << result.err;
      const json pixel = json::parse(result.out);
      EXPECT_EQ(pixel.at("pixel"), json({x, y}));
      const char* const channels[] = {"R", "G", "B"};
      for (size_t i = 0; i < 3; ++i)
        EXPECT_EQ(pixel.at("colour")[i].get<float>(), image.find(channels[i])->values[static_cast<size_t>(y * 32 + x)])
            << options << ' ' << x << ' ' << y;
    }
  }
}

TEST_F(CliPixelQuery, SaysRaysPartsAndKnots) {
  const json pixel =
      json::parse(run("query scene.json --pixel 16,10 --integrator mixed --tc-rays 2 --spp 16 --shading flat").out);
  EXPECT_EQ(pixel.at("moves"), true);
  EXPECT_EQ(pixel.at("plan"), json({{"tc_rays", 2}, {"discrete", 16}}));
  ASSERT_EQ(pixel.at("rays").size(), 2u);
  const json& ray = pixel.at("rays")[0];
  EXPECT_TRUE(ray.at("time").is_null()) << "over time";
  const json& parts = ray.at("parts");
  ASSERT_GE(parts.size(), 3u) << "the square, the bar, the square";
  EXPECT_EQ(parts[0].at("begin"), 0);
  EXPECT_EQ(parts[0].at("mesh"), "square \"x\"");
  EXPECT_EQ(parts[1].at("mesh"), "bar");
  EXPECT_EQ(parts[1].at("knots")[0].at("colour"), json({0, 1, 0}));
  EXPECT_EQ(pixel.at("still").at("own"), 2);
  EXPECT_EQ(pixel.at("still").at("rays").size(), 16u);
  // Where nothing moves: instants alone.
  const json still = json::parse(run("query scene.json --pixel 1,0 --integrator mixed --tc-rays 2 --spp 16").out);
  EXPECT_EQ(still.at("moves"), false);
  EXPECT_EQ(still.at("rays").size(), 16u);
  EXPECT_TRUE(still.at("rays")[0].at("time").is_number());
  EXPECT_TRUE(still.at("still").is_null());
}

TEST_F(CliPixelQuery, RefusesWhatMakesNoSense) {
  for (const char* arguments :
       {"", "--pixel 32,0", "--pixel 0,20", "--pixel 1", "--pixel -1,2", "--pixel 1,2 --rays -", "--pixel 1,2 --all",
        "--pixel 1,2 --window 0,0.5", "--pixel 1,2 --max-dist 3", "--rays - --spp 4", "--pixel 1,2 --spp 0"}) {
    const CliResult result = run(std::string("query scene.json ") + arguments + " < /dev/null");
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_TRUE(result.one_line_error()) << arguments << ": " << result.err;
  }
}

}  // namespace
}  // namespace kairos
