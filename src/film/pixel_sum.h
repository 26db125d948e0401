// The reduction of a pixel's rays to one colour and its AOVs, for a box shutter: every instant counts alike.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "pixel/shaded_segment.h"

namespace kairos {

class PixelSum : public RaySink {
 public:
  /// count_meshes: also find out which mesh is seen most.
  PixelSum(Vec3f background, bool count_meshes) : background_(to_double(background)), count_meshes_(count_meshes) {}

  void add(const ShadedRay& ray) override;
  void clear();

  // Means over the rays; zero without any.
  Vec3f colour() const { return mean(colour_); }  ///< with the background in what is not covered
  Vec3f normal() const { return mean(normal_); }
  Vec3f albedo() const { return mean(albedo_); }
  float coverage() const { return rays_ == 0 ? 0 : static_cast<float>(covered_ / static_cast<double>(rays_)); }
  float visibility_segments() const;
  /// Nearest distance at any segment's ends; +infinity when nothing is seen.
  float depth() const { return depth_; }
  /// 1 + index of the mesh seen most (the lowest of equals), 0 for none.
  uint32_t mesh_id() const;

 private:
  Vec3f mean(Vec3d sum) const { return rays_ == 0 ? Vec3f{} : to_float(sum / static_cast<double>(rays_)); }

  Vec3d background_;
  bool count_meshes_;
  uint64_t rays_ = 0, visibility_segments_ = 0;
  Vec3d colour_, normal_, albedo_;
  double covered_ = 0;
  float depth_ = std::numeric_limits<float>::infinity();
  std::vector<std::pair<uint32_t, double>> mesh_weights_;  // in order of first sight
};

}  // namespace kairos
