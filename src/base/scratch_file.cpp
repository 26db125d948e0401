#include "base/scratch_file.h"

#include <cerrno>
#include <cstdlib>
#include <vector>

#include <unistd.h>

#include <kairos/error.h>

#include "base/file.h"
#include "base/system_error.h"

namespace kairos {

ScratchFile::ScratchFile(const std::string& path) : ScratchFile(path, [](const std::string&) {}) {}

ScratchFile::ScratchFile(const std::string& path, const std::function<void(const std::string& name)>& open)
    : path_(path) {
  std::string name = parent_folder(path) + "/kairos-XXXXXX";
  const int file = mkstemp(name.data());
  if (file < 0) fail();
  file_ = fdopen(file, "w+b");
  try {
    if (file_ == nullptr) fail();
    open(name);
  } catch (...) {
    unlink(name.c_str());
    file_ == nullptr ? close(file) : std::fclose(file_);
    throw;
  }
  unlink(name.c_str());
}

ScratchFile::~ScratchFile() {
  if (file_ != nullptr) std::fclose(file_);
}

void ScratchFile::fail() const { throw_system_error(path_, "cannot be written", errno); }

void ScratchFile::write(const void* data, size_t size) {
  if (std::fwrite(data, 1, size, file_) != size) fail();
}

void ScratchFile::read(const std::function<void(const char* block, size_t size)>& take) {
  constexpr size_t kBlock = 1 << 20;
  std::vector<char> block(kBlock);
  if (std::fflush(file_) != 0 || std::fseek(file_, 0, SEEK_SET) != 0) fail();
  for (size_t got = 0; (got = std::fread(block.data(), 1, kBlock, file_)) > 0;) take(block.data(), got);
  if (std::ferror(file_) != 0) fail();
}

}  // namespace kairos
