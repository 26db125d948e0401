#include "image/view_transform.h"

#include <algorithm>
#include <cmath>

namespace kairos {

namespace {

// How fast a colour pales while it gets brighter than the screen can show: by half where the shoulder has taken this
// much off its largest component.
constexpr double kHalfPale = 6;

Vec3d filmic(Vec3d colour) {
  const double peak = std::max({colour.x, colour.y, colour.z});
  if (!(peak > kShoulderBegin)) return colour;
  if (!std::isfinite(peak)) return {1, 1, 1};
  const double shown = filmic_shoulder(peak), lost = peak - shown;
  return lerp(colour * (shown / peak), Vec3d{shown, shown, shown}, lost / (lost + kHalfPale));
}

}  // namespace

double filmic_shoulder(double value) {
  if (!(value > kShoulderBegin)) return value;
  constexpr double kRoom = 1 - kShoulderBegin;
  return 1 - kRoom * kRoom / (value - kShoulderBegin + kRoom);
}

Vec3f seen_on_screen(Vec3f colour, ViewTransform view, double exposure) {
  const double scale = std::exp2(exposure);
  Vec3d seen;
  for (int i = 0; i < 3; ++i) seen[i] = colour[i] > 0 ? static_cast<double>(colour[i]) * scale : 0;
  if (view == ViewTransform::filmic) seen = filmic(seen);
  for (int i = 0; i < 3; ++i) seen[i] = std::min(seen[i], 1.0);
  return to_float(seen);
}

}  // namespace kairos
