// What people hold in place of a scene after a download or a clone that went wrong.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kairos {

/// What such bytes are and what to do, for an error message; empty for anything else.
std::string what_it_is(std::span<const uint8_t> bytes);

}  // namespace kairos
