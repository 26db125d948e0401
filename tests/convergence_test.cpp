// Time-continuous and discrete rays must converge to the same picture: where both are noisy, they may differ by their
// noise and no more. The noise of each is measured from pictures with independent seeds.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>
#include <unistd.h>

#include <kairos/render.h>

#include "data_folders.h"

namespace kairos {
namespace {

namespace fs = std::filesystem;

// The mean of some pictures with seeds of their own, and the mean square over all pixels of that mean's error, which is
// estimated from how much the pictures differ.
struct Mean {
  std::vector<double> values;
  double square_error = 0;
};

Mean mean_of(const Shot& shot, RenderParams params, int pictures, uint64_t first_seed) {
  std::vector<std::vector<double>> all;
  for (int i = 0; i < pictures; ++i) {
    params.seed = first_seed + static_cast<uint64_t>(i);
    const Image image = render(shot, params);
    std::vector<double>& values = all.emplace_back();
    for (const char* name : {"R", "G", "B"})
      values.insert(values.end(), image.find(name)->values.begin(), image.find(name)->values.end());
  }
  Mean mean;
  mean.values.resize(all[0].size());
  for (const auto& values : all)
    for (size_t i = 0; i < values.size(); ++i) mean.values[i] += values[i] / pictures;
  for (const auto& values : all)
    for (size_t i = 0; i < values.size(); ++i) mean.square_error += std::pow(values[i] - mean.values[i], 2);
  mean.square_error /= static_cast<double>(mean.values.size()) * (pictures - 1) * pictures;
  return mean;
}

void expect_same_limit(const Shot& shot, ShadingKind shading) {
  RenderParams tc, qmc;
  tc.shading = qmc.shading = shading;
  tc.tc_rays = 64;
  tc.shading_samples = 64;
  qmc.integrator = IntegratorKind::qmc;
  qmc.spp = 4096;
  const Mean a = mean_of(shot, tc, 4, 100), b = mean_of(shot, qmc, 2, 200);
  double difference = 0, bias = 0, contrast = 0;
  for (size_t i = 0; i < a.values.size(); ++i) {
    difference += std::pow(a.values[i] - b.values[i], 2);
    bias += a.values[i] - b.values[i];
    contrast = std::max(contrast, a.values[i]);
  }
  const auto count = static_cast<double>(a.values.size());
  const double noise = std::sqrt(a.square_error + b.square_error);
  std::printf("difference %.6f, noise of tc %.6f and of qmc %.6f; mean difference %.2e\n",
              std::sqrt(difference / count), std::sqrt(a.square_error), std::sqrt(b.square_error), bias / count);
  EXPECT_GT(contrast, 0.1) << "nothing to be seen";
  // The estimate of the noise has some of its own, mostly from few pixels with edges.
  EXPECT_LT(std::sqrt(difference / count), 1.25 * noise);
  EXPECT_LT(std::abs(bias / count), 5 * noise / std::sqrt(count));
}

Shot shot_of(const std::string& path, const std::string& animation, double frame, double close) {
  LoadOptions load;
  load.animation = animation;
  ShotOptions options;
  options.frame = frame;
  options.shutter = {0, close};
  options.width = 32;
  options.height = 24;
  return make_shot(*load_scene({path}, load), options);
}

struct Case {
  const char *folder, *file, *animation;
  double frame, close;  // frames
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.folder; }

class Convergence : public testing::TestWithParam<Case> {};

TEST_P(Convergence, TcAndQmcMeet) {
  const Case& c = GetParam();
  const fs::path path = fs::path(scenes_folder()) / c.folder / c.file;
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path << "; set KAIROS_SCENES";
  const Shot shot = shot_of(path.string(), c.animation, c.frame, c.close);
  bool moves = false;
  for (const Mesh& mesh : shot.meshes) moves = moves || !mesh.is_static();
  ASSERT_TRUE(moves);
  expect_same_limit(shot, ShadingKind::normal);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Convergence,
                         testing::Values(Case{"vintage-fan", "vintageFan_animated.gltf", "", 10, 2},
                                         Case{"mannequiny", "mannequiny.glb", "run_root.001", 5, 1},
                                         Case{"robot-expressive", "robot.glb", "Robot_Dance", 10, 1}),
                         [](const testing::TestParamInfo<Case>& scene) {
                           std::string name = scene.param.folder;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST(DemoScene, TcAndQmcMeet) {
  std::string name = (fs::temp_directory_path() / "kairos_convergence_XXXXXX").string();
  const fs::path folder = mkdtemp(name.data()), scene = folder / "demo.glb";
  const std::string command =
      "python3 '" KAIROS_SOURCE_DIR "/tools/make_demo_scene.py' '" + scene.string() + "' > /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const Shot shot = shot_of(scene.string(), "", 0, 0.5);
  expect_same_limit(shot, ShadingKind::flat);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace kairos
