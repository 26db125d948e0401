// Numbers and names in text files: independent of the locale, and safe to show in an error message.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <kairos/printable.h>

namespace kairos {

/// Each parses all of `token` (a leading '+' is allowed) and returns false when that is not a number. Too large a
/// number becomes infinite, too small a one zero; "nan" and "inf" are numbers here: the caller looks for them.
bool parse_number(std::string_view token, float& out);
bool parse_number(std::string_view token, double& out);

/// Parses all of `token` as a decimal integer. False when it is none, or beyond 64 bits.
bool parse_integer(std::string_view token, int64_t& out);

}  // namespace kairos
