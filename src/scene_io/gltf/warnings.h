// What a glTF file holds and is not read, or is taken otherwise.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kairos::gltf {

/// Collects warnings so that what happens a thousand times is said once. With `strict` a warning is an Error instead.
class Warnings {
 public:
  Warnings(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  /// `what` is said once, with the place where it was met first and, where it makes sense, how many there were in all.
  /// An empty place stands for the file.
  void add(const std::string& where, const std::string& what, uint64_t count = 1);
  /// One line each; of very many, the first.
  std::vector<std::string> lines() const;

 private:
  struct Entry {
    std::string where;
    uint64_t count = 0;
  };
  std::string file_;
  bool strict_;
  std::vector<std::string> order_;
  std::map<std::string, Entry> entries_;
  uint64_t unnamed_ = 0;
};

}  // namespace kairos::gltf
