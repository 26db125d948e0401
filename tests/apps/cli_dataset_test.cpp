// kairos dataset, of scenes and of files over time.
#include <array>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli_time.h"

namespace kairos {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using CliDataset = CliTime;

TEST_F(CliDataset, OfScenes) {
  // A camera that looks along -x and moves along x, a metre a second, with what it sees.
  std::string scene = read(path("scene.json"));
  const std::string still = R"({"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]})";
  const std::string moving = R"({"time": 0, "eye": [0, 0, 0], "target": [-1, 0, 0], "up": [0, 1, 0]},)"
                             R"({"time": 1, "eye": [1, 0, 0], "target": [0, 0, 0], "up": [0, 1, 0]})";
  scene.replace(scene.find(still), still.size(), moving);
  write("moving.json", scene);
  const std::string sampled = " --fps 10 --shading flat --tc-rays 8 --quiet ";
  const std::string shutter = "--shutter 1 --rolling top:0.4s --sensor-lines 40,5 ";
  ok("dataset moving.json --layout fastec-rs -o set --frames 2-3 " + sampled + shutter);
  const auto poses = read(path("set/moving_poses.csv"));
  EXPECT_EQ(std::count(poses.begin(), poses.end(), '\n'), 1 + 2 * 20);
  int frame = 0, line = 0;
  double time = 0, q[4] = {}, place[3] = {};
  const char* const row = poses.c_str() + poses.find("\n3,7,") + 1;
  ASSERT_EQ(std::sscanf(row, "%d,%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &frame, &line, &time, &q[0], &q[1], &q[2], &q[3],
                        &place[0], &place[1], &place[2]),
            10);
  EXPECT_NEAR(time, 0.3 + (5 + 7) * 0.01 + 0.05, 1e-9);
  EXPECT_NEAR(place[0], time, 1e-6);
  EXPECT_NEAR(q[0], std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(q[2], std::sqrt(0.5), 1e-6) << "a quarter turn about y, counter-clockwise from above";
  const json meta = json::parse(read(path("set/moving/meta.log")), nullptr, false);
  EXPECT_EQ(meta.at("line_time_s"), 0.01);
  EXPECT_EQ(meta.at("frames").size(), 2u);
  EXPECT_NEAR(meta.at("frames").at(1).at("sharp_s").get<double>(), 0.3 + (5 + 9.5) * 0.01 + 0.05, 1e-9);
  EXPECT_NEAR(meta.at("intrinsics").at("fy").get<double>(), 10 / std::tan(M_PI / 6), 1e-6);
  EXPECT_TRUE(exists("set/" + meta.at("frames").at(1).at("files").at("sharp_first").get<std::string>()));

  // The pictures are those of files that hold time.
  ok("dataset scene.json --layout bs-rsc -o set --sequence bar --exr --frames 2 --shutter 1 --rolling left:0.4s " +
     sampled);
  ok("render scene.json --frame 2 --shutter 0,5 --time all.ktime --time-tolerance exact" + sampled);
  ok("expose all.ktime -o rolling.exr --quiet --shutter 1 --rolling left:0.4s");
  const double middle = 0.4 * 15.5 / 32 + 0.05;
  ok("expose all.ktime -o sharp.exr --quiet --at " + std::to_string(middle) + "s");
  EXPECT_LT(difference("rolling.exr", "set/bar/RS/0000.exr"), 1e-4);
  EXPECT_LT(difference("sharp.exr", "set/bar/GS/0000.exr"), 1e-2);
  EXPECT_GT(difference("rolling.exr", "set/bar/GS/0000.exr"), 0.1);

  ok("dataset scene.json --layout sintel -o set --frames 1-2 --shutter 1 " + sampled);
  EXPECT_TRUE(exists("set/final/scene/frame_0002.png") && exists("set/clean/scene/frame_0001.png"));
  EXPECT_TRUE(exists("set/flow/scene/frame_0001.flo") && exists("set/occlusions/scene/frame_0001.png"));
  EXPECT_FALSE(exists("set/flow/scene/frame_0002.flo"));
  ok("dataset scene.json --layout gopro -o set --frames 1 --shutter 1 " + sampled);
  EXPECT_TRUE(exists("set/scene/blur/000001.png") && exists("set/scene/sharp/000001.png"));
  ok("dataset scene.json --layout reds -o set --sequence 000 --frames 1 --shutter 1 " + sampled);
  EXPECT_TRUE(exists("set/train_blur/000/00000000.png") && exists("set/train_sharp/000/00000000.png"));

  EXPECT_THAT(refusal("dataset scene.json --layout bs-rsc -o no --frames 1", 2), HasSubstr("--rolling"));
  EXPECT_THAT(refusal("dataset scene.json --layout kitty -o no --frames 1", 2), HasSubstr("gopro|reds"));
  EXPECT_THAT(refusal("dataset scene.json --layout reds -o no --frames 1 --sequence a/b", 2), HasSubstr("--sequence"));
  EXPECT_FALSE(exists("no"));
  EXPECT_THAT(refusal("dataset scene.json --layout reds -o scene.json/no --frames 1 --quiet" + sampled, 1),
              HasSubstr("scene.json/no"));
}

