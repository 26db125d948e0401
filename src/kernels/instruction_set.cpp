#include <vector>

#include <kairos/names.h>

#include "kernels/dispatch.h"

namespace kairos {

std::string_view to_string(InstructionSet set) { return to_string<InstructionSet>(set); }

std::span<const InstructionSet> supported_instruction_sets() {
  static const std::vector<InstructionSet> supported = [] {
    std::vector<InstructionSet> found;
    for (const auto& [name, set] : kNames<InstructionSet>)
      if (find_kernels(set) != nullptr) found.push_back(set);
    return found;
  }();
  return supported;
}

}  // namespace kairos
