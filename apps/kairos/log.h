// What is said on standard error.
#pragma once

#include <string_view>

namespace kairos::cli {

/// A line, made fit for a terminal. Where nobody can be told (a full disk, a closed stream), nothing is: a log that
/// cannot be written costs no picture.
void log(std::string_view line);

/// The same without its end, for lines that are drawn anew in place; taken as it is.
void draw(std::string_view text);

}  // namespace kairos::cli
