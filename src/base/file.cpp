#include "base/file.h"

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
  std::vector<uint8_t> bytes;
  if (const uint64_t size = fs::file_size(path, ec); !ec) {
    if (size > limit)
      throw Error(ErrorCode::bad_input, path, "is larger than the limit of " + std::to_string(limit) + " bytes");
    bytes.reserve(size);
  }
  // Read until the end rather than trust the size: the file may be a pipe, or grow.
  constexpr size_t kChunk = 1 << 20;
  for (;;) {
    const size_t old = bytes.size();
    bytes.resize(old + kChunk);
    const size_t got = std::fread(bytes.data() + old, 1, kChunk, file.get());
    bytes.resize(old + got);
    if (bytes.size() > limit)
      throw Error(ErrorCode::bad_input, path, "is larger than the limit of " + std::to_string(limit) + " bytes");
    if (got < kChunk) break;
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
