#include "shading/camera_axes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kairos {
namespace {

/// A camera that rolls by `turn` radians in a way that is not even.
Shot rolling(double turn) {
  Shot shot;
  shot.camera_moves = true;
  shot.world_from_camera = [turn](double time) {
    const double angle = turn * time * time * (3 - 2 * time);
    return std::array<Vec3d, 3>{Vec3d{std::cos(angle), std::sin(angle), 0}, Vec3d{-std::sin(angle), std::cos(angle), 0},
                                Vec3d{0, 0, 1}};
  };
  return shot;
}

TEST(CameraAxes, AreWhatTheShotSays) {
  for (const double turn : {0.001, 0.3, 6.0, 25.0}) {
    const Shot shot = rolling(turn);
    const CameraAxes axes(shot);
    for (int i = 0; i <= 10007; ++i) {
      const float time = static_cast<float>(i) / 10007;
      const auto want = shot.world_from_camera(static_cast<double>(time)), got = axes.at(time);
      for (size_t k = 0; k < 3; ++k) ASSERT_LE(length(got[k] - want[k]), 2 * CameraAxes::kError) << turn << " " << time;
    }
  }
}

TEST(CameraAxes, OfACameraThatStandsStillAreItsOwn) {
  Shot shot = rolling(1);
  shot.camera_moves = false;
  EXPECT_EQ(CameraAxes(shot).at(0.7f)[0].x, 1);
  EXPECT_EQ(CameraAxes(Shot{}).at(0.7f)[2].z, 1);
}

}  // namespace
}  // namespace kairos
