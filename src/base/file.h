// Reading files that are not to be trusted.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace kairos {

/// The whole file. Throws Error(io) when it cannot be read or is none (but a folder, a pipe, a device),
/// Error(bad_input) when it is larger than `limit` bytes.
std::vector<uint8_t> read_file(const std::string& path, uint64_t limit);

/// The folder that `path` lies in ("." where it names none).
std::string parent_folder(const std::string& path);

/// Where a scene's file names lead, and where they must not.
struct SceneFolder {
  std::string path;                                ///< of the file that names others: names are relative to it
  std::string root;                                ///< everything that is named must lie in it; empty: in `path`
  std::shared_ptr<std::set<std::string>> named{};  ///< what names were found to stand for is kept here, where it is set

  /// The folder of the file at `other`, which names files with the same root.
  SceneFolder beside(const std::string& other) const { return {parent_folder(other), root, named}; }

  /// What `name` stands for. Absolute names count where they lie in the root. Throws Error(bad_input, place) when the
  /// name is empty, holds a NUL or leaves the root, also by way of a symbolic link. A file that does not exist is not
  /// an error here.
  std::string resolve(std::string_view name, const std::string& place) const;

  /// The same, where one can do without the file: empty for a name that resolve() refuses, and `problem` says why.
  std::string try_resolve(std::string_view name, std::string& problem) const;
};

}  // namespace kairos
