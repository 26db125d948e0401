// Emissive triangles as lights: chosen by what they are worth at a point, sampled by solid angle.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <kairos/record.h>
#include <kairos/scene.h>

#include "shading/light_tree.h"
#include "shading/looks.h"
#include "shading/surface.h"

namespace kairos {

/// Light that a place on an emissive triangle sends to a point, if nothing is in between.
struct AreaSample {
  Vec3d direction;  ///< unit, towards the light, in the shot's space
  double dist = 0;
  Vec3f radiance;
  double density = 0;  ///< per steradian: of being chosen
  bool is_met = true;  ///< rays in this direction meet it
};

/// Meshes whose emission is the same all over light others; those with an emission texture only glow. Reads the shot
/// and the looks, which must outlive it. Safe to use from many threads at once.
/// docs/method.md, "Lights by their worth".
class AreaLights {
 public:
  AreaLights(const Shot& shot, const Looks& looks);

  bool empty() const { return triangles_.empty(); }
  /// Do they stand still in the shot's space?
  bool rest() const {
    return std::none_of(triangles_.begin(), triangles_.end(), [](const LightTriangle& light) { return light.moves; });
  }

  /// The lights as a point sees them at an instant. For one shading sample, on the stack.
  class View {
   public:
    /// normal: of the surface, unit: what lies behind it is worth nothing.
    View(const AreaLights& lights, Vec3d point, Vec3d normal, float time)
        : lights_(lights), point_(point), normal_(normal), time_(time) {}

    /// A place on all of them: radiance x solid angle decide which, then all directions to it are as likely, up to its
    /// size at kSmall steradians by area. sample: uniform in [0, 1)^3. Nothing where no light can arrive, or chance
    /// hits on what is not there.
    std::optional<AreaSample> sample(const std::array<float, 3>& sample);

    /// What a ray from the point brings that meets a triangle in this direction: nothing if it is no light of this
    /// kind, or one that sample() finds although rays do not meet it.
    std::optional<AreaSample> met(uint32_t mesh, uint32_t triangle, Vec3d direction, double dist);

    /// Is a triangle of the mesh one of these lights, so that its light is found by sample()?
    bool holds(uint32_t mesh) const { return lights_.first_of(mesh) != lights_.first_.end(); }

   private:
    friend class AreaLights;
    static constexpr size_t kMostInLeaf = 64;

    /// Fills worth_ for a leaf.
    void weigh(const LightTree::Leaf& leaf);
    /// A light's corners relative to the point.
    std::array<Vec3d, 3> corners_of(uint32_t place);
    double density(uint32_t place, const std::array<Vec3d, 3>& corners, double solid, Vec3d direction) const;
    Vec3f radiance(uint32_t place, const std::array<Vec3d, 3>& corners, Vec3d direction,
                   const std::array<Vec3d, 3>& vertices) const;

    const AreaLights& lights_;
    Vec3d point_, normal_;
    float time_;
    LightTree::Leaf leaf_;
    double sum_ = 0;
    std::array<double, kMostInLeaf> worth_;
    uint32_t mesh_ = kNoMesh;  // of which key_ is the place between its keys
    KeyPosition key_;
  };

  /// Below this many steradians a triangle is sampled by its area, which is nearly the same there, and quicker.
  static constexpr double kSmall = 2e-3;

 private:
  struct LightTriangle {
    uint32_t mesh = 0, triangle = 0;
    float brightness = 0;  // luminance of its emission
    bool front_only = false;
    bool is_met = true;
    bool moves = false;
    std::array<Vec3d, 3> vertices;  // of one that stands still
  };

  /// Where a mesh is in first_; its end for one that emits nothing of this kind.
  std::vector<std::pair<uint32_t, size_t>>::const_iterator first_of(uint32_t mesh) const;

  /// How much of a triangle is there, 0 to 1, at the point with these weights.
  float presence(const LightTriangle& light, const std::array<Vec3d, 3>& vertices,
                 const std::array<float, 3>& weights) const;

  const Shot& shot_;
  const Looks& looks_;
  LightTree tree_;
  std::vector<LightTriangle> triangles_;            // in the order of the tree
  std::vector<std::pair<uint32_t, size_t>> first_;  // by mesh: where in place_ its triangles begin
  std::vector<uint32_t> place_;                     // [triangle of an emissive mesh]: in triangles_
};

}  // namespace kairos
