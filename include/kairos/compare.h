// How far pictures and sequences of them are from a reference, in numbers and to look at.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/image.h>

namespace kairos {

struct Difference {
  double mse = 0;   ///< mean over pixels and red, green, blue of the squared difference
  double psnr = 0;  ///< decibels, 10 log10(1 / mse): the peak is 1; infinite for equal pictures
};

/// On linear values as they are in the files: no clamping, no sRGB curve.
/// Throws Error(bad_input) when the pictures differ in size, lack a colour, or hold a value that is not finite; `place`
/// names the picture in the message.
KAIROS_API Difference difference(const Image& reference, const Image& image, const std::string& place);

/// Pixels [x, x + width) x [y, y + height).
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;
};

struct Panel {
  const Image* image = nullptr;
  std::string label;  ///< written into the panel; empty for none
};

/// Pictures of equal size next to each other and, below each, its pixels in `zoom` magnified by the largest whole
/// factor that fits the panel's width. Colour alone. Throws Error(bad_input) for pictures of different sizes,
/// Error(bad_usage) for a `zoom` that is not inside of them.
KAIROS_API Image side_by_side(std::span<const Panel> panels, const std::optional<PixelBox>& zoom);

/// Of a sequence. Noise that stays is seen less than noise that jumps: `flicker` tells them apart.
struct SequenceDifference {
  Difference mean;  ///< over all frames
  double flicker =
      0;  ///< mean over pixels, colours and pairs of neighbouring frames of |change of (image - reference)|
};

/// Frame after frame, so that no more than two are held.
class KAIROS_API SequenceMeter {
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
