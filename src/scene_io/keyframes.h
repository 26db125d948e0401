// Motion given by key frames: linear between keys, at rest before the first and after the last.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "scene/motion.h"

namespace kairos {

struct VertexKeys {
  std::vector<double> times;                  ///< [key] scene time, strictly ascending
  std::vector<std::vector<Vec3f>> positions;  ///< [key][vertex], at least one key
  std::vector<std::vector<Vec3f>> normals;    ///< empty, or [key][vertex]; unit
};

struct TransformKeys {
  std::vector<double> times;   ///< [key] scene time, strictly ascending
  std::vector<Mat4> matrices;  ///< [key] world from mesh, affine; none: the identity

  Mat4 at(double time) const;
  bool rests(double open, double close) const;
  bool always_rests() const;
  bool mirrors() const;  ///< at its first key
};

/// Vertices move linearly between their keys, in the mesh's own space; each entry of the matrix that places the mesh
/// goes linearly between the transform's keys.
///
/// A transform that mirrors (negative determinant at its first key) would turn the mesh inside out. As in glTF it does
/// not: whoever makes the mesh reverses its triangles where mirrors() is true, and normals point to that same side.
class KeyframeMotion final : public VertexMotion {
 public:
  explicit KeyframeMotion(VertexKeys vertices, TransformKeys transform = {})
      : KeyframeMotion(std::make_shared<const VertexKeys>(std::move(vertices)), std::move(transform)) {}
  /// Of vertices that others have, too.
  KeyframeMotion(std::shared_ptr<const VertexKeys> vertices, TransformKeys transform);

  size_t vertex_count() const override { return vertices_->positions.front().size(); }
  bool has_normals() const override { return !vertices_->normals.empty(); }
  bool is_static(double open, double close) const override;
  bool is_linear_between_kinks() const override;
  std::vector<double> kinks(double open, double close) const override;
  void positions(double time, Side side, std::span<Vec3d> out) const override;
  void normals(double time, Side side, std::span<Vec3f> out) const override;
  std::shared_ptr<const VertexShape> shape() const override;
  Mat4 placement(double time, Side side) const override;
  bool turns_normals() const override { return mirrors_; }

  bool mirrors() const { return mirrors_; }

 private:
  std::shared_ptr<const VertexKeys> vertices_;
  TransformKeys transform_;
  bool mirrors_ = false;
};

struct LookAtKey {
  double time = 0;
  Vec3d eye, target, up;
  friend bool operator==(const LookAtKey&, const LookAtKey&) = default;
};

/// A camera whose eye, target and up go linearly from key to key; at each instant it looks from eye at target.
class LookAtMotion final : public TransformMotion {
 public:
  /// At least one key; strictly ascending times. Throws Error(bad_input, place) where at some instant there is no
  /// direction: eye and target meet, or up is along it.
  LookAtMotion(std::vector<LookAtKey> keys, const std::string& place);

  bool is_static(double open, double close) const override;
  std::vector<double> kinks(double open, double close) const override;
  Mat4 at(double time, Side side) const override;

 private:
  std::vector<LookAtKey> keys_;
  std::vector<double> times_;
};

}  // namespace kairos
