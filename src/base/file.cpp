#include "base/file.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <kairos/printable.h>
#include <kairos/temporary_error.h>

#include "base/system_error.h"

namespace kairos {

namespace fs = std::filesystem;

std::vector<uint8_t> read_file(const std::string& path, uint64_t limit) {
  // Opening a pipe would wait for whoever writes to it, and a device may do anything.
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(descriptor < 0 ? nullptr : fdopen(descriptor, "rb"),
                                                             &std::fclose);
  if (!file) {
    const int reason = errno;
    if (descriptor >= 0) close(descriptor);
    throw_system_error(path, "cannot be opened for reading", reason, "; check the name and the permissions");
  }
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    throw Error(ErrorCode::io, path,
                S_ISDIR(status.st_mode) ? "is a folder; give a file" : "is no file, but a pipe, a socket or a device");
  const auto check_limit = [&](uint64_t size) {
    if (size > limit)
      throw Error(ErrorCode::bad_input, path, "is larger than the limit of " + std::to_string(limit) + " bytes");
  };
  // A file is read in one piece of memory of its size, not more: scenes are as large as machines bear.
  const auto size = static_cast<uint64_t>(status.st_size);
  check_limit(size);
  std::vector<uint8_t> bytes(size);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  // It may have grown, and files of the system (/proc) say that they are empty.
  std::array<uint8_t, 1 << 16> rest;
  while (const size_t got = std::fread(rest.data(), 1, rest.size(), file.get())) {
    check_limit(bytes.size() + got);
    bytes.insert(bytes.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(got));
  }
  if (std::ferror(file.get())) throw TemporaryError(ErrorCode::io, path, "cannot be read to its end");
  return bytes;
}

std::string parent_folder(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

std::string SceneFolder::try_resolve(std::string_view name, std::string& problem) const {
  const std::string shown = "path '" + printable(name, 200) + "' ";
  const auto refuse = [&](const std::string& why) {
    problem = shown + why;
    return std::string();
  };
  if (name.empty()) return refuse("is empty");
  if (name.find('\0') != std::string_view::npos) return refuse("holds a NUL character");
  if (name.front() == '\\') return refuse("begins with a backslash; give it relative to the scene's folder");
  std::error_code ec;
  const std::string& outermost = root.empty() ? path : root;
  const fs::path allowed = fs::weakly_canonical(outermost, ec);
  const fs::path file = fs::path(path) / fs::path(name);  // which an absolute one replaces
  const fs::path full = fs::weakly_canonical(file, ec);
  if (ec) return refuse("cannot be resolved");
  const fs::path inside = full.lexically_relative(allowed);
  if (inside.empty() || *inside.begin() == "..")
    return refuse("leaves the folder '" + outermost + "', in which the scene may read; --root FOLDER gives it another");
  if (named) named->insert(file.string());
  return file.string();
}

std::string SceneFolder::resolve(std::string_view name, const std::string& place) const {
  std::string problem;
  std::string resolved = try_resolve(name, problem);
  if (!problem.empty()) throw Error(ErrorCode::bad_input, place, problem);
  return resolved;
}

}  // namespace kairos
