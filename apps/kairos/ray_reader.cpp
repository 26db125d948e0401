#include "ray_reader.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <kairos/error.h>

namespace kairos::cli {

namespace {

constexpr size_t kMostCharacters = 4096;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

// Six numbers and nothing else; how many were found if not six.
size_t parse_numbers(std::string_view text, std::array<float, 6>& numbers) {
  size_t count = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    while (at != end && is_blank(*at)) ++at;
    if (at == end) return count;
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (next != end && !is_blank(*next)) || count == 6) return 7;
    const auto narrow = static_cast<float>(value);
    if (!std::isfinite(narrow)) return 7;
    numbers[count++] = narrow;
    at = next;
  }
}

}  // namespace

bool RayReader::next(Ray& ray) {
  std::array<char, kMostCharacters + 1> buffer;
  for (;;) {
    in_.getline(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    const auto refuse = [&](const char* why) {
      throw Error(ErrorCode::bad_input, name_ + ":" + std::to_string(line_), why);
    };
    const auto taken = static_cast<size_t>(in_.gcount());
    if (in_.bad()) throw Error(ErrorCode::io, name_, "cannot be read to its end");
    if (taken == 0 && in_.eof()) return false;
    ++line_;
    if (in_.fail()) refuse("the line is too long; one ray a line: ox oy oz dx dy dz");
    const std::string_view text(buffer.data(), in_.eof() ? taken : taken - 1);
    size_t first = 0;
    while (first < text.size() && is_blank(text[first])) ++first;
    if (first == text.size() || text[first] == '#') continue;
    std::array<float, 6> numbers{};
    if (parse_numbers(text, numbers) != 6) refuse("not six finite numbers; one ray a line: ox oy oz dx dy dz");
    ray = {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    if (ray.direction == Vec3f{}) refuse("the direction is zero; one ray a line: ox oy oz dx dy dz");
    return true;
  }
}

}  // namespace kairos::cli
