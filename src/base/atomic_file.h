// Files that are there whole or not at all.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace kairos {

/// Writes beside `path` under a name of its own; commit() puts it in its place, once its bytes are on the medium.
/// Without commit nothing is left behind. Where `path` is a link, what it stands for is written. A file that is
/// replaced hands on its permissions.
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
