// Optical flow: against closed forms and against depth and pose.
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/flow.h>

#include "image/picture_formats.h"
#include "seed.h"
#include "temp_folder.h"
#include "whitted_scene.h"

namespace kairos {
namespace {

constexpr int kWide = 40, kHigh = 30;

/// A wall far away, and a square before it that moves by `by`.
Shot square_before_wall(Vec3f by) {
  Shot shot;
  shot.projection.width = kWide;
  shot.projection.height = kHigh;
  shot.materials = {lambert({0.5f, 0.5f, 0.5f})};
  shot.meshes = {parallelogram({-9, -9, -8}, {18, 0, 0}, {0, 18, 0}, 0),
                 parallelogram({-1, -1, -4}, {2, 0, 0}, {0, 2, 0}, 0)};
  Mesh& square = shot.meshes[1];
  square.positions.push_back(square.positions[0]);
  for (Vec3f& p : square.positions[1]) p += by;
  square.key_times = {0, 1};
  return shot;
}

struct At {
  const Image& image;
  float operator()(const char* channel, int x, int y) const {
    return image.find(channel)->values[static_cast<size_t>(y * kWide + x)];
  }
};

/// Pixels to the right of and below the middle of a point in camera space.
std::array<double, 2> film(const Projection& p, double x, double y, double z) {
  const double focal = p.height / 2.0 / std::tan(p.vfov / 2);
  return {p.width / 2.0 + focal * x / -z, p.height / 2.0 - focal * y / -z};
}

// Right is +u, down is +v; forward and backward; what the square comes to cover is hidden, what it uncovers is seen.
TEST(Flow, OfASquareBeforeAWall) {
  const Shot shot = square_before_wall({0.5f, -0.25f, 0});
  const double focal = kHigh / 2.0 / std::tan(shot.projection.vfov / 2);
  for (const bool backward : {false, true}) {
    FlowOptions options;
    options.backward = backward;
    const Image image = flow(shot, options);
    const At at{image};
    size_t hidden = 0;
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x) {
        const auto inside = [&](double moved) {
          const double right = (x + 0.5 - kWide / 2.0) * 4 / focal, up = (kHigh / 2.0 - y - 0.5) * 4 / focal;
          return std::abs(right - 0.5 * moved) < 1 && std::abs(up + 0.25 * moved) < 1;
        };
        const bool before = inside(backward ? 1 : 0), after = inside(backward ? 0 : 1);
        const double sign = backward ? -1 : 1;
        ASSERT_NEAR(at("flow.u", x, y), before ? sign * 0.5 / 4 * focal : 0, 1e-4) << x << " " << y;
        ASSERT_NEAR(at("flow.v", x, y), before ? sign * 0.25 / 4 * focal : 0, 1e-4) << x << " " << y;
        ASSERT_NEAR(at("depth.Z", x, y), before ? 4 : 8, 1e-4);
        const FlowState expected = !before && after ? FlowState::hidden : FlowState::seen;
        ASSERT_EQ(at("flow.state", x, y), static_cast<float>(expected)) << x << " " << y;
        hidden += expected == FlowState::hidden;
      }
    EXPECT_GT(hidden, 10u);
  }
}

// Each row between instants of its own, as a rolling shutter's lines have them: a part of the way, from where the
// square is by then.
TEST(Flow, RowsMayHaveInstantsOfTheirOwn) {
  const Shot shot = square_before_wall({1, 0, 0});
  const double focal = kHigh / 2.0 / std::tan(shot.projection.vfov / 2);
  const auto begin = [](int y) { return 0.5 * y / kHigh; };
  FlowOptions options;
  options.times = [&](int, int y) -> std::array<double, 2> { return {begin(y), 0.75}; };
  const Image image = flow(shot, options);
  const At at{image};
  size_t moving = 0, hidden = 0;
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) {
      const double right = (x + 0.5 - kWide / 2.0) * 4 / focal, up = (kHigh / 2.0 - y - 0.5) * 4 / focal;
      if (std::abs(std::abs(right - begin(y)) - 1) < 1e-6 || std::abs(std::abs(right - 0.75) - 1) < 1e-6) continue;
      const bool before = std::abs(right - begin(y)) < 1 && std::abs(up) < 1,
                 after = std::abs(right - 0.75) < 1 && std::abs(up) < 1;
      ASSERT_NEAR(at("flow.u", x, y), before ? (0.75 - begin(y)) / 4 * focal : 0, 1e-4) << x << " " << y;
      ASSERT_NEAR(at("depth.Z", x, y), before ? 4 : 8, 1e-4) << x << " " << y;
      const FlowState expected = !before && after ? FlowState::hidden : FlowState::seen;
      ASSERT_EQ(at("flow.state", x, y), static_cast<float>(expected)) << x << " " << y;
      moving += before;
      hidden += expected == FlowState::hidden;
    }
  EXPECT_GT(moving, 50u);
  EXPECT_GT(hidden, 5u);
}

