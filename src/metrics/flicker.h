// How far a sequence of pictures is from its reference, and how much that changes from frame to frame.
#pragma once

#include <string>
#include <vector>

#include "metrics/compare.h"

namespace kairos {

/// Of a sequence. Noise that stays is seen less than noise that jumps: `flicker` tells them apart.
struct SequenceDifference {
  Difference mean;  ///< over all frames
  double flicker =
      0;  ///< mean over pixels, colours and pairs of neighbouring frames of |change of (image - reference)|
};

/// Frame after frame, so that no more than two are held.
class SequenceMeter {
 public:
  /// Throws as difference(), also for frames of another size than the first.
  void add(const Image& reference, const Image& image, const std::string& place);

  SequenceDifference result() const;

 private:
  std::vector<float> error_;  ///< of the last frame: red, then green, then blue
  double mse_sum_ = 0, change_sum_ = 0;
  int frames_ = 0;
};

}  // namespace kairos
