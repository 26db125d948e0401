// Where a camera is and how it moves, as data sets of frames say it.
#pragma once

#include <nlohmann/json.hpp>

#include <kairos/camera_pose.h>

namespace kairos::cli {

/// Mean velocities between two scene times, in the camera's axes at a third one: per unit of scene time. The camera
/// looks along -z, and y is up.
struct CameraVelocity {
  Vec3d linear, angular;  ///< angular: radians, along the axis about which it turns counter-clockwise
};
CameraVelocity velocity_between(const Shot& shot, double from, double to, double axes_at);

nlohmann::ordered_json intrinsics_of(const Projection& projection);

}  // namespace kairos::cli
