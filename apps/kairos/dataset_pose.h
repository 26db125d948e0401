// Where a camera is and how it moves, as data sets say it.
#pragma once

#include <array>
#include <string>

#include <nlohmann/json.hpp>

#include <kairos/scene.h>

namespace kairos::cli {

/// w, x, y, z of the rotation from the camera to the world, and the camera's place, at a scene time. The camera looks
/// along -z, and y is up.
std::array<double, 7> pose_at(const Shot& shot, double scene_time);

/// Rows of the matrix that takes points of the camera's space to the world.
nlohmann::ordered_json pose_matrix(const Shot& shot, double scene_time);

/// Mean velocities between two scene times, in the camera's axes at a third one: per unit of scene time.
struct CameraVelocity {
  Vec3d linear, angular;  ///< angular: radians, along the axis about which it turns counter-clockwise
};
CameraVelocity velocity_between(const Shot& shot, double from, double to, double axes_at);

nlohmann::ordered_json intrinsics_of(const Projection& projection);

}  // namespace kairos::cli