// What loaders of these read, as their programs wrote it: a camera that turns by an eighth to the left in a second and
// moves to the right meanwhile.
TEST_F(CliDataset, OfMovingCameras) {
  std::string scene = read(path("scene.json"));
  const std::string still = R"({"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]})";
  const std::string turning = R"({"time": 0, "eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]},)"
                              R"({"time": 1, "eye": [0.5, 0, 0], "target": [-0.5, 0, -1], "up": [0, 1, 0]})";
  scene.replace(scene.find(still), still.size(), turning);
  write("turning.json", scene);
  const std::string sampled = " --shading flat --tc-rays 4 --quiet ";
  ok("dataset turning.json --layout 3dgs-deblur -o set --frames 0-1 --fps 1 --shutter 0,1" + sampled);
  const json transforms = json::parse(read(path("set/turning/transforms.json")), nullptr, false);
  EXPECT_EQ(transforms.at("exposure_time"), 1);
  EXPECT_NEAR(transforms.at("fl_x").get<double>(), 10 / std::tan(M_PI / 6), 1e-6);
  EXPECT_EQ(transforms.at("frames").at(0).at("camera_angular_velocity").at(1), 0) << "sharp ones are for evaluation";
  // The same second, exposed.
  ok("dataset turning.json --layout carla-rs -o set --frames 0-1 --fps 1 --shutter 0,0.5 --rolling top:0.5s" + sampled);
  std::array<double, 6> v{};
  const std::string log = read(path("set/turning/gt_vel.log"));
  ASSERT_EQ(std::sscanf(log.c_str() + log.rfind('\n', log.size() - 2) + 1, "%lf %lf %lf %lf %lf %lf", &v[0], &v[1],
                        &v[2], &v[3], &v[4], &v[5]),
            6);
  EXPECT_NEAR(v[1], -M_PI / 4, 0.03) << "about y, which points down: to the left";
  EXPECT_NEAR(v[0], 0, 1e-6);
  EXPECT_NEAR(std::hypot(v[3], v[5]), 0.5, 0.02);
  EXPECT_GT(v[3], 0.4);
  EXPECT_LT(v[5], -0.1) << "and backward, as it looks to the left in the middle of its time";

  ok("dataset scene.json --layout carla-rs -o set --frames 0-1 --fps 10 --shutter 3 --rolling top:0.4s" + sampled);
  std::istringstream depth(read(path("set/scene/0001_rs.pdepth")));
  size_t numbers = 0, near = 0;
  for (std::string number; depth >> number; ++numbers) {
    const double value = std::stod(number);
    EXPECT_TRUE(value == 2 || value == 3 || std::isinf(value)) << number;
    near += value == 2;
  }
  EXPECT_EQ(numbers, size_t{32} * 20);
  EXPECT_GT(near, 20u) << "a line a pixel or more of the bar";
  EXPECT_LT(near, 100u) << "at an instant, not over the exposure";

  // From a line's own instant to the global picture's: the bar flies on, and the middle line stays where it is.
  const std::vector<float> vectors = vectors_of("0000_gs_m.flo", "set/scene/");
  ASSERT_EQ(vectors.size(), size_t{2} * 32 * 20);
  const auto most = [&](size_t y) {
    float u = 0;
    for (size_t x = 0; x < 32; ++x)
      if (const float at = vectors[2 * (y * 32 + x)]; std::abs(at) > std::abs(u)) u = at;
    return u;
  };
  EXPECT_GT(most(7), 0.05f);
  EXPECT_LT(most(12), -0.05f);
  EXPECT_NEAR(most(7) / 2.5f, most(8) / 1.5f, 1e-3f);
  EXPECT_TRUE(exists("set/scene/0000_gs_f.flo") && exists("set/scene/0000_mask.png"));

  ok("dataset scene.json --layout kitti -o set --sequence kitti --frames 0-2 --fps 10 --shutter 1" + sampled);
  const std::string kitti = "set/kitti/training/";
  EXPECT_EQ(read(path(kitti + "image_2/000000_11.png")), read(path(kitti + "image_2/000001_10.png")));
  EXPECT_TRUE(exists(kitti + "image_2/000001_11.png"));
  EXPECT_FALSE(exists(kitti + "image_2/000002_10.png")) << "nothing comes after it";
  const auto valid = [&](const std::string& name) {
    const Image flow_image = image(kitti + name);
    const auto& values = flow_image.find("B")->values;
    return std::count_if(values.begin(), values.end(), [](float value) { return value > 0; });
  };
  EXPECT_LT(valid("flow_noc/000000_10.png"), valid("flow_occ/000000_10.png")) << "the bar covers what it comes to";
}

