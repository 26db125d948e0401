// A scene of 1.4 million triangles under a moving camera: what it may cost.
#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli.h"
#include "data_folders.h"

namespace kairos {
namespace {

constexpr double kBytesPerTriangle = 600;  // the process at its largest: file, geometry, trees, picture

class Kitchen : public CliTest {
 protected:
  void SetUp() override {
    const std::filesystem::path kitchen = std::filesystem::path(scenes_folder()) / "bitterli-kitchen";
    if (!std::filesystem::exists(kitchen)) GTEST_SKIP() << "no folder " << kitchen << "; set KAIROS_SCENES";
    const std::string command = "python3 '" KAIROS_SOURCE_DIR "/tools/kitchen_scene.py' '" + kitchen.string() + "' '" +
                                path("kitchen") + "' > /dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
};

TEST_F(Kitchen, RendersInSixHundredBytesPerTriangle) {
  for (const char* integrator : {"tc --tc-rays 1", "qmc --spp 1"}) {
    const CliResult result = run(std::string("render kitchen/scene.json -o picture.exr --size 240x135 --shading normal "
                                             "--quiet --stats-file stats.json --integrator ") +
                                 integrator);
    ASSERT_EQ(result.status, 0) << result.err;
    const auto stats = nlohmann::json::parse(read(path("stats.json")));
    EXPECT_GT(stats.at("triangles").get<double>(), 1.4e6);
    EXPECT_LT(stats.at("peak_memory_bytes").get<double>() / stats.at("triangles").get<double>(), kBytesPerTriangle)
        << integrator;
  }
}

}  // namespace
}  // namespace kairos
