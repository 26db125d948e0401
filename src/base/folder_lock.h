// A folder that one process at a time may fill.
#pragma once

#include <string>

namespace kairos {

/// Holds the folder until it is destroyed, or its process ends in whatever way. Nothing is written for it. File systems
/// that cannot lock let everybody in.
class FolderLock {
 public:
  /// Throws Error(io, folder) when somebody else holds it.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

}  // namespace kairos
