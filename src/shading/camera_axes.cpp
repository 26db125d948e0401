#include "shading/camera_axes.h"

#include <algorithm>
#include <cmath>

namespace kairos {

CameraAxes::CameraAxes(const Shot& shot) {
  if (!shot.world_from_camera) {
    table_ = {{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}};
    return;
  }
  table_.push_back(shot.world_from_camera(0));
  if (!shot.camera_moves) return;
  table_.push_back(shot.world_from_camera(1));
  for (bool precise = false; !precise && table_.size() - 1 < kMostSteps;) {
    const size_t steps = table_.size() - 1;
    std::vector<std::array<Vec3d, 3>> finer{table_[0]};
    precise = steps >= 16;  // a motion to and fro may look straight from afar
    for (size_t i = 0; i < steps; ++i) {
      const double middle = (static_cast<double>(i) + 0.5) / static_cast<double>(steps);
      finer.push_back(shot.world_from_camera(middle));
      for (size_t k = 0; k < 3; ++k) {
        const Vec3d off = finer.back()[k] - lerp(table_[i][k], table_[i + 1][k], 0.5);
        precise = precise && std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= kError;
      }
      finer.push_back(table_[i + 1]);
    }
    table_ = std::move(finer);
  }
}

}  // namespace kairos