// A camera that moves and turns before things that stand still: a pixel's depth and the pose say where it goes.
TEST(Flow, AgreesWithDepthAndPose) {
  const uint32_t seed = test::seed();
  std::mt19937 random(seed);
  const auto real = [&](double least, double most) { return std::uniform_real_distribution<>(least, most)(random); };
  const double angle = real(-0.1, 0.1), shift[3] = {real(-0.5, 0.5), real(-0.5, 0.5), real(0.1, 0.5)};
  // A point of the camera's space at the end, of one at the beginning: turned about y, and shifted.
  const auto moved = [&](double x, double y, double z) -> std::array<double, 3> {
    return {std::cos(angle) * x + std::sin(angle) * z + shift[0], y + shift[1],
            -std::sin(angle) * x + std::cos(angle) * z + shift[2]};
  };
  Shot shot = square_before_wall({});
  for (Mesh& mesh : shot.meshes) {
    mesh.positions.resize(1);
    mesh.positions.push_back(mesh.positions[0]);
    mesh.key_times = {0, 1};
    for (Vec3f& p : mesh.positions[1]) {
      const auto q = moved(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
      p = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])};
    }
  }
  const Image image = flow(shot);
  const At at{image};
  const double focal = kHigh / 2.0 / std::tan(shot.projection.vfov / 2);
  size_t outside = 0;
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) {
      const double depth = static_cast<double>(at("depth.Z", x, y));
      const auto q = moved((x + 0.5 - kWide / 2.0) / focal * depth, (kHigh / 2.0 - y - 0.5) / focal * depth, -depth);
      const auto there = film(shot.projection, q[0], q[1], q[2]);
      ASSERT_NEAR(at("flow.u", x, y), there[0] - x - 0.5, 1e-3) << x << " " << y;
      ASSERT_NEAR(at("flow.v", x, y), there[1] - y - 0.5, 1e-3) << x << " " << y;
      const bool leaves = there[0] < -1e-3 || there[0] > kWide + 1e-3 || there[1] < -1e-3 || there[1] > kHigh + 1e-3;
      outside += leaves;
      if (leaves) {
        ASSERT_EQ(at("flow.state", x, y), static_cast<float>(FlowState::outside));
      }
    }
  EXPECT_GT(outside, 0u);
}

// What is infinitely far away goes where the camera's turning takes it; without a way to turn it stays.
TEST(Flow, OfABackgroundIsTheCamerasTurning) {
  Shot shot = square_before_wall({0.5f, 0, 0});
  shot.meshes.erase(shot.meshes.begin());
  shot.world_from_camera = [](double time) -> std::array<Vec3d, 3> {
    const double a = 0.1 * time;
    return {Vec3d{std::cos(a), 0, -std::sin(a)}, {0, 1, 0}, {std::sin(a), 0, std::cos(a)}};
  };
  const Image image = flow(shot);
  const At at{image};
  const double focal = kHigh / 2.0 / std::tan(shot.projection.vfov / 2);
  ASSERT_TRUE(std::isinf(at("depth.Z", 0, 0)));
  for (const int x : {0, 3, kWide - 1}) {
    const double azimuth = std::atan((x + 0.5 - kWide / 2.0) / focal);
    EXPECT_NEAR(at("flow.u", x, 0), focal * (std::tan(azimuth + 0.1) - std::tan(azimuth)), 1e-3);
  }
}

