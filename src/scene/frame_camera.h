// The camera of a scene that has none.
#pragma once

#include "scene/scene.h"
#include "scene/view.h"

namespace kairos {

/// A still perspective camera, in front of, right of and a little above the scene, from which every triangle is on
/// screen while the shutter is open, with about a twentieth of the picture left free around them.
SceneCamera frame_scene(const Scene& scene, const Projection& projection, const ShutterWindow& window);

}  // namespace kairos
