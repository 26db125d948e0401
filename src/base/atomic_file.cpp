#include "base/atomic_file.h"

#include <cerrno>
#include <filesystem>
#include <random>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <kairos/error.h>
#include <kairos/files.h>

#include "base/system_error.h"

namespace kairos {

namespace fs = std::filesystem;

namespace {

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

[[noreturn]] void refuse(const std::string& path, int reason) {
  throw_system_error(path, "cannot be written", reason, "; check the folder and its permissions");
}

/// What a link stands for, whether that exists or not: renaming onto a link would replace the link.
std::string target_of(const std::string& path) {
  constexpr int kMostLinks = 40;  // as many as Linux follows
  fs::path target = path;
  std::error_code ec;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, ec)); ++links) {
    if (links == kMostLinks) refuse(path, ELOOP);
    target = target.parent_path() / fs::read_symlink(target, ec);  // which an absolute one replaces
    if (ec) refuse(path, ec.value());
  }
  return target.string();
}

/// A name in the same folder, so that renaming stays atomic. Nobody can foretell it and put something in its place, nor
/// do two writers choose the same, whatever machines they run on. Any name that a file may have leaves room for it.
std::string temporary_name(const std::string& path) {
  std::random_device random;
  char name[32];
  std::snprintf(name, sizeof(name), "kairos-%08x%08x.tmp", random(), random());
  return (fs::path(folder_of(path)) / name).string();
}

/// Waits until the medium has it. File systems that cannot say so do what they can.
bool flush_to_medium(int file) { return fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP; }

}  // namespace

void check_writable(const std::string& path) { const AtomicFile probe(path); }

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

AtomicFile::AtomicFile(const std::string& path) : path_(target_of(path)) {
  struct stat old {};
  const bool replaces = stat(path_.c_str(), &old) == 0;
  if (!replaces && errno != ENOENT) refuse(path, errno);
  if (replaces && !S_ISREG(old.st_mode)) throw Error(ErrorCode::io, path, "is not a file; give the name of one");
  int file = -1;
  do {
    temporary_ = temporary_name(path_);
    file = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  } while (file < 0 && errno == EEXIST);
  if (file < 0) refuse(path, errno);
  if (replaces) fchmod(file, old.st_mode & 0777);  // who may read it stays so, where the system allows that
  file_ = fdopen(file, "wb");
  if (file_ == nullptr) {
    const int reason = errno;
    close(file);
    std::remove(temporary_.c_str());
    refuse(path, reason);
  }
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::remove(temporary_.c_str());
}

void AtomicFile::fail(const char* what) const { throw_system_error(path_, what, errno); }

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
  // Renamed before its bytes are on the medium, a file could be there without them after a power failure.
  if (std::ferror(file_) != 0 || std::fflush(file_) != 0 || !flush_to_medium(fileno(file_))) fail("cannot be written");
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0 || std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    const int reason = errno;
    std::remove(temporary_.c_str());
    errno = reason;
    fail("cannot be written");
  }
  const int folder = open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;  // one may write to folders that one may not read
  flush_to_medium(folder);
  close(folder);
}

}  // namespace kairos
