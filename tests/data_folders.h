// Data that is not part of the project: where it is, if it is there.
#pragma once

#include <cstdlib>
#include <string>

namespace kairos {

/// `variable` of the environment, else `name` in the folder beside the project that shared data is kept in.
inline std::string data_folder(const char* variable, const std::string& name) {
  const char* given = std::getenv(variable);
  return given && *given ? given : std::string(KAIROS_SOURCE_DIR) + "/../shared/" + name;
}
inline std::string scenes_folder() { return data_folder("KAIROS_SCENES", "scenes"); }
inline std::string oracle_folder() { return data_folder("KAIROS_ORACLE", "oracle"); }

}  // namespace kairos
