#include "study/machine.h"

#include <fstream>
#include <thread>

#include <kairos/tracer.h>
#include <kairos/version.h>

#include "commit.h"

namespace kairos::study {

namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
      return line.substr(line.find(": ") + 2);
  return "unknown";
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown";
#endif
}

}  // namespace

Machine this_machine() {
  return {processor(),
          static_cast<int>(std::thread::hardware_concurrency()),
          std::string(to_string(supported_instruction_sets().back())),
          compiler(),
          version(),
          KAIROS_COMMIT};
}

}  // namespace kairos::study
