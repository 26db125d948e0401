#include "scene_io/gltf/warnings.h"

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos::gltf {

void Warnings::add(const std::string& where, const std::string& what, uint64_t count) {
  constexpr size_t kMostKinds = 200;
  if (strict_) throw Error(ErrorCode::bad_input, file_ + (where.empty() ? "" : ": " + where), what);
  if (order_.size() >= kMostKinds && !entries_.count(what)) {
    unnamed_ += count;
    return;
  }
  Entry& entry = entries_[what];
  if (entry.count == 0) {
    entry.where = where;
    order_.push_back(what);
  }
  entry.count += count;
}

std::vector<std::string> Warnings::lines() const {
  std::vector<std::string> result;
  for (const std::string& what : order_) {
    const Entry& entry = entries_.at(what);
    result.push_back(fmt::format("{}: {}{}{}", file_, entry.where, entry.where.empty() ? "" : ": ", what) +
                     (entry.count > 1 ? fmt::format(" ({} times)", entry.count) : ""));
  }
  if (unnamed_ > 0) result.push_back(fmt::format("{}: {} warnings of further kinds are not shown", file_, unnamed_));
  return result;
}

}  // namespace kairos::gltf
