// What pixels want to know of light, gathered to be answered together.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <kairos/record.h>

#include "shading/lit_shading.h"

namespace kairos {

/// Of several pixels, what their rays ask of lit surfaces, and which knots of their records wait for the answers: these
/// hold what else is to be added to them. One thread's memory.
class LookUps {
 public:
  struct Link {
    uint32_t knot, query;
  };

  void clear() {
    queries_.clear();
    links_.clear();
    linked_ = 0;
  }
  uint32_t count() const { return static_cast<uint32_t>(queries_.size()); }
  /// Returns the query's number.
  uint32_t add(const ShadingQuery& query) {
    queries_.push_back(query);
    return count() - 1;
  }
  /// knot: of the pixel's record; none that is before those that were linked already.
  void link(uint32_t knot, uint32_t query) { links_.push_back({knot, query}); }
  /// first_knot: of the pixel's knots, among those of all pixels, by which they are counted from now on.
  void end_pixel(uint32_t first_knot) {
    for (; linked_ < links_.size(); ++linked_) links_[linked_].knot += first_knot;
  }

  /// Of a pixel that has not ended, what a knot waits for; nothing if it does not.
  std::optional<uint32_t> awaited_by(uint32_t knot) const {
    const auto from = links_.begin() + static_cast<std::ptrdiff_t>(linked_);
    const auto at = std::lower_bound(from, links_.end(), knot, [](const Link& a, uint32_t b) { return a.knot < b; });
    return at != links_.end() && at->knot == knot ? std::optional(at->query) : std::nullopt;
  }

  std::span<ShadingQuery> queries() { return queries_; }
  std::span<const ShadingQuery> queries() const { return queries_; }
  std::span<const Link> links() const { return links_; }

 private:
  std::vector<ShadingQuery> queries_;
  std::vector<Link> links_;
  size_t linked_ = 0;
};

}  // namespace kairos
