// Sequences of frames: which ones, and the names of their files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kairos::cli {

struct FrameRange {
  int first = 0, last = 0;  ///< 0 <= first <= last

  int count() const { return last - first + 1; }
};

/// "A-B" or "A": whole numbers, at most 100000 frames. Throws CLI::ValidationError that names the option.
FrameRange parse_frames(const std::string& option, std::string_view text);

/// A file name with one %d, or %0Nd for N digits at least, in place of the frame's number; %% stands for a percent
/// sign.
class FrameName {
 public:
  /// Throws CLI::ValidationError that names the option where the text is no such name.
  FrameName(const std::string& option, std::string_view text);

  /// Throws as the constructor does.
  static void check(const std::string& option, std::string_view text);

  std::string at(int frame) const;

 private:
  std::string before_, after_;
  int digits_ = 0;
};

}  // namespace kairos::cli
