#include <algorithm>
#include <cstdint>

#include <kairos/error.h>
#include <kairos/printable.h>

namespace kairos {

namespace {

struct Character {
  char32_t code = 0;
  size_t size = 0;  ///< bytes; 0 for what is no UTF-8
};

/// At the beginning of `text`, which is not empty.
Character first_character(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const size_t size = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < size) return {};
  char32_t code = lead & (0xff >> (size + 1));
  for (size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // by size: longer forms of smaller codes are none
  if (code < kLeast[size] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
  return {code, size};
}

bool may_be_shown(char32_t code) {
  const bool control = code < 0x20 || (code >= 0x7f && code < 0xa0);
  const bool line_end = code == 0x2028 || code == 0x2029;
  const bool direction = code == 0x200e || code == 0x200f || (code >= 0x202a && code <= 0x202e) ||
                         (code >= 0x2066 && code <= 0x2069) || code == 0x61c;
  return !control && !line_end && !direction;
}

}  // namespace

std::string printable(std::string_view text, size_t limit) {
  std::string shown;
  shown.reserve(std::min(limit, text.size()));
  while (!text.empty()) {
    const Character next = first_character(text);
    const bool plain = next.size > 0 && may_be_shown(next.code);
    if (shown.size() + (plain ? next.size : 1) > limit) return shown + "...";
    if (plain)
      shown += text.substr(0, next.size);
    else
      shown += '?';
    text.remove_prefix(std::max<size_t>(1, next.size));
  }
  return shown;
}

Error::Error(ErrorCode error_code, const std::string& place, const std::string& message)
    : std::runtime_error(printable(place.empty() ? message : place + ": " + message, std::string_view::npos)),
      code_(error_code) {}

}  // namespace kairos
