// How far rendering is, how fast, and how long it will take.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <kairos/names.h>

namespace kairos::cli {

enum class ProgressStyle {
  automatic,  ///< on a terminal a bar that is drawn anew in place; otherwise a line for every 10 %; on stderr
  openjd,     ///< what Open Job Description has programs say on stdout: openjd_progress, for every percent, openjd_fail
};
/// --progress.
void add_progress_option(CLI::App& app, ProgressStyle& out);

/// Does `work`, and says what it throws in the style's words, where it has any.
void tell_failure(ProgressStyle style, const std::function<void()>& work);

class ProgressBar {
 public:
  /// rays: of what is told to update(), for the rate; 0: it is not told. done, all: that is one of so many, of which so
  /// many are done.
  explicit ProgressBar(double rays, ProgressStyle style = ProgressStyle::automatic, size_t done = 0, size_t all = 1);
  /// Of work that began before.
  ProgressBar(double rays, std::chrono::steady_clock::time_point start);
  /// Wipes the bar off the terminal, until the next update: for lines that are to be said.
  void wipe() const;
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// fraction: 0 to 1, never less than before.
  void update(double fraction);

 private:
  std::string rate_and_time_left(double fraction) const;

  void update_openjd(double fraction);

  double rays_;
  ProgressStyle style_;
  double done_, all_;
  bool terminal_;
  int last_decile_ = 0, last_percent_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), drawn_{};
};

/// Of a number of pieces of work, such as the frames of a sequence, how far all of them are: shown once they take
/// longer than a second.
class WorkProgress {
 public:
  WorkProgress(bool quiet, size_t pieces) : quiet_(quiet), pieces_(static_cast<double>(pieces)) {}

  /// A piece is done, and lines may be said.
  void next() {
    ++done_;
    if (bar_) bar_->wipe();
  }
  /// What the piece's work is given as its `progress`, for as long as this lives: it stops when a signal has come.
  /// Several rounds of work may be given it one after the other.
  std::function<bool(double fraction)> of_piece();

 private:
  bool quiet_;
  double pieces_, done_ = 0, shown_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::optional<ProgressBar> bar_;
};

/// "8.3 M", "12 k": three digits and a unit.
std::string with_unit(double value);
/// "1:05:09", "4:05", "12 s".
std::string clock_time(double seconds);

}  // namespace kairos::cli

template <>
inline constexpr auto kairos::kNames<kairos::cli::ProgressStyle> =
    std::to_array<kairos::Named<kairos::cli::ProgressStyle>>({{"auto", kairos::cli::ProgressStyle::automatic},
                                                              {"openjd", kairos::cli::ProgressStyle::openjd}});
