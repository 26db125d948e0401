// An instance as Embree has it: a scene that it places.
#pragma once

#include <vector>

#include <embree3/rtcore.h>

#include <kairos/mesh.h>

#include "discrete/uniform_runs.h"

namespace kairos {

/// Where an instance is during a run of evenly spaced keys. Embree interpolates the maps entry by entry, so that
/// vertices go straight.
class PlacedObject {
 public:
  /// Nothing is placed: for what is no instance.
  PlacedObject() = default;
  /// mesh: an instance. parts: pieces that each key span of the run is cut into.
  PlacedObject(const Mesh& mesh, UniformRun run, size_t parts);

  /// Into a geometry of the type RTC_GEOMETRY_TYPE_INSTANCE.
  void fill(RTCGeometry geometry, RTCScene object) const;
  size_t steps() const { return maps_.size(); }
  size_t memory_bytes() const { return maps_.capacity() * sizeof(AffineMap); }

  /// A normal of the object's (or, of what is no instance, the normal itself), of any length, as it is at a time of the
  /// run, 0 to 1: on the side on which the vertices run counter-clockwise.
  Vec3f normal(Vec3f of_object, float time) const;

 private:
  std::vector<AffineMap> maps_;  // [step]
};

}  // namespace kairos
