// Whole pictures against exact ones: rectangles that move and hide each other, integrated on closed form over each
// pixel and the shutter. Pixel filter, camera, orientation and shutter window all have to be right.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <kairos/render.h>

#include "oracle.h"
#include "temp_folder.h"

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

TEST(Coverage, ErrorsShrinkWithRays) {
  const TempFolder folder;
  const uint32_t seed = test::seed();
  const std::string whole = folder.path("whole"), window = folder.path("window");
  test::ask_oracle("moving_rectangles.py", whole, seed);
  Exact(whole).check();
  test::ask_oracle("moving_rectangles.py", window, seed, "--window 0.25,0.75");
  Exact(window).check();
}

TEST(Coverage, SmallScenes) {
  const TempFolder folder;
  const uint32_t first = test::seed();
  for (uint32_t seed = first; seed < first + 3; ++seed) {
    SCOPED_TRACE(seed);
    const std::string scene = folder.path(std::to_string(seed));
    test::ask_oracle("moving_rectangles.py", scene, seed,
                     std::string("--size 25x17 --window ") + (seed % 2 == 0 ? "0,1" : "0.125,0.5"));
    const Exact exact(scene);
    EXPECT_LT(exact.rmse(IntegratorKind::tc, 256), 0.004);
    EXPECT_LT(exact.rmse(IntegratorKind::qmc, 1024), 0.004);
  }
}

}  // namespace
}  // namespace kairos
