// Where a shot's camera is and what it sees, as data sets say it.
#pragma once

#include <array>
#include <optional>

#include <kairos/export.h>
#include <kairos/scene.h>

namespace kairos {

/// How a camera's own axes lie; x points right.
enum class CameraAxis {
  minus_z,  ///< it looks along -z, and y is up
  plus_z,   ///< it looks along z, and y is down
};

/// w, x, y, z of the rotation from the camera to the world, and the camera's place in the scene's units, at a scene
/// time within the shot's. The sign of a rotation's quaternion is such that its largest component is positive.
KAIROS_API std::array<double, 7> camera_pose(const Shot& shot, double scene_time, CameraAxis axis);

/// Rows of the matrix that takes points of the camera's space to the world.
KAIROS_API std::array<std::array<double, 4>, 4> camera_matrix(const Shot& shot, double scene_time, CameraAxis axis);

/// Pixels. x of the leftmost pixel goes from 0 to 1: where whole numbers are pixels' middles, cx and cy are less by a
/// half.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};
/// Unset where a camera has none: orthographic ones, and those that are given by a matrix.
KAIROS_API std::optional<Intrinsics> intrinsics(const Projection& projection);

}  // namespace kairos
