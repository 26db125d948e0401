// What the program's exit status says.
#pragma once

namespace kairos::cli {

inline constexpr int kFailed = 1;     ///< bad input, or a rendering that failed: the same again will fail again
inline constexpr int kBadUsage = 2;   ///< arguments that make no sense
inline constexpr int kTryAgain = 75;  ///< what failed may go well later or elsewhere (EX_TEMPFAIL of sysexits.h)

}  // namespace kairos::cli
