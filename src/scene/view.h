// From where one looks while the shutter is open, and what a distance is in pixels from there.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <kairos/scene.h>

#include "scene/motion.h"
#include "scene/scene.h"

namespace kairos {

/// The stretch of scene time in which the shutter is open: open <= close, both finite. Where they are equal the picture
/// is a still frame: it shows what is there from that instant on, for all of the shutter's time.
struct ShutterWindow {
  double open = 0, close = 1;

  /// Does what a VertexMotion or a TransformMotion describes rest while the shutter is open?
  template <class Motion>
  bool holds_still(const Motion& motion) const {
    return open == close || motion.is_static(open, close);
  }

  double shutter_time(double scene_time) const { return (scene_time - open) / (close - open); }
  double scene_time(double time) const { return time >= 1 ? close : open + time * (close - open); }
};

/// A piece of the shutter without kinks inside: from just after its begin to just before its end.
struct Stretch {
  double begin = 0, end = 0;            ///< scene time, where motion is evaluated
  double time_begin = 0, time_end = 0;  ///< shutter time; the next stretch's time_begin is this one's time_end
};

/// Divides the window at `kinks` (ascending scene times inside of it). Kinks closer than a millionth of the window to
/// each other, or to the window's ends, count as one.
std::vector<Stretch> divide_at_kinks(const ShutterWindow& window, const std::vector<double>& kinks);

/// Both lists in one, ascending, without repeats.
std::vector<double> merge_kinks(const std::vector<double>& a, const std::vector<double>& b);

/// A camera during one opening of the shutter. Immutable; safe from many threads.
class View {
 public:
  /// Throws Error(bad_input) when the camera's placement cannot be inverted.
  View(const SceneCamera& camera, const Projection& projection, ShotOptions::Space space, const ShutterWindow& window);

  const ShutterWindow& window() const { return window_; }
  bool camera_moves() const { return camera_moves_; }
  /// Whether world space and the space that meshes are wanted in move relative to each other.
  bool space_moves() const { return camera_moves_ && space_ == ShotOptions::Space::camera; }
  /// Where space_from_world may have a corner or a jump: scene times inside the window.
  std::vector<double> space_kinks() const;

  /// To the space that the shot's meshes are wanted in.
  Mat4 space_from_world(double scene_time, Side side) const;
  /// From there to the camera's space.
  Mat4 camera_from_space(double scene_time, Side side) const;

  /// How far apart, in pixels, two points of camera space appear on screen; a little too far rather than too near. Off
  /// screen it is what it would be at the screen's corner. `near_dist` > 0: a point nearer than this is taken to be
  /// this far away, since next to the eye every distance is a large angle. Infinite when the points lie on opposite
  /// sides of the eye.
  double screen_distance(Vec3d truth, Vec3d approximation, double near_dist) const;

  /// Rotation camera -> world (columns) at a shutter time.
  std::function<std::array<Vec3d, 3>(double time)> world_from_camera() const;
  /// Origin of the space that meshes are wanted in, in the world, at a shutter time.
  std::function<Vec3d(double time)> camera_position() const;

 private:
  Mat4 camera_from_world(double scene_time, Side side) const;

  std::string name_;
  std::shared_ptr<const TransformMotion> motion_;
  ShotOptions::Space space_;
  ShutterWindow window_;
  bool camera_moves_ = false;
  Mat4 resting_;  ///< camera from world while the camera stands still
  bool orthographic_ = false;
  double pixels_per_unit_ = 1;  ///< per radian on the optical axis; orthographic: per world unit
  double obliquity_limit_ = 1;  ///< 1 / cos^2 of the angle to the screen's corner
};

}  // namespace kairos
