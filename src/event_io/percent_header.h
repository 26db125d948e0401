// The header of Prophesee's files: lines that begin with %.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kairos {

/// The lines, and where they end: at "% end", or before the first line of another kind.
struct PercentHeader {
  size_t size = 0;
  std::string text;

  explicit PercentHeader(std::span<const uint8_t> bytes) {
    while (size < bytes.size() && bytes[size] == '%') {
      size_t end = size;
      while (end < bytes.size() && bytes[end] != '\n') ++end;
      const std::string line(bytes.begin() + static_cast<std::ptrdiff_t>(size),
                             bytes.begin() + static_cast<std::ptrdiff_t>(end));
      size = std::min(end + 1, bytes.size());
      text += line + '\n';
      if (line.starts_with("% end")) break;
    }
  }
  bool says(std::string_view what) const { return text.find(what) != std::string::npos; }
  /// The number behind a word; 0 where there is none.
  int number(std::string_view word) const {
    const size_t at = text.find(word);
    int value = 0;
    if (at != std::string::npos) std::from_chars(text.data() + at + word.size(), text.data() + text.size(), value);
    return value >= 0 && value <= 65536 ? value : 0;
  }
};

}  // namespace kairos
