// kairos calibrate, and render --calibration.
#include <nlohmann/json.hpp>

#include "cli.h"
#include "image/read_exr.h"

namespace kairos {
namespace {

class CliCalibrate : public CliTest {
 protected:
  std::string attribute(const std::string& picture) const {
    for (const Attribute& a : read_exr(path(picture)).attributes)
      if (a.name == "kairos:calibration") return std::get<std::string>(a.value);
    return "";
  }
  nlohmann::json stats(const std::string& name) const { return nlohmann::json::parse(read(path(name))); }
};

constexpr const char* kCheap = R"({"kairos_calibration": 1, "shading": "normal", "nanoseconds":
  {"discrete_sample": 100, "still_ray": 10, "tc_ray": {"1": 120, "4": 110, "16": 100}}})";

TEST_F(CliCalibrate, WritesWhatRenderTakes) {
  const CliResult result = run("calibrate scene.json -o c.json --shading normal");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("a discrete sample takes "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("wrote c.json\n"), std::string::npos) << result.err;
  for (const std::string threads : {"1", "2"})
    ASSERT_EQ(run("render scene.json --quiet --spp 64 --shading normal --calibration c.json -o " + threads +
                  ".exr --stats-file " + threads + ".json --threads " + threads)
                  .status,
              0);
  EXPECT_EQ(read_exr(path("1.exr")).find("R")->values, read_exr(path("2.exr")).find("R")->values);
  EXPECT_EQ(attribute("1.exr"), attribute("2.exr"));
  const nlohmann::json measured = nlohmann::json::parse(read(path("c.json"))).at("nanoseconds");
  const nlohmann::json chosen = stats("1.json").at("auto");
  EXPECT_EQ(chosen.at("calibration"), "measured");
  EXPECT_DOUBLE_EQ(chosen.at("prices").at("tc_ray").at("16").get<double>(),
                   measured.at("tc_ray").at("16").get<double>() / measured.at("discrete_sample").get<double>());
  EXPECT_EQ(run("calibrate scene.json -o c.json --quiet --shading flat").status, 0);
  EXPECT_EQ(run("calibrate scene.json -o d.json --quiet").err, "");
}

TEST_F(CliCalibrate, ThePictureGoesByTheFile) {
  write("cheap.json", kCheap);
  const std::string shot = "render scene.json --quiet --spp 128 --shading normal --stats-file s.json ";
  ASSERT_EQ(run(shot + "-o cheap.exr --calibration cheap.json").status, 0);
  const nlohmann::json cheap = stats("s.json").at("auto");
  EXPECT_GT(cheap.at("tc_pixels"), 0.1);
  EXPECT_LE(cheap.at("tc_pixels"), cheap.at("moving_pixels"));
  EXPECT_GE(cheap.at("mean_tc_rays"), 16);
  EXPECT_EQ(cheap.at("prices").at("still_ray"), 0.1);
  EXPECT_NE(attribute("cheap.exr").find("discrete_sample 100, still_ray 10, tc_ray of 1 120, tc_ray of 4 110, "),
            std::string::npos)
      << attribute("cheap.exr");
  ASSERT_EQ(run(shot + "-o a.exr").status, 0);
  ASSERT_EQ(run(shot + "-o b.exr --calibration default").status, 0);
  EXPECT_EQ(stats("s.json").at("auto").at("calibration"), "default");
  EXPECT_EQ(attribute("b.exr"), "default");
  EXPECT_EQ(read_exr(path("a.exr")).find("R")->values, read_exr(path("b.exr")).find("R")->values);
}

TEST_F(CliCalibrate, BadFilesAreOneLine) {
  write("broken.json", "{\"kairos_calibration\": 1,\n");
  write("cheap.json", kCheap);
  write("huge.json", std::string(100000, ' '));
  const size_t before = files();
  const auto refused = [&](const std::string& arguments, const std::string& word) {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  };
  const std::string shot = "render scene.json --quiet -o a.exr ";
  refused(shot + "--calibration broken.json", "broken.json");
  refused(shot + "--calibration missing.json", "missing.json");
  refused(shot + "--calibration scene.json", "scene.json");
  refused(shot + "--calibration huge.json", "huge.json");
  refused(shot + "--calibration cheap.json --shading flat", "kairos calibrate --shading flat");
  refused("calibrate square.obj -o a.json", "nothing moves");
  refused("calibrate scene.json -o missing/a.json", "missing");
  EXPECT_EQ(run("calibrate scene.json").status, 2);
  EXPECT_EQ(run("calibrate scene.json -o a.json --shading bounds").status, 2);
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace kairos