// A card that turns its back, seen from its front alone: its points are hidden, though nothing lies before them.
TEST(Flow, OfAPointOnTheOtherSideIsHidden) {
  for (const bool both : {false, true}) {
    Shot shot = square_before_wall({});
    Mesh& card = shot.meshes[1];
    card.one_sided = !both;
    for (Vec3f& p : card.positions[1]) p.x = -p.x;  // through a line in the middle
    const Image image = flow(shot);
    EXPECT_EQ(At{image}("flow.state", kWide / 2 + 2, kHigh / 2),
              static_cast<float>(both ? FlowState::seen : FlowState::hidden));
  }
}

TEST(Flow, IsTheSameForAnyNumberOfThreadsAndWritesWhatReadersExpect) {
  const Shot shot = square_before_wall({0.5f, -0.25f, 0});
  FlowOptions options;
  options.threads = 1;
  Image image = flow(shot, options);
  options.threads = 3;
  const Image other = flow(shot, options);
  for (size_t c = 0; c < image.channels.size(); ++c) EXPECT_EQ(image.channels[c].values, other.channels[c].values);

  auto& state = image.channels[2].values;
  ASSERT_EQ(image.channels[2].name, "flow.state");
  state[1] = static_cast<float>(FlowState::unknown);
  image.channels[0].values[2] = 600;  // pixels: more than KITTI's codes reach
  const TempFolder folder;
  write_flow(image, folder.path("f.flo"));
  write_flow(image, folder.path("f.PNG"));
  write_occlusion(image, folder.path("o.png"));
  const auto bytes_of = [&](const std::string& name) {
    std::ifstream file(folder.path(name), std::ios::binary);
    return std::vector<uint8_t>{std::istreambuf_iterator<char>(file), {}};
  };
  const std::vector<uint8_t> flo = bytes_of("f.flo");
  ASSERT_EQ(flo.size(), 12u + 8u * kWide * kHigh);
  EXPECT_EQ(std::string(flo.begin(), flo.begin() + 4), "PIEH");
  EXPECT_EQ(flo[4], kWide);
  EXPECT_EQ(flo[8], kHigh);
  const auto number = [&](size_t at) {
    float value;
    std::memcpy(&value, &flo[at], sizeof value);
    return value;
  };
  const Pixels kitti = kPng.decode(bytes_of("f.PNG"), "f.PNG");
  const Pixels hidden = kPng.decode(bytes_of("o.png"), "o.png");
  ASSERT_EQ(kitti.wide_codes.size(), 4u * kWide * kHigh);
  for (size_t i = 0; i < state.size(); ++i) {
    const bool known = i != 1;
    const float u = image.channels[0].values[i], v = image.channels[1].values[i];
    EXPECT_EQ(number(12 + 8 * i), known ? u : 1e10f);
    EXPECT_EQ(number(16 + 8 * i), known ? v : 1e10f);
    const bool valid = known && u < 512;
    ASSERT_EQ(kitti.wide_codes[4 * i + 2], valid ? 1 : 0);
    if (valid) {
      EXPECT_NEAR((kitti.wide_codes[4 * i] - 32768.0) / 64, u, 1.0 / 128);
      EXPECT_NEAR((kitti.wide_codes[4 * i + 1] - 32768.0) / 64, v, 1.0 / 128);
    }
    EXPECT_EQ(hidden.codes[4 * i], state[i] == 1 ? 0 : 255);
  }
}

}  // namespace
}  // namespace kairos
