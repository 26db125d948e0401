// What a text file says that Kairos leaves out, each thing said once.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kairos {

/// Where in which file.
struct FilePlace {
  std::string file;
  size_t line = 0;  ///< 0: the file as a whole
  std::string text() const;
};

/// Throws Error(bad_input) at `place`.
[[noreturn]] void fail_at(const FilePlace& place, const std::string& what);

class FileWarnings {
 public:
  explicit FileWarnings(bool strict) : strict_(strict) {}

  /// Lists `what` at its first place, with the number of times it came. With `strict`, throws Error(bad_input) instead.
  void add(const FilePlace& place, const std::string& what);
  /// A line that says itself where, from a reader that has dealt with `strict`.
  void add_line(const std::string& line);
  std::vector<std::string> lines() const;

 private:
  struct Entry {
    std::string place;
    uint64_t count = 0;
  };
  bool strict_;
  std::map<std::string, Entry> entries_;
  std::vector<std::string> order_;
};

}  // namespace kairos
