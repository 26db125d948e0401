// Which of two ways to render pixels has the smaller error, as far as a few pixels can tell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace kairos {

/// Of pixels that were rendered both ways.
class Duel {
 public:
  /// Fewer pixels say nothing.
  static constexpr size_t kLeastPixels = 24;

  /// Squared errors of a pixel, or of any other measure that is to be small.
  void add(double ours, double theirs) {
    ++pixels_;
    ours_ += ours;
    theirs_ += theirs;
    most_theirs_ = std::max(most_theirs_, theirs);
    squares_ours_ += ours * ours;
    squares_theirs_ += theirs * theirs;
    products_ += ours * theirs;
  }

  size_t pixels() const { return pixels_; }
  double mean_ours() const { return pixels_ > 0 ? ours_ / static_cast<double>(pixels_) : 0; }
  double mean_theirs() const { return pixels_ > 0 ? theirs_ / static_cast<double>(pixels_) : 0; }

  /// Is ours clearly smaller, if each is multiplied by this?
  bool is_won(double scale_ours = 1, double scale_theirs = 1) const {
    if (pixels_ < kLeastPixels) return false;
    const double unseen = pixels_ < kFewPixels ? scale_theirs * most_theirs_ : 0;
    const double ours = scale_ours * ours_ + unseen, theirs = scale_theirs * theirs_, lead = theirs - ours;
    const double squared_leads = scale_theirs * scale_theirs * squares_theirs_ -
                                 2 * scale_theirs * scale_ours * products_ + scale_ours * scale_ours * squares_ours_ +
                                 unseen * unseen;
    const double variance = squared_leads - lead * lead / static_cast<double>(pixels_);
    const double deviations = kDeviations + kOfOnePixel / static_cast<double>(pixels_);
    return ours < kClearly * theirs && lead > deviations * std::sqrt(std::max(variance, 0.0));
  }

 private:
  /// A few hundred pixels tell errors to 0.7 dB.
  static constexpr double kClearly = 0.85;
  /// Where a few pixels make most of the error, those that were looked at may be without them: a lead has to be that
  /// much above its own standard error, and more where it is known from few pixels.
  static constexpr double kDeviations = 1.5, kOfOnePixel = 40;
  /// Of fewer than these, one more might have shown what ours misses everywhere else, such as an edge through one pixel
  /// in thirty: it is thought to be there, as bad as the worst of theirs. Without it, auto was 2.6 dB behind discrete
  /// samples with one draw in 25 of random triangles, in pictures of 48x32.
  static constexpr size_t kFewPixels = 64;

  size_t pixels_ = 0;
  double ours_ = 0, theirs_ = 0;  // sums
  double most_theirs_ = 0;
  double squares_ours_ = 0, squares_theirs_ = 0, products_ = 0;
};

}  // namespace kairos
