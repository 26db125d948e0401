#include "base/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include <kairos/error.h>

namespace kairos {

namespace fs = std::filesystem;

namespace {

// Renaming onto a symbolic link would replace the link instead of what it points at.
std::string target_of(const std::string& path) {
  std::error_code ec;
  if (!fs::is_symlink(path, ec)) return path;
  const fs::path target = fs::weakly_canonical(path, ec);
  return ec ? path : target.string();
}

}  // namespace

std::string temporary_name(const std::string& path) { return target_of(path) + ".tmp" + std::to_string(getpid()); }

void check_writable(const std::string& path) { const AtomicFile probe(path); }

AtomicFile::AtomicFile(const std::string& path) : path_(target_of(path)), temporary_(temporary_name(path)) {
  std::error_code ec;
  const fs::file_status status = fs::status(path_, ec);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ErrorCode::io, path, "is not a file; give the name of one");
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr)
    throw Error(ErrorCode::io, path,
                std::string("cannot be written: ") + std::strerror(errno) + "; check the folder and its permissions");
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::remove(temporary_.c_str());
}

void AtomicFile::fail(const char* what) const {
  throw Error(ErrorCode::io, path_, std::string(what) + ": " + std::strerror(errno));
}

void AtomicFile::write(const void* data, size_t size) {
  if (std::fwrite(data, 1, size, file_) != size) fail("cannot be written");
}

void AtomicFile::seek(size_t position) {
  if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) fail("cannot be written");
}

size_t AtomicFile::tell() {
  const off_t position = ftello(file_);
  if (position < 0) fail("cannot be written");
  return static_cast<size_t>(position);
}

void AtomicFile::commit() {
  if (std::ferror(file_) != 0 || std::fflush(file_) != 0) fail("cannot be written");
  std::FILE* const file = file_;
  file_ = nullptr;
  const bool closed = std::fclose(file) == 0;
  if (closed && std::rename(temporary_.c_str(), path_.c_str()) == 0) return;
  const int reason = errno;
  std::remove(temporary_.c_str());
  errno = reason;
  fail("cannot be written");
}

}  // namespace kairos
