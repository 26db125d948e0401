// A scene of 1.4 million triangles under a moving camera: what it may cost.
#include <algorithm>
#include <chrono>
#include <filesystem>

#include <nlohmann/json.hpp>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "cli.h"
#include "data_folders.h"
#include "discrete/discrete_scene.h"

namespace kairos {
namespace {

constexpr double kBytesPerTriangle = 600;  // the process at its largest: file, geometry, trees, picture
constexpr double kBuildRatio = 3;          // over Embree's own motion-blur build of the same keys

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
    const CliResult result = run(
        std::string(
            "render kitchen/scene.json -o picture.exr --size 240x135 --quiet --stats-file stats.json --integrator ") +
        integrator);
    ASSERT_EQ(result.status, 0) << result.err;
    const auto stats = nlohmann::json::parse(read(path("stats.json")));
    EXPECT_GT(stats.at("triangles").get<double>(), 1.4e6);
    EXPECT_LT(stats.at("peak_memory_bytes").get<double>() / stats.at("triangles").get<double>(), kBytesPerTriangle)
        << integrator;
  }
}

TEST_F(Kitchen, BuildsInThreeTimesEmbreesTime) {
  const Shot shot = make_shot(*load_scene({path("kitchen/scene.json")}));
  const auto seconds = [](const auto& build) {
    const auto start = std::chrono::steady_clock::now();
    build();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::vector<double> ratios;
  for (int round = 0; round < 3; ++round) {
    const double ours = seconds([&] { const Tracer tracer(shot.meshes); });
    ratios.push_back(ours / seconds([&] { const DiscreteScene discrete(shot.meshes); }));
  }
  std::sort(ratios.begin(), ratios.end());
  RecordProperty("build_ratio", std::to_string(ratios[1]));
  std::printf("build, ours over Embree's: %.2f (%.2f to %.2f)\n", ratios[1], ratios[0], ratios[2]);
  EXPECT_LT(ratios[1], kBuildRatio);
}

}  // namespace
}  // namespace kairos
