// What animations a scene's files hold, and when they run.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/scene.h>

namespace kairos {

struct SceneAnimation {
  std::string name;
  std::optional<std::array<double, 2>> range;  ///< begin, end in scene time, where the file says so
  bool plays = false;                          ///< see LoadOptions::animation
};

/// Those that the files hold, played or not, in their order: as many as SceneContents::animations names.
KAIROS_API std::vector<SceneAnimation> animations(const Scene& scene);

}  // namespace kairos
