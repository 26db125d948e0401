// Motion as a function of time: what files describe, before it is reduced to motion keys.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <kairos/vec.h>

#include "math/transform.h"

namespace kairos {

/// Which one-sided limit to take at an instant where motion jumps (glTF's STEP). Elsewhere both are the same.
enum class Side { before, after };

/// Vertices in a space of their own, which many meshes may share.
struct VertexShape {
  std::span<const Vec3f> positions;
  std::span<const Vec3f> normals;   ///< empty, or one per vertex
  std::span<const Vec4f> tangents;  ///< likewise
};

/// The true path of a mesh's vertices in world space, over all of the scene's time. Immutable; safe from many threads.
class VertexMotion {
 public:
  virtual ~VertexMotion() = default;

  virtual size_t vertex_count() const = 0;
  virtual bool has_normals() const = 0;

  /// True when the vertices are where they were all along [open, close]. May say false for a mesh that happens to rest.
  virtual bool is_static(double open, double close) const = 0;

  /// True when every vertex moves on a straight line at constant speed between neighbouring kinks: then keys at the
  /// kinks are exact.
  virtual bool is_linear_between_kinks() const = 0;

  /// Times strictly inside (open, close) where the path may have a corner or a jump; ascending, without repeats.
  virtual std::vector<double> kinks(double open, double close) const = 0;

  /// World-space positions at `time` (scene time; outside of its range motion holds still). A vertex the file got wrong
  /// may come out not finite.
  virtual void positions(double time, Side side, std::span<Vec3d> out) const = 0;

  /// Unit world-space normals; only when has_normals().
  virtual void normals(double time, Side side, std::span<Vec3f> out) const = 0;

  /// World-space tangents as Mesh::tangents has them; zero vectors where the surface has none.
  virtual bool has_tangents() const { return false; }
  virtual void tangents(double /*time*/, Side /*side*/, std::span<Vec4f> /*out*/) const {}

  /// The shape that a matrix places, where nothing else ever moves the vertices; null where they move on their own.
  virtual std::shared_ptr<const VertexShape> shape() const { return nullptr; }
  /// World from that shape's own space; only where there is one.
  virtual Mat4 placement(double /*time*/, Side /*side*/) const { return {}; }
  /// True where normals (and the handedness of tangents) are turned round when the matrix takes them along.
  virtual bool turns_normals() const { return false; }
};

/// A rigid (or at least affine) placement as a function of time.
class TransformMotion {
 public:
  virtual ~TransformMotion() = default;
  virtual bool is_static(double open, double close) const = 0;
  virtual std::vector<double> kinks(double open, double close) const = 0;
  virtual Mat4 at(double time, Side side) const = 0;  ///< world from local
};

}  // namespace kairos
