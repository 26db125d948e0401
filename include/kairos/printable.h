// Text from files made fit for a line of a log, and for terminals, which obey what they are shown.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <kairos/export.h>

namespace kairos {

/// UTF-8 without what a terminal would obey or a reader be deceived by: controls (also those above 127), ends of lines,
/// marks that turn the direction of writing, and bytes that are no UTF-8 each become '?'. Of more than `limit` bytes
/// the first are taken (whole characters) and "..." follows.
KAIROS_API std::string printable(std::string_view text, size_t limit = 60);

}  // namespace kairos
