// What a scene may grow into, by what its files hold.
#pragma once

#include <cstdint>
#include <string>

namespace kairos {

/// One account for all that reading a scene allocates: what is unpacked, repeated, subdivided, evaluated, decoded.
/// Files may grow a lot, but not without limit. Not for several threads at once.
class MemoryBudget {
 public:
  static constexpr uint64_t kPerFileByte = 1024;

  /// base: bytes that are granted whatever the files hold; see LoadOptions::memory_budget.
  explicit MemoryBudget(uint64_t base) : base_(base), left_(base) {}

  /// Grants what a file of so many bytes may grow into.
  void add_file(uint64_t bytes);

  /// False, and nothing is taken, where there is not so much left.
  bool take(uint64_t bytes);

  /// Takes it, before it is allocated. Throws Error(bad_input, place) where there is not so much left.
  void charge(uint64_t bytes, const std::string& place);

  uint64_t base() const { return base_; }
  uint64_t left() const { return left_; }

 private:
  uint64_t base_, left_;
};

/// "12 MB".
std::string megabytes_text(uint64_t bytes);

}  // namespace kairos
