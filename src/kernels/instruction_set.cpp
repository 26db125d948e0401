#include <array>

#include "kernels/dispatch.h"

namespace kairos {

namespace {
constexpr std::array kAll{InstructionSet::scalar, InstructionSet::sse4, InstructionSet::avx2, InstructionSet::avx512};
constexpr std::array<std::string_view, kAll.size()> kNames{"scalar", "sse4", "avx2", "avx512"};
}  // namespace

std::string_view to_string(InstructionSet set) { return kNames[static_cast<size_t>(set)]; }

std::optional<InstructionSet> parse_instruction_set(std::string_view name) {
  for (InstructionSet set : kAll)
    if (to_string(set) == name) return set;
  return std::nullopt;
}

std::span<const InstructionSet> supported_instruction_sets() {
  static const std::span<const InstructionSet> supported = [] {
    size_t count = 0;
    while (count < kAll.size() && find_kernels(kAll[count]) != nullptr) ++count;
    return std::span(kAll).first(count);
  }();
  return supported;
}

}  // namespace kairos
