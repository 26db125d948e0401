#include "scene_io/file_warnings.h"

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos {

std::string FilePlace::text() const { return line == 0 ? file : fmt::format("{}:{}", file, line); }

void fail_at(const FilePlace& place, const std::string& what) { throw Error(ErrorCode::bad_input, place.text(), what); }

void FileWarnings::add(const FilePlace& place, const std::string& what) {
  if (strict_) fail_at(place, what);
  constexpr size_t kMostKinds = 256;
  const bool known = order_.size() < kMostKinds || entries_.count(what) > 0;
  if (!known) return add_line("further warnings are not shown");
  Entry& entry = entries_[what];
  if (entry.count++ == 0) {
    entry.place = place.text();
    order_.push_back(what);
  }
}

void FileWarnings::add_line(const std::string& line) {
  if (entries_[line].count++ == 0) order_.push_back(line);
}

std::vector<std::string> FileWarnings::lines() const {
  std::vector<std::string> result;
  for (const std::string& what : order_) {
    const Entry& entry = entries_.at(what);
    result.push_back(entry.place + (entry.place.empty() ? "" : ": ") + what +
                     (entry.count > 1 ? fmt::format(" ({} times)", entry.count) : ""));
  }
  return result;
}

}  // namespace kairos
