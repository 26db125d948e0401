// Whole pictures against exact ones: rectangles that move and hide each other, integrated on closed form over each
// pixel and the shutter. Pixel filter, camera, orientation and shutter window all have to be right.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include <kairos/render.h>

#include "data_folders.h"

namespace kairos {
namespace {

namespace fs = std::filesystem;

// [y][x][channel], rows from the top.
std::vector<float> read_pfm(const fs::path& path, int& width, int& height) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  double scale = 0;
  file >> magic >> width >> height >> scale;
  file.get();
  const auto row_floats = static_cast<size_t>(width) * 3;
  std::vector<float> pixels(row_floats * static_cast<size_t>(height));
  for (int y = height - 1; y >= 0; --y)  // PFM begins with the lowest row
    file.read(reinterpret_cast<char*>(pixels.data() + row_floats * static_cast<size_t>(y)),
              static_cast<std::streamsize>(row_floats * sizeof(float)));
  EXPECT_TRUE(file && magic == "PF" && scale == -1) << path;
  return pixels;
}

class Exact {
 public:
  explicit Exact(const fs::path& folder) : shot_(make_shot(*load_scene({(folder / "scene.json").string()}))) {
    expected_ = read_pfm(folder / "expected.pfm", width_, height_);
  }

  double rmse(IntegratorKind integrator, int samples, uint64_t seed = 0) const {
    RenderParams params;
    params.integrator = integrator;
    params.tc_rays = params.spp = samples;
    params.shading = ShadingKind::flat;
    params.seed = seed;
    const Image image = render(shot_, params);
    EXPECT_EQ(image.width, width_);
    EXPECT_EQ(image.height, height_);
    const Channel* const channels[3] = {image.find("R"), image.find("G"), image.find("B")};
    double sum = 0;
    for (size_t i = 0; i < expected_.size(); ++i) {
      const double difference = channels[i % 3]->values[i / 3] - expected_[i];
      sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(expected_.size()));
  }

  void check() const {
    const double tc = rmse(IntegratorKind::tc, 256), qmc = rmse(IntegratorKind::qmc, 1024);
    std::printf("rmse: tc 16 %.5f, 64 %.5f, 256 %.5f; qmc 64 %.5f, 256 %.5f, 1024 %.5f\n", rmse(IntegratorKind::tc, 16),
                rmse(IntegratorKind::tc, 64), tc, rmse(IntegratorKind::qmc, 64), rmse(IntegratorKind::qmc, 256), qmc);
    EXPECT_LT(tc, 0.004);
    EXPECT_LT(qmc, 0.004);
    EXPECT_LT(tc, rmse(IntegratorKind::tc, 64));
    EXPECT_LT(rmse(IntegratorKind::tc, 64), rmse(IntegratorKind::tc, 16));
    EXPECT_LT(qmc, rmse(IntegratorKind::qmc, 256));
    EXPECT_LT(rmse(IntegratorKind::qmc, 256), rmse(IntegratorKind::qmc, 64));
  }

 private:
  Shot shot_;
  std::vector<float> expected_;
  int width_ = 0, height_ = 0;
};

class Coverage : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(oracle_)) GTEST_SKIP() << "no exact answers at " << oracle_ << "; set KAIROS_ORACLE";
  }
  const fs::path oracle_ = oracle_folder();
};

TEST_F(Coverage, WholeMotion) { Exact(oracle_ / "coverage" / "global").check(); }

TEST_F(Coverage, ShutterWindow) { Exact(oracle_ / "coverage" / "window").check(); }

TEST_F(Coverage, FreshScenes) {
  const char* const given = std::getenv("KAIROS_SEED");
  const auto first =
      given != nullptr ? std::strtoul(given, nullptr, 10) : static_cast<unsigned long>(std::time(nullptr));
  for (unsigned long seed = first; seed < first + 3; ++seed) {
    std::printf("KAIROS_SEED=%lu\n", seed);
    std::string name = (fs::temp_directory_path() / "kairos_coverage_XXXXXX").string();
    const fs::path folder = mkdtemp(name.data());
    const char* const window = seed % 2 == 0 ? "0,1" : "0.125,0.5";
    const std::string command = "python3 '" + (oracle_ / "make_coverage.py").string() + "' '" + folder.string() + "' " +
                                std::to_string(seed) + " --size 25x17 --window " + window + " > /dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    const Exact exact(folder);
    EXPECT_LT(exact.rmse(IntegratorKind::tc, 256), 0.004) << "seed " << seed;
    EXPECT_LT(exact.rmse(IntegratorKind::qmc, 1024), 0.004) << "seed " << seed;
    fs::remove_all(folder);
  }
}

}  // namespace
}  // namespace kairos
