#include "scene_io/obj/lines.h"

namespace kairos {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

bool continues(std::string_view line) { return !line.empty() && line.back() == '\\'; }

}  // namespace

Lines::Lines(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) rest_.remove_prefix(kByteOrderMark.size());
}

bool Lines::next(std::string_view& line) {
  number_ = next_number_;
  if (rest_.empty()) return false;
  line = take();
  if (!continues(line)) return true;
  joined_.clear();
  for (;;) {
    const bool more = continues(line);
    joined_ += more ? line.substr(0, line.size() - 1) : line;
    if (!more || rest_.empty()) break;
    joined_ += ' ';
    line = take();
  }
  line = joined_;
  return true;
}

std::string_view Lines::take() {
  const size_t end = rest_.find_first_of("\r\n");
  const std::string_view line = rest_.substr(0, end);
  const size_t ends = end == rest_.npos ? 0 : rest_.substr(end, 2) == "\r\n" ? 2 : 1;
  rest_.remove_prefix(line.size() + ends);
  ++next_number_;
  return line;
}

std::string_view take_token(std::string_view& line) {
  size_t begin = 0;
  while (begin < line.size() && is_space(line[begin])) ++begin;
  size_t end = begin;
  while (end < line.size() && !is_space(line[end])) ++end;
  const std::string_view token = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return token;
}

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
  while (!line.empty() && is_space(line.back())) line.remove_suffix(1);
  return line;
}

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

}  // namespace kairos
