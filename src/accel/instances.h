// Trees of instances, whose objects have trees of their own.
#pragma once

#include <functional>
#include <span>

#include <kairos/mesh.h>

#include "accel/layout.h"

namespace kairos {

/// Sets accel.objects and both trees of instances. build_object(mesh, tree): makes the tree of one object. Meshes that
/// are no instances are passed over, and still instances, too, where only moving meshes are asked for.
void build_instances(std::span<const Mesh> meshes, bool moving_meshes_only,
                     const std::function<void(const Mesh& object, StillTree& tree)>& build_object, Accel& accel);

}  // namespace kairos
