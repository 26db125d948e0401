// Motion that is carried about by a transform with key frames.
#pragma once

#include <memory>

#include "scene_io/keyframes.h"

namespace kairos {

/// What `inner` does, placed by a transform. Whoever makes the mesh reverses its triangles where the transform
/// mirrors(), as for KeyframeMotion.
class PlacedMotion final : public VertexMotion {
 public:
  PlacedMotion(std::shared_ptr<const VertexMotion> inner, TransformKeys transform);

  size_t vertex_count() const override { return inner_->vertex_count(); }
  bool has_normals() const override { return inner_->has_normals(); }
  bool is_static(double open, double close) const override;
  bool is_linear_between_kinks() const override;
  std::vector<double> kinks(double open, double close) const override;
  void positions(double time, Side side, std::span<Vec3d> out) const override;
  void normals(double time, Side side, std::span<Vec3f> out) const override;
  bool has_tangents() const override { return inner_->has_tangents(); }
  void tangents(double time, Side side, std::span<Vec4f> out) const override;
  std::shared_ptr<const VertexShape> shape() const override { return inner_->shape(); }
  Mat4 placement(double time, Side side) const override;
  bool turns_normals() const override { return inner_->turns_normals() != transform_.mirrors(); }

 private:
  std::shared_ptr<const VertexMotion> inner_;
  TransformKeys transform_;
};

}  // namespace kairos
