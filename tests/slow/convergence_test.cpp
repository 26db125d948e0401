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
#include "whitted_scene.h"

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

void expect_same_limit(const Shot& shot, ShadingKind shading, IntegratorKind kind = IntegratorKind::tc, int rays = 64,
                       int pictures = 4) {
  RenderParams tc, qmc;
  tc.integrator = kind;
  tc.shading = qmc.shading = shading;
  tc.tc_rays = rays;
  tc.shading_samples = 64;
  qmc.integrator = IntegratorKind::qmc;
  qmc.spp = 4096;
  const Mean a = mean_of(shot, tc, pictures, 100), b = mean_of(shot, qmc, 2, 200);
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

// A mirror, a moving glass ball, a moving box, their shadows, and a lamp.
TEST(WhittedScene, TcMixedAndQmcMeet) {
  Shot shot;
  shot.projection.width = 20;
  shot.projection.height = 15;
  shot.materials = {lambert({0.7f, 0.6f, 0.5f}), mirror({0.9f, 0.9f, 0.9f}), glass(1.5f), lambert({0.2f, 0.4f, 0.9f}),
                    lamp({6, 6, 6})};
  shot.lights = {PointLight{{-2, 3, -2}, {12, 12, 12}}, ConstantLight{{0.3f, 0.3f, 0.4f}}};
  shot.meshes = {parallelogram({-6, -1, 2}, {12, 0, 0}, {0, 0, -12}, 0),
                 parallelogram({-3, -1, -7}, {6, 0, 0}, {0, 4, 0}, 1), ball({-0.7f, -0.2f, -4}, 0.7f, 12, 2),
                 box({0.3f, -1, -5}, {1.2f, 0, -4.2f}, 3), parallelogram({0, 2.5f, -5}, {1, 0, 0}, {0, 0, 1}, 4)};
  for (const size_t moving : {2, 3}) {
    Mesh& mesh = shot.meshes[moving];
    mesh.positions.push_back(mesh.positions[0]);
    for (Vec3f& p : mesh.positions[1]) p.x += moving == 2 ? 0.5f : 1.5f;
    mesh.key_times = {0, 1};
  }
  shot.meshes[2].normals.resize(1);
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::mixed})
    expect_same_limit(shot, ShadingKind::whitted, kind, 16, 16);
}

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
