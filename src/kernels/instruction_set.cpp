#include <array>
#include <vector>

#include "kernels/dispatch.h"

namespace kairos {

namespace {
constexpr std::array kAll{InstructionSet::scalar, InstructionSet::sse4, InstructionSet::avx2, InstructionSet::avx512,
                          InstructionSet::neon};
constexpr std::array<std::string_view, kAll.size()> kNames{"scalar", "sse4", "avx2", "avx512", "neon"};
}  // namespace

std::string_view to_string(InstructionSet set) { return kNames[static_cast<size_t>(set)]; }

std::optional<InstructionSet> parse_instruction_set(std::string_view name) {
  for (InstructionSet set : kAll)
    if (to_string(set) == name) return set;
  return std::nullopt;
}

std::span<const InstructionSet> supported_instruction_sets() {
  static const std::vector<InstructionSet> supported = [] {
    std::vector<InstructionSet> found;
    for (const InstructionSet set : kAll)
      if (find_kernels(set) != nullptr) found.push_back(set);
    return found;
  }();
  return supported;
}

}  // namespace kairos
