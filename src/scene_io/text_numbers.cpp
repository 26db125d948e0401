#include "scene_io/text_numbers.h"

#include <charconv>
#include <cmath>
#include <limits>

namespace kairos {

namespace {

bool skip_plus(std::string_view& token) {
  if (!token.empty() && token.front() == '+') {
    token.remove_prefix(1);
    if (!token.empty() && (token.front() == '-' || token.front() == '+')) return false;
  }
  return !token.empty();
}

template <class T>
std::from_chars_result read_all(std::string_view token, T& out) {
  return std::from_chars(token.data(), token.data() + token.size(), out);
}

}  // namespace

bool parse_number(std::string_view token, double& out) {
  if (!skip_plus(token)) return false;
  const auto [end, error] = read_all(token, out);
  if (end != token.data() + token.size() || error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) {
    // Which end of the range it is, the digits tell: the exponent's sign, or a zero before the point.
    const size_t exponent = token.find_first_of("eE");
    const bool tiny =
        exponent != token.npos ? token[exponent + 1] == '-' : token.find_first_not_of("-0") == token.find('.');
    out = std::copysign(tiny ? 0 : std::numeric_limits<double>::infinity(), token.front() == '-' ? -1.0 : 1.0);
  }
  return true;
}

bool parse_number(std::string_view token, float& out) {
  std::string_view digits = token;
  if (!skip_plus(digits)) return false;
  const auto [end, error] = read_all(digits, out);
  if (error == std::errc()) return end == digits.data() + digits.size();
  if (error == std::errc::invalid_argument) return false;
  double value = 0;
  if (!parse_number(token, value)) return false;
  const bool large = std::abs(value) > std::numeric_limits<float>::max();
  out = large ? std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(std::copysign(1.0, value)))
              : static_cast<float>(value);
  return true;
}

bool parse_integer(std::string_view token, int64_t& out) {
  if (!skip_plus(token)) return false;
  const auto [end, error] = read_all(token, out);
  return error == std::errc() && end == token.data() + token.size();
}

}  // namespace kairos
