// Which motion keys a mesh needs so that linear motion between them stays on its vertices' true paths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/motion.h"
#include "scene/view.h"

namespace kairos {

/// No stretch between kinks gets spans shorter than this part of the shutter.
inline constexpr int kMaxKeySpans = 4096;
/// More keys than any mesh has.
inline constexpr uint64_t kMostKeys = uint64_t{1} << 40;

struct MotionKeys {
  std::vector<float> times;                   ///< [key], shutter time: 0 to 1, equal neighbours are a jump
  std::vector<double> scene_times;            ///< [key]
  std::vector<Side> sides;                    ///< [key]: the side on which the key's positions were taken
  std::vector<std::vector<Vec3f>> positions;  ///< [key][vertex] in the view's space
  double excess = 0;  ///< pixels by which vertices still leave their paths, where kMaxKeySpans was not enough; else 0
};

/// Keys at the shutter's ends, at every kink (two where the path jumps) and, between kinks, at 2^k + 1 even times with
/// the smallest k for which no vertex leaves its path by more than `tolerance` pixels. One key, if nothing moves in the
/// view's space. Positions of vertices that are not finite are kept so; they do not count.
///
/// The same k in every stretch between kinks keeps the number of distinct sets of key times over all meshes small: the
/// accelerator builds one tree for each. At most `most_keys`, where that leaves the kinks; throws Error(bad_input) with
/// `place` where it does not.
MotionKeys choose_motion_keys(const VertexMotion& motion, const View& view, double tolerance, const std::string& place,
                              uint64_t most_keys = kMostKeys);

/// Positions of one mesh in a view's space; the world positions of one that rests in the world are kept.
class PathSampler {
 public:
  PathSampler(const VertexMotion& motion, const View& view);

  void positions(double scene_time, Side side, std::vector<Vec3d>& out) const;

 private:
  const VertexMotion& motion_;
  const View& view_;
  std::vector<Vec3d> resting_;  ///< empty when the mesh moves in the world
};

}  // namespace kairos
