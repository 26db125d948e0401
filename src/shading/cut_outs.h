// Where surfaces are missing because their alpha is below the cut-off.
#pragma once

#include <memory>
#include <vector>

#include <kairos/tracer.h>

#include "shading/looks.h"
#include "shading/pixel_cone.h"

namespace kairos {

/// Reads the shot and the looks, which must outlive it. Safe to use from many threads at once.
class AlphaCutOuts : public CutOuts {
 public:
  AlphaCutOuts(const Shot& shot, const Looks& looks);

  bool any() const { return any_; }  ///< is anything in the scene cut out?

  bool has(uint32_t mesh) const override { return has_[mesh]; }
  bool solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const override;
  /// Looks along the path of the hit point over the picture, twice per texel, and finds each crossing of the cut-off
  /// by bisection to 1e-4 of the shutter.
  void solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const override;

 private:
  AlphaPoint at(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;

  const Shot& shot_;
  const Looks& looks_;
  PixelCone cone_;
  std::vector<bool> has_;  // [mesh]
  bool any_ = false;
};

}  // namespace kairos
