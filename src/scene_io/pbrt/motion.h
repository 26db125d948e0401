// Transforms that go from one matrix to another while time passes, as pbrt has it, and what they move.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "math/transform.h"
#include "scene/motion.h"
#include "scene_io/mesh_data.h"

namespace kairos::pbrt {

/// An affine matrix as translation * rotation * stretch: M. Shoemake and T. Duff, "Matrix Animation and Polar
/// Decomposition" (1992). A matrix that mirrors has a stretch that does; a singular one may come out not finite.
struct Decomposed {
  Vec3d translation;
  Quaternion rotation;
  Mat4 stretch;  ///< upper 3x3

  Decomposed() = default;
  explicit Decomposed(const Mat4& matrix);
};

/// The matrix `start` until `start_time`, `end` from `end_time` on; between them translation and stretch go linearly,
/// the rotation along the shortest arc.
class AnimatedTransform {
 public:
  explicit AnimatedTransform(const Mat4& at_rest) : start_(at_rest), end_(at_rest) {}
  /// start_time <= end_time; equal ones are a jump.
  AnimatedTransform(const Mat4& start, const Mat4& end, std::array<double, 2> times);

  bool moves() const { return parts_ != nullptr; }
  bool is_static(double open, double close) const;
  /// Every entry of the matrix changes linearly between the kinks: nothing turns.
  bool is_linear() const { return !moves() || same_rotation_; }
  void add_kinks(double open, double close, std::vector<double>& kinks) const;
  Mat4 at(double time, Side side) const;
  const Mat4& start() const { return start_; }

 private:
  Mat4 start_, end_;
  std::array<double, 2> times_{0, 1};
  std::shared_ptr<const std::array<Decomposed, 2>> parts_;  ///< null: at rest
  bool same_rotation_ = false;
};

/// Transforms one within the other, as instances have them: the first is the outermost. Neighbours at rest are one.
class TransformPath {
 public:
  TransformPath() = default;
  explicit TransformPath(AnimatedTransform step) : steps_{std::move(step)} {}

  /// This path, with `inner` inside.
  TransformPath then(const TransformPath& inner) const;

  bool is_static(double open, double close) const;
  bool is_linear() const;
  std::vector<double> kinks(double open, double close) const;
  Mat4 at(double time, Side side) const;

 private:
  std::vector<AnimatedTransform> steps_;
};

/// The vertices of a shape, shared by all of its instances.
struct Vertices {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< empty, or one per vertex
};

class InstanceMotion final : public VertexMotion {
 public:
  /// With `reversed`, normals point to the other side.
  InstanceMotion(std::shared_ptr<const Vertices> vertices, TransformPath path, bool reversed);

  size_t vertex_count() const override { return vertices_->positions.size(); }
  bool has_normals() const override { return !vertices_->normals.empty(); }
  bool is_static(double open, double close) const override { return path_.is_static(open, close); }
  bool is_linear_between_kinks() const override { return path_.is_linear(); }
  std::vector<double> kinks(double open, double close) const override { return path_.kinks(open, close); }
  void positions(double time, Side side, std::span<Vec3d> out) const override;
  void normals(double time, Side side, std::span<Vec3f> out) const override;
  std::shared_ptr<const VertexShape> shape() const override {
    return std::make_shared<const VertexShape>(VertexShape{vertices_->positions, vertices_->normals, {}});
  }
  Mat4 placement(double time, Side side) const override { return path_.at(time, side); }
  bool turns_normals() const override { return mirrors_ != reversed_; }

  bool mirrors() const { return mirrors_; }  ///< at the path's start, by its determinant

 private:
  std::shared_ptr<const Vertices> vertices_;
  TransformPath path_;
  bool mirrors_, reversed_;
};

/// A camera, from one that looks along +z to ours that looks along -z, without scale.
class CameraMotion final : public TransformMotion {
 public:
  explicit CameraMotion(TransformPath world_from_camera) : path_(std::move(world_from_camera)) {}
  bool is_static(double open, double close) const override { return path_.is_static(open, close); }
  std::vector<double> kinks(double open, double close) const override { return path_.kinks(open, close); }
  Mat4 at(double time, Side side) const override;

 private:
  TransformPath path_;
};

/// A light.
class LightMotion final : public TransformMotion {
 public:
  explicit LightMotion(TransformPath world_from_light) : path_(std::move(world_from_light)) {}
  bool is_static(double open, double close) const override { return path_.is_static(open, close); }
  std::vector<double> kinks(double open, double close) const override { return path_.kinks(open, close); }
  Mat4 at(double time, Side side) const override { return path_.at(time, side); }

 private:
  TransformPath path_;
};

}  // namespace kairos::pbrt
