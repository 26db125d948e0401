#include "scene_io/pbrt/warnings.h"

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos::pbrt {

std::string Place::text() const { return fmt::format("{}:{}", file, line); }

void fail(const Place& place, const std::string& what) { throw Error(ErrorCode::bad_input, place.text(), what); }

void Warnings::add(const Place& place, const std::string& what) {
  if (strict_) fail(place, what);
  Entry& entry = entries_[what];
  if (entry.count++ == 0) {
    entry.place = place.text();
    order_.push_back(what);
  }
}

void Warnings::add_line(const std::string& line) {
  if (entries_[line].count++ == 0) order_.push_back(line);
}

std::vector<std::string> Warnings::lines() const {
  std::vector<std::string> result;
  for (const std::string& what : order_) {
    const Entry& entry = entries_.at(what);
    result.push_back(entry.place + (entry.place.empty() ? "" : ": ") + what +
                     (entry.count > 1 ? fmt::format(" ({} times)", entry.count) : ""));
  }
  return result;
}

}  // namespace kairos::pbrt
