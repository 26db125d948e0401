// Where and by what a study was made.
#pragma once

#include <string>

namespace kairos::study {

struct Machine {
  std::string processor;        ///< as the system names it
  int cores = 0;                ///< that threads can run on
  std::string instruction_set;  ///< the best that the kernels use
  std::string compiler;         ///< that built this library
  std::string version, commit;  ///< of this library; commit: "unknown" where it was not built from git
};

Machine this_machine();

}  // namespace kairos::study
