// How far rendering is, how fast, and how long it will take.
#pragma once

#include <chrono>
#include <string>

namespace kairos::cli {

/// On a terminal a bar that is drawn anew in place; otherwise a line for every 10 %. Writes to stderr.
class ProgressBar {
 public:
  /// rays: of the whole picture, for the rate; 0: it is not told.
  explicit ProgressBar(double rays);
  /// Wipes the bar off the terminal.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// fraction: 0 to 1, never less than before.
  void update(double fraction);

 private:
  std::string rate_and_time_left(double fraction) const;

  double rays_;
  bool terminal_;
  int last_decile_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), drawn_{};
};

/// "8.3 M", "12 k": three digits and a unit.
std::string with_unit(double value);
/// "1:05:09", "4:05", "12 s".
std::string clock_time(double seconds);

}  // namespace kairos::cli
