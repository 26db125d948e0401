// Folders of recordings: what lies in them agrees with each other.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <kairos/event_file.h>
#include <kairos/event_folder.h>
#include <kairos/image.h>
#include <kairos/make_scene.h>

#include "error_matchers.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {
namespace {

/// Slanted walls, before which a camera flies and turns, and one of which moves.
std::shared_ptr<const Scene> walls(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution(low, high)(random));
  };
  SceneDescription description;
  for (int i = 0; i < 3; ++i) {
    MeshDescription wall;
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    const float depth = -2.0f - static_cast<float>(i), half = i == 2 ? 9.0f : 0.8f, lean = uniform(-0.2, 0.2);
    const Vec3f middle{i == 2 ? 0.0f : uniform(-0.5, 0.5), i == 2 ? 0.0f : uniform(-0.5, 0.5), depth};
    std::vector<Vec3f> corners;
    for (const auto& [x, y] : {std::pair(-1.0f, -1.0f), {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}})
      corners.push_back(middle + Vec3f{x * half, y * half, x * half * lean});
    wall.positions = {corners};
    wall.material = static_cast<uint32_t>(i);
    description.meshes.push_back(wall);
    Material paint;
    const float grey = std::array{0.1f, 1.0f, 0.3f}[static_cast<size_t>(i)];
    paint.base_color = {grey * uniform(0.8, 1), grey * uniform(0.8, 1), grey * uniform(0.8, 1)};
    description.materials.push_back(paint);
  }
  CameraDescription camera;
  camera.vfov = uniform(0.8, 1.2);
  for (const double time : {0.0, 1.0}) {
    CameraKey key;
    key.time = time;
    key.eye = {(time - 0.5) * uniform(0.5, 0.8), uniform(-0.3, 0.3), uniform(-0.2, 0.2)};
    key.target = {uniform(-0.4, 0.4), uniform(-0.4, 0.4), -2};
    key.up = {uniform(-0.2, 0.2), 1, 0};
    camera.keys.push_back(key);
  }
  description.cameras = {camera};
  return make_scene(description);
}

std::vector<std::vector<double>> numbers_of(const std::string& path) {
  std::vector<std::vector<double>> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    lines.emplace_back();
    for (double number = 0; words >> number;) lines.back().push_back(number);
  }
  return lines;
}

/// A pose of a trajectory's line: t, place, quaternion with its real part last.
struct Pose {
  std::array<Vec3d, 3> axes;
  Vec3d place;

