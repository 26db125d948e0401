// What the operating system refuses, as errors of ours.
#pragma once

#include <string>

namespace kairos {

/// Throws Error(io) that says `what` and then the reason, one of errno's; TemporaryError where that may pass, as a full
/// disk does.
[[noreturn]] void throw_system_error(const std::string& path, const std::string& what, int reason,
                                     const std::string& advice = {});

}  // namespace kairos
