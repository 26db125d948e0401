#include "scene_io/not_a_scene.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace kairos {

std::string what_it_is(std::span<const uint8_t> bytes) {
  constexpr size_t kLookedAt = 512;
  std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kLookedAt));
  if (head.starts_with("version https://git-lfs.github.com/spec"))
    return "is a Git LFS pointer, not the file itself: fetch that with 'git lfs pull'";
  if (head.starts_with("PK\x03\x04")) return "is a ZIP archive: unpack it first";
  if (head.starts_with("\x1f\x8b")) return "is compressed with gzip: unpack it first";
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (head.starts_with(kByteOrderMark)) head.remove_prefix(kByteOrderMark.size());
  while (!head.empty() && std::isspace(static_cast<unsigned char>(head.front()))) head.remove_prefix(1);
  std::string text(head);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* beginning : {"<!doctype html", "<html", "<head", "<body", "<!--"})
    if (text.starts_with(beginning)) return "is an HTML page, not a scene: the download has failed";
  if (text.starts_with("<?xml") || text.starts_with("<collada")) return "is XML, not a scene that is read here";
  return "";
}

}  // namespace kairos
