// Which lights a shot gets: those of its scene, an environment that was asked for, the studio.
#pragma once

#include "base/memory_budget.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace kairos {

/// Fills the shot's lights, their pictures and motions, and says in its notes what is not the scene's own. The shot has
/// its meshes and materials already. camera: from where the view looks. budget: of the
/// scene's pictures. Throws Error for an environment that cannot be
/// used.
void light_shot(Shot& shot, const Scene& scene, const ShotOptions& options, const SceneCamera& camera, const View& view,
                MemoryBudget& budget);

}  // namespace kairos
