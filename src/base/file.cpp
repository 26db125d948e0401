#include "base/file.h"

#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include <kairos/error.h>

namespace kairos {

namespace fs = std::filesystem;

std::vector<uint8_t> read_file(const std::string& path, uint64_t limit) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) throw Error(ErrorCode::io, path, "is a folder; give a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw Error(ErrorCode::io, path, "cannot be opened for reading; check the name and the permissions");
  const auto check_limit = [&](uint64_t size) {
    if (size > limit)
      throw Error(ErrorCode::bad_input, path, "is larger than the limit of " + std::to_string(limit) + " bytes");
  };
  // A file is read in one piece of memory of its size, not more: scenes are as large as machines bear.
  uint64_t size = fs::file_size(path, ec);
  if (ec) size = 0;
  check_limit(size);
  std::vector<uint8_t> bytes(size);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  // It may be a pipe, or have grown.
  std::array<uint8_t, 1 << 16> rest;
  while (const size_t got = std::fread(rest.data(), 1, rest.size(), file.get())) {
    check_limit(bytes.size() + got);
    bytes.insert(bytes.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(got));
  }
  if (std::ferror(file.get())) throw Error(ErrorCode::io, path, "cannot be read to its end");
  return bytes;
}

std::string parent_folder(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

std::string resolve_inside(const std::string& folder, std::string_view relative, const std::string& place) {
  const std::string name(relative);
  const auto refuse = [&](const char* why) -> void {
    throw Error(ErrorCode::bad_input, place, "path '" + name + "' " + why);
  };
  if (name.empty()) refuse("is empty");
  if (name.find('\0') != std::string::npos) refuse("holds a NUL character");
  const fs::path path(name);
  if (path.is_absolute() || name.front() == '\\') refuse("is absolute; give it relative to the scene's folder");
  std::error_code ec;
  const fs::path root = fs::weakly_canonical(folder, ec);
  const fs::path full = fs::weakly_canonical(fs::path(folder) / path, ec);
  if (ec) refuse("cannot be resolved");
  const fs::path inside = full.lexically_relative(root);
  if (inside.empty() || *inside.begin() == "..") refuse("leaves the scene's folder");
  return (fs::path(folder) / path).string();
}

}  // namespace kairos
