// The words of Prophesee's RAW files: EVT2 (32 bits), EVT2.1 (64 bits) and EVT3 (16 bits).
#pragma once

#include <cstdint>

namespace kairos::evt {

/// Types of words of EVT2 and EVT2.1, in their uppermost 4 bits.
constexpr uint32_t kOff = 0, kOn = 1, kTimeHigh2 = 8;
/// Types of EVT3's words, in their bits 15 to 12.
constexpr uint16_t kAddrY = 0, kAddrX = 2, kVectBase = 3, kVect12 = 4, kVect8 = 5, kTimeLow = 6, kTimeHigh3 = 8;
constexpr int kTimeBits2 = 6, kTimeBits3 = 12;  ///< of the time, in microseconds, that lower words hold
constexpr uint64_t kMostTime2 = uint64_t{1} << (28 + kTimeBits2);  ///< microseconds: nearly five hours
constexpr uint64_t kPlaces = 2048;                                 ///< of x and of y
constexpr unsigned kVector = 32;  ///< neighbours in a row that a word of EVT2.1, or three of EVT3, tell of

}  // namespace kairos::evt
