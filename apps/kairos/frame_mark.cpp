#include "frame_mark.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/image.h>
#include <kairos/tracer.h>
#include <kairos/version.h>

namespace kairos::cli {

namespace {

constexpr size_t kMarkSize = 16;

/// FNV-1a with 64 bits: to tell apart what a user changed, not what an enemy did.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  }
  /// Ends a part: "ab", "c" and "a", "bc" differ.
  void end(size_t size) { add(fmt::format("\n{}\n", size)); }
  std::string text() const { return fmt::format("{:0{}x}", value_, kMarkSize); }

 private:
  uint64_t value_ = 0xcbf29ce484222325;
};

void add_file(Hash& hash, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> chunk(1 << 20);
  size_t size = 0;
  do {
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const auto got = static_cast<size_t>(file.gcount());
    hash.add({chunk.data(), got});
    size += got;
  } while (file);
  hash.end(size);
}

}  // namespace

std::string frame_mark(const CLI::App& command, const std::vector<std::string>& apart,
                       const std::vector<std::string>& files) {
  Hash hash;
  hash.add(version());
  for (const InstructionSet set : supported_instruction_sets()) hash.add(to_string(set));
  for (const CLI::Option* option : command.get_options()) {
    if (option->empty() || std::find(apart.begin(), apart.end(), option->get_name()) != apart.end()) continue;
    hash.add(option->get_name());
    hash.end(option->results().size());
    for (const std::string& result : option->results()) {
      hash.add(result);
      hash.end(result.size());
    }
  }
  for (const std::string& file : files) add_file(hash, file);
  return hash.text();
}

std::string read_frame_mark(const std::string& path) {
  // Both formats hold it in front of the pixels, as a name, what the format puts in between, and the mark.
  constexpr size_t kMostHead = 1 << 20;
  constexpr std::string_view kBetween[] = {std::string_view("\0string\0\x10\0\0\0", 12), std::string_view("\0", 1)};
  std::string head(kMostHead, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(file.gcount()));
  for (const std::string_view between : kBetween) {
    const std::string name = kFrameMarkName + std::string(between);
    const size_t found = head.find(name);
    if (found != head.npos && found + name.size() + kMarkSize <= head.size())
      return head.substr(found + name.size(), kMarkSize);
  }
  return "";
}

bool is_damaged_picture(const std::string& path) {
  constexpr std::string_view kSignatures[] = {"\x76\x2f\x31\x01", "\x89PNG\r\n\x1a\n"};  // EXR, PNG
  std::ifstream file(path, std::ios::binary);
  std::string head(kSignatures[1].size(), '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(file.gcount()));
  const auto begins_as = [&](std::string_view signature) {
    return head.substr(0, signature.size()) == signature.substr(0, head.size());
  };
  if (!std::any_of(std::begin(kSignatures), std::end(kSignatures), begins_as)) return false;
  try {
    read_image(path);
    return false;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bad_input) return true;
    throw;
  }
}

}  // namespace kairos::cli
