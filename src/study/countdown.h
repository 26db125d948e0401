// How much of a study is done, and how long the rest will take.
#pragma once

#include <optional>

namespace kairos::study {

/// Work is in any unit that is about proportional to time.
class Countdown {
 public:
  explicit Countdown(double total) : total_(total) {}

  /// `work` that took `seconds`.
  void finish(double work, double seconds) {
    done_ += work;
    measured_work_ += work;
    measured_seconds_ += seconds;
  }
  /// Was found done.
  void skip(double work) { done_ += work; }

  /// partly: work of what is under way.
  double fraction(double partly) const { return total_ > 0 ? (done_ + partly) / total_ : 1; }
  std::optional<double> seconds_left(double partly) const {
    if (!(measured_work_ > 0)) return std::nullopt;
    return (total_ - done_ - partly) * measured_seconds_ / measured_work_;
  }

 private:
  double total_, done_ = 0, measured_work_ = 0, measured_seconds_ = 0;
};

}  // namespace kairos::study
