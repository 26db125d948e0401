// Files that are there whole or not at all.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace kairos {

/// The name under which a file is written before it is complete: in the same folder, so that renaming stays atomic.
std::string temporary_name(const std::string& path);

/// Throws Error(io) when an AtomicFile could not be written at `path`.
void check_writable(const std::string& path);

/// Writes to temporary_name(path); commit() puts it in its place. Without commit nothing is left behind.
class AtomicFile {
 public:
  /// Throws Error(io) when the folder cannot be written to, or `path` is something other than a file.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// These throw Error(io) when the system refuses.
  void write(const void* data, size_t size);
  void seek(size_t position);
  size_t tell();
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace kairos