// A file of several frames gives the pictures that its scene does, and the flow between them.
TEST_F(CliDataset, OfFiles) {
  ok("render scene.json --frame 2 --shutter 0,4 --time all.ktime --time-planes geometry --time-tolerance exact --fps "
     "10 "
     "--shading flat --tc-rays 8 --quiet");
  const std::string scene = "dataset scene.json --fps 10 --shading flat --tc-rays 8 -o scene ",
                    file = "dataset all.ktime --sequence scene -o file ";
  for (const std::string layout : {"carla-rs --rolling top:0.04s", "sintel", "3dgs-deblur"}) {
    const std::string of_both = "--quiet --exr --frames 2-3 --shutter 0.5 --layout " + layout;
    ok(scene + of_both);
    ok(file + of_both);
  }
  size_t pictures = 0, same = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("scene"))) {
    const std::string name = std::filesystem::relative(entry.path(), path("scene")).string();
    if (entry.is_directory()) continue;
    ASSERT_TRUE(exists("file/" + name)) << name;
    if (name.ends_with(".exr")) {
      EXPECT_LT(difference("scene/" + name, "file/" + name), 1e-3) << name;
      ++pictures;
    } else if (name.ends_with(".flo")) {
      const std::vector<float> first = vectors_of(name, "scene/"), second = vectors_of(name, "file/");
      ASSERT_EQ(first.size(), second.size());
      for (size_t i = 0; i < first.size(); ++i) ASSERT_NEAR(first[i], second[i], 1e-3) << name;
      ++same;
    } else if (name.ends_with("_poses.csv") || name.ends_with("_mask.png")) {
      EXPECT_TRUE(read(path("scene/" + name)) == read(path("file/" + name))) << name;
      ++same;
    }
  }
  EXPECT_EQ(pictures, 12u);
  EXPECT_EQ(same, 8u);

  EXPECT_THAT(refusal("dataset all.ktime --layout gopro --frames 2 -o no --tc-rays 3", 2), HasSubstr("--tc-rays"));
  EXPECT_THAT(refusal("dataset all.ktime --layout gopro --frames 2-6 -o no --quiet", 1), HasSubstr("--shutter 0,4.5"));
  ok(std::string(kRenderTime) + "--shutter 0,10 --time colours.ktime");
  EXPECT_THAT(refusal("dataset colours.ktime --layout sintel --frames 2 -o no", 1),
              HasSubstr("--time-planes geometry"));
  ok("dataset colours.ktime --layout gopro --frames 2 -o colours --quiet");
  EXPECT_TRUE(exists("colours/colours/blur/000001.png"));
  EXPECT_FALSE(exists("colours/colours_poses.csv")) << "nobody knows where the camera was";
}

}  // namespace
}  // namespace kairos
