// Scenes of third parties, which are not part of the project: where they are, if they are there.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace kairos {

/// KAIROS_SCENES of the environment; empty without it.
inline std::filesystem::path scenes_folder() {
  const char* given = std::getenv("KAIROS_SCENES");
  return given != nullptr ? given : "";
}

}  // namespace kairos