  explicit Pose(const std::vector<double>& line) : place{line[1], line[2], line[3]} {
    const double x = line[4], y = line[5], z = line[6], w = line[7];
    axes = {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
            Vec3d{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
            Vec3d{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
  }
  Vec3d to_world(const Vec3d& p) const { return axes[0] * p.x + axes[1] * p.y + axes[2] * p.z + place; }
  Vec3d to_camera(const Vec3d& p) const {
    return {dot(axes[0], p - place), dot(axes[1], p - place), dot(axes[2], p - place)};
  }
};

constexpr int kColumns = 24, kRows = 18;
constexpr double kRate = 4;

/// Records a second of it into a folder.
void record_into(const std::string& path, EventLayout layout, const Scene& scene, double exposure) {
  EventOptions recording;
  recording.render.shading = ShadingKind::flat;
  recording.render.threads = 1;
  recording.shot.width = kColumns;
  recording.shot.height = kRows;
  recording.shot.motion_tolerance = 0.005;
  recording.rays = 16;
  EventFolderOptions options;
  options.layout = layout;
  options.frame_rate = options.pose_rate = kRate;
  options.exposure = exposure;
  options.samples = 64;
  options.exr = true;
  EventFolder folder(path, options, scene, recording);
  record_events(scene, recording, folder);
  folder.finish();
}

TEST(EventFolder, HoldsPicturesDepthFlowPosesAndEventsThatAgree) {
  std::mt19937 random(test::seed());
  const auto scene = walls(random);
  const TempFolder folder;
  record_into(folder.path("f"), EventLayout::rpg, *scene, 0);
  const auto lens = numbers_of(folder.path("f/calib.txt")).at(0);
  const auto poses = numbers_of(folder.path("f/groundtruth.txt")), events = numbers_of(folder.path("f/events.txt"));
  const auto moments = numbers_of(folder.path("f/images.txt"));
  ASSERT_EQ(moments.size(), kRate + 1);
  ASSERT_EQ(poses.size(), kRate + 1);
  EXPECT_GT(events.size(), 20u);
  const auto name = [&](const char* what, size_t number, const char* ending) {
    return folder.path("f/" + std::string(what) + "/frame_0000000" + std::to_string(number) + ending);
  };
  std::vector<double> first(static_cast<size_t>(kColumns) * kRows), claimed(first.size());
  size_t event = 0, agree = 0, close = 0, known = 0;
  for (size_t m = 0; m < moments.size(); ++m) {
    EXPECT_NEAR(moments[m][0], static_cast<double>(m) / kRate, 1e-9);
    // What the events say since the first picture is what this one shows.
    for (; event < events.size() && events[event][0] <= moments[m][0]; ++event)
      claimed[static_cast<size_t>(events[event][2] * kColumns + events[event][1])] += events[event][3] > 0 ? 0.2 : -0.2;
    const Image picture = read_image(name("images", m, ".exr")), depth = read_image(name("depthmaps", m, ".exr"));
    for (size_t i = 0; i < first.size(); ++i) {
      const double light = 0.2126 * static_cast<double>(picture.find("R")->values[i]) +
                           0.7152 * static_cast<double>(picture.find("G")->values[i]) +
                           0.0722 * static_cast<double>(picture.find("B")->values[i]);
      const double brightness = std::log(light + 1.0 / 255);
      if (m == 0) first[i] = brightness;
      constexpr double kSampled = 0.1;
      agree += std::abs(brightness - first[i] - claimed[i]) < 0.2 + kSampled;
    }
    if (m + 1 == moments.size()) break;
    // A point of the picture, in the world, in the next picture.
    std::ifstream flow(name("flow", m, ".flo"), std::ios::binary);
    flow.ignore(12);
    const Pose here(poses[m]), there(poses[m + 1]);
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        std::array<float, 2> way{};
        flow.read(reinterpret_cast<char*>(way.data()), sizeof way);
        const auto z = static_cast<double>(depth.find("Y")->values[static_cast<size_t>(y * kColumns + x)]);
        const Vec3d seen =
            there.to_camera(here.to_world(Vec3d{(x - lens[2]) / lens[0], (y - lens[3]) / lens[1], 1} * z));
        ++known;
        close += std::abs(seen.x / seen.z * lens[0] + lens[2] - x - static_cast<double>(way[0])) < 1e-2 &&
                 std::abs(seen.y / seen.z * lens[1] + lens[3] - y - static_cast<double>(way[1])) < 1e-2;
      }
  }
  EXPECT_GT(static_cast<double>(close), 0.99 * static_cast<double>(known));  // all but those at edges
  EXPECT_GT(static_cast<double>(agree), 0.97 * static_cast<double>(first.size() * moments.size()));
}

TEST(EventFolder, SharesOutTheTimeOfItsEventsAsEventNerfReadsIt) {
  std::mt19937 random(test::seed());
  const auto scene = walls(random);
  const TempFolder folder;
  record_into(folder.path("f"), EventLayout::eventnerf, *scene, 0.01);
  struct Last : EventSink {
    void add(std::span<const Event> events) override {
      if (!events.empty()) time = static_cast<double>(events.back().time) * 1e-9;
    }
    double time = 0;
  } last;
  read_events(folder.path("f/events/events.npz"), last);
  const auto count = static_cast<size_t>(std::max(std::round(last.time * kRate), 1.0)) + 1;
  size_t poses = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path("f/pose"))) poses += entry.is_regular_file();
  EXPECT_EQ(poses, count);
  EXPECT_TRUE(std::filesystem::exists(folder.path("f/rgb_blurred/000000.png")));
  // The last one is the camera when the last event comes: on the way between the trajectory's last two poses.
  const auto matrix = numbers_of(folder.path("f/pose/00000" + std::to_string(count - 1) + ".txt"));
  const auto trajectory = numbers_of(folder.path("f/trajectory.txt"));
  const auto after = static_cast<size_t>(std::ceil(last.time * kRate));
  const double part = last.time * kRate - static_cast<double>(after - 1);
  for (size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(matrix[axis][3], std::lerp(trajectory[after - 1][axis + 1], trajectory[after][axis + 1], part), 1e-5);
}

TEST(EventFolder, IsOfPinholeCamerasAlone) {
  SceneDescription description;
  CameraDescription camera;
  camera.keys = {{}};
  camera.orthographic = true;
  description.cameras = {camera};
  MeshDescription mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.positions = {{{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}};
  description.meshes = {mesh};
  const auto scene = make_scene(description);
  const TempFolder folder;
  expect_error([&] { EventFolder(folder.path("f"), {}, *scene, {}); }, {"pinhole"}, ErrorCode::bad_usage);
  EXPECT_FALSE(std::filesystem::exists(folder.path("f")));
}

}  // namespace
}  // namespace kairos
