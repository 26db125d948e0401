#include <cmath>
#include <limits>

#include <kairos/compare.h>
#include <kairos/error.h>

namespace kairos {

void SequenceMeter::add(const Image& reference, const Image& image, const std::string& place) {
  mse_sum_ += difference(reference, image, place).mse;
  std::vector<float> error;
  for (const char* name : {"R", "G", "B"}) {
    const std::vector<float>&got = image.find(name)->values, &expected = reference.find(name)->values;
    for (size_t i = 0; i < got.size(); ++i) error.push_back(got[i] - expected[i]);
  }
  if (frames_ > 0) {
    if (error.size() != error_.size())
      throw Error(ErrorCode::bad_input, place, "is of another size than the frame before; a sequence has one size");
    double sum = 0;
    for (size_t i = 0; i < error.size(); ++i)
      sum += std::abs(static_cast<double>(error[i]) - static_cast<double>(error_[i]));
    change_sum_ += sum / static_cast<double>(error.size());
  }
  error_ = std::move(error);
  ++frames_;
}

SequenceDifference SequenceMeter::result() const {
  SequenceDifference result;
  if (frames_ == 0) return result;
  result.mean.mse = mse_sum_ / frames_;
  result.mean.psnr = result.mean.mse > 0 ? -10 * std::log10(result.mean.mse) : std::numeric_limits<double>::infinity();
  if (frames_ > 1) result.flicker = change_sum_ / (frames_ - 1);
  return result;
}

}  // namespace kairos
