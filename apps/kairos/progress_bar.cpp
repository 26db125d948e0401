#include "progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include <fmt/format.h>
#include <unistd.h>

#include <kairos/printable.h>

#include "arguments.h"
#include "interrupt.h"
#include "log.h"

namespace kairos::cli {

std::string with_unit(double value) {
  if (value >= 1e9) return fmt::format("{:.3g} G", value / 1e9);
  if (value >= 1e6) return fmt::format("{:.3g} M", value / 1e6);
  if (value >= 1e3) return fmt::format("{:.3g} k", value / 1e3);
  return fmt::format("{:.3g} ", value);
}

std::string clock_time(double seconds) {
  constexpr double kMostSeconds = 1e9;
  const auto whole = std::lround(std::clamp(seconds, 0.0, kMostSeconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

void add_progress_option(CLI::App& app, ProgressStyle& out) {
  add_choice(app, "--progress", out,
             "How progress is told. auto: a bar on a terminal, else lines, on stderr; openjd: as Open Job Description "
             "reads it, on stdout, also with --quiet");
}

void tell_failure(ProgressStyle style, const std::function<void()>& work) {
  if (style != ProgressStyle::openjd) return work();
  try {
    work();
  } catch (const std::exception& e) {
    std::fputs(fmt::format("openjd_fail: {}\n", printable(e.what(), std::string::npos)).c_str(), stdout);
    std::fflush(stdout);
    throw;
  }
}

ProgressBar::ProgressBar(double rays, ProgressStyle style, size_t done, size_t all)
    : rays_(rays),
      style_(style),
      done_(static_cast<double>(done)),
      all_(static_cast<double>(all)),
      terminal_(style == ProgressStyle::automatic && isatty(STDERR_FILENO) != 0),
      last_percent_(done == 0 ? -1 : static_cast<int>(done_ / all_ * 100)) {}

ProgressBar::ProgressBar(double rays, std::chrono::steady_clock::time_point start) : ProgressBar(rays) {
  start_ = start;
}

ProgressBar::~ProgressBar() { wipe(); }

void ProgressBar::wipe() const {
  if (terminal_) draw("\r\x1b[K");
}

std::string ProgressBar::rate_and_time_left(double fraction) const {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (!(elapsed > 0 && fraction > 0)) return "";
  const std::string left = clock_time(elapsed * (1 - fraction) / fraction) + " left";
  return rays_ > 0 ? fmt::format("{}rays/s, {}", with_unit(rays_ * fraction / elapsed), left) : left;
}

void ProgressBar::update_openjd(double fraction) {
  const int percent = static_cast<int>((done_ + fraction) / all_ * 100);
  if (percent <= last_percent_) return;
  last_percent_ = percent;
  std::fputs(fmt::format("openjd_progress: {}\n", percent).c_str(), stdout);
  std::fflush(stdout);
}

void ProgressBar::update(double fraction) {
  if (style_ == ProgressStyle::openjd) return update_openjd(fraction);
  if (!terminal_) {
    const int decile = static_cast<int>(fraction * 10);
    if (decile <= last_decile_) return;
    last_decile_ = decile;
    log(fmt::format("{} %  {}", decile * 10, rate_and_time_left(fraction)));
    return;
  }
  constexpr auto kRedraw = std::chrono::milliseconds(100);
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < kRedraw && fraction < 1) return;
  drawn_ = now;
  constexpr size_t kWidth = 30;
  const auto filled = static_cast<size_t>(std::lround(std::clamp(fraction, 0.0, 1.0) * kWidth));
  draw(fmt::format("\r[{}{}] {:3.0f} %  {}\x1b[K", std::string(filled, '#'), std::string(kWidth - filled, '.'),
                   std::floor(fraction * 100), rate_and_time_left(fraction)));
}

std::function<bool(double fraction)> WorkProgress::of_piece() {
  return [this](double fraction) {
    constexpr auto kShort = std::chrono::seconds(1);
    shown_ = std::max(shown_, std::min(1.0, (done_ + fraction) / pieces_));
    if (!quiet_ && !bar_ && std::chrono::steady_clock::now() - start_ > kShort) bar_.emplace(0.0, start_);
    if (bar_) bar_->update(shown_);
    return !interrupted();
  };
}

}  // namespace kairos::cli
