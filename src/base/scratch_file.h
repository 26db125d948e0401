// Bytes that wait beside a file until it is known what comes before them.
#pragma once

#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>

namespace kairos {

/// In the folder of `path`, without a name: gone when it is closed, however the process ends.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& path);
  /// The same, where a library opens it once more: it has a name while `open` runs.
  ScratchFile(const std::string& path, const std::function<void(const std::string& name)>& open);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// These throw Error(io) when the system refuses.
  void write(const void* data, size_t size);
  /// Hands over all that was written, block by block, from the beginning.
  void read(const std::function<void(const char* block, size_t size)>& take);

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  std::FILE* file_ = nullptr;
};

}  // namespace kairos
