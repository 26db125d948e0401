// Where surfaces are missing because their alpha is below the cut-off, and how much of what is behind them they hide
// where it is blended.
#pragma once

#include <memory>
#include <vector>

#include <kairos/tracer.h>

#include "camera/pixel_cone.h"
#include "shading/looks.h"

namespace kairos {

/// Reads the shot and the looks, which must outlive it. Safe to use from many threads at once.
class AlphaCutOuts : public CutOuts {
 public:
  AlphaCutOuts(const Shot& shot, const Looks& looks);

  bool any() const { return any_; }  ///< is anything in the scene cut out or blended?

  bool has(uint32_t mesh) const override { return kinds_[mesh] != Kind::whole; }
  bool is_blended(uint32_t mesh) const override { return kinds_[mesh] == Kind::blended; }
  /// How much of what is behind a blended surface it hides, 0 to 1, where the ray meets the triangle at `time`.
  float opacity(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;
  /// Of a blended surface: the chance is a hash of ray, time, mesh and triangle. Every sample's ray is another one.
  bool solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const override;
  /// Looks along the path of the hit point over the picture, twice per texel, or 16 times where vertices have an alpha
  /// of their own, and finds each crossing of the cut-off
  /// by bisection to 1e-4 of the shutter.
  void solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const override;

 private:
  enum class Kind : uint8_t { whole, cut_out, blended };
  Kind kind_of(uint32_t mesh) const;
  AlphaPoint at(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const;

  const Shot& shot_;
  const Looks& looks_;
  PixelCone cone_;
  std::vector<Kind> kinds_;  // [mesh]
  bool any_ = false;
};

}  // namespace kairos
