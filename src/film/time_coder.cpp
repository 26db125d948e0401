#include "film/time_coder.h"

#include <algorithm>
#include <cmath>

#include "film/half.h"

namespace kairos {

namespace {

constexpr size_t kRun = 8;  // pieces that are looked at before the question whether it is enough

/// How far off the deviations that are computed with floats may be, in units of their scale: a few roundings of
/// integrals that are hardly larger than the scale.
constexpr double kFloatError = 0x1p-21;

/// Over less time than this, moments are too small beside those since time 0 to be told from them.
constexpr double kShort = 0x1p-12;

}  // namespace

void TimeCoder::add(std::span<const SignalPiece> signal, double shift, TimeTile& out) {
  if (out.first.empty()) out.first.push_back(0);
  if (tolerance_ == 0) {
    append_exactly(signal, out);
    out.first.push_back(static_cast<uint32_t>(out.begin.size()));
    return;
  }
  signal_ = signal;
  integrate(signal);
  for (size_t c = 0; c < 4; ++c) {
    scale_[c] = std::max(1.0, std::abs(sum_.back()[c]));
    limit_[c] = static_cast<float>(tolerance_ * scale_[c] - shift - kFloatError * scale_[c]);
  }
  last_count_ = 1;
  for (size_t first = 0; first < signal.size();) {
    Fit line;
    const size_t last = longest(first, line);
    const Rgba found = deviation(first, last, line);
    for (size_t c = 0; c < 4; ++c)
      out.deviation.integral = std::max(out.deviation.integral, static_cast<float>((found[c] + shift) / scale_[c]));
    append(first, line, out);
    first = last;
  }
  out.first.push_back(static_cast<uint32_t>(out.begin.size()));
}

void TimeCoder::append_exactly(std::span<const SignalPiece> signal, TimeTile& out) const {
  for (const SignalPiece& piece : signal) {
    out.begin.push_back(piece.begin);
    Four<float> left{}, step{};
    for (size_t c = 0; c < 4; ++c) {
      left[c] = static_cast<float>(piece.left[c]);
      step[c] = static_cast<float>(piece.right[c] - piece.left[c]);
    }
    out.floats.left.push_back(left);
    out.floats.step.push_back(step);
  }
}

void TimeCoder::integrate(std::span<const SignalPiece> signal) {
  const size_t count = signal.size();
  time_.resize(count + 1);
  sum_.resize(count + 1);
  moment_.resize(count + 1);
  steps_.resize(count);
  for (size_t i = 0; i < count; ++i) time_[i] = signal[i].begin * kTick;
  time_[count] = 1;
  sum_[0] = moment_[0] = {};
  for (size_t i = 0; i < count; ++i) {
    const double length = time_[i + 1] - time_[i];
    Step& step = steps_[i];
    step.time = time_[i];
    step.eighth = static_cast<float>(length * length / 8);
    for (size_t c = 0; c < 4; ++c) {
      const double left = signal[i].left[c], rise = signal[i].right[c] - left;
      const double sum = length * (left + rise / 2);
      sum_[i + 1][c] = sum_[i][c] + sum;
      moment_[i + 1][c] = moment_[i][c] + time_[i] * sum + length * length * (left / 2 + rise / 3);
      step.sum[c] = static_cast<float>(sum_[i][c]);
      step.bend[c] = static_cast<float>(rise * length / 8);
    }
  }
}

/// Of all lines with the right mean the one of least squares.
TimeCoder::Fit TimeCoder::fit(size_t first, size_t last) const {
  Fit line{};
  if (last == first + 1) {
    line.left = signal_[first].left;
    for (size_t c = 0; c < 4; ++c) line.step[c] = signal_[first].right[c] - line.left[c];
    return line;
  }
  const double begin = time_[first], length = time_[last] - begin;
  for (size_t c = 0; c < 4; ++c) {
    double sum = sum_[last][c] - sum_[first][c];
    double moment = moment_[last][c] - moment_[first][c] - begin * sum;  // about the beginning
    if (length < kShort) {
      sum = moment = 0;
      for (size_t i = first; i < last; ++i) {
        const double own = time_[i + 1] - time_[i], left = signal_[i].left[c], rise = signal_[i].right[c] - left;
        sum += own * (left + rise / 2);
        moment += (time_[i] - begin) * own * (left + rise / 2) + own * own * (left / 2 + rise / 3);
      }
    }
    line.step[c] = 12 / (length * length) * (moment - length / 2 * sum);
    line.left[c] = sum / length - line.step[c] / 2;
  }
  return line;
}

/// Is the integral of the line from its beginning to any instant within the limit of the signal's? Between two cuts
/// their difference is a parabola: it leaves the values at its ends by an eighth of its second derivative times the
/// square of its length at most.
bool TimeCoder::holds(size_t first, size_t last, const Fit& line) const {
  const double begin = time_[first];
  const auto length = static_cast<float>(time_[last] - begin);
  Lanes left{}, slope{};
  for (size_t c = 0; c < 4; ++c) {
    left[c] = static_cast<float>(line.left[c]);
    slope[c] = static_cast<float>(line.step[c]) / length;
  }
  const Lanes half_slope = slope / 2;
  Lanes before = absolute(slope * steps_[first].eighth - steps_[first].bend);
  for (size_t i = first + 1; i < last;) {
    Lanes excess = -limit_;
    for (const size_t end = std::min(last, i + kRun); i < end; ++i) {
      const Step& step = steps_[i];
      const auto since = static_cast<float>(step.time - begin);
      const Lanes off = steps_[first].sum - step.sum + since * (left + half_slope * since);
      const Lanes after = absolute(slope * step.eighth - step.bend);
      excess = larger(excess, absolute(off) + larger(before, after) - limit_);
      before = after;
    }
    if (std::max(std::max(excess[0], excess[1]), std::max(excess[2], excess[3])) > 0) return false;
  }
  return true;
}

/// What `holds` asks about, at most; in double precision.
Rgba TimeCoder::deviation(size_t first, size_t last, const Fit& line) const {
  Rgba most{};
  if (last == first + 1) return most;
  const double begin = time_[first], length = time_[last] - begin;
  Rgba before{};
  for (size_t i = first; i < last; ++i) {
    const double own = time_[i + 1] - time_[i], since = time_[i + 1] - begin;
    for (size_t c = 0; c < 4; ++c) {
      const double slope = line.step[c] / length, rise = signal_[i].right[c] - signal_[i].left[c];
      const double bend = std::abs(slope * own - rise) * own / 8;
      const double after = std::abs(sum_[first][c] - sum_[i + 1][c] + since * (line.left[c] + slope / 2 * since));
      most[c] = std::max(most[c], std::max(before[c], after) + bend);
      before[c] = after;
    }
  }
  return most;
}

/// The end of the longest piece that begins with `first`. Whether a piece holds depends on its end in no simple way,
/// but mostly it does up to some end and does not from there on: that one is looked for, from where the last piece's
/// was.
size_t TimeCoder::longest(size_t first, Fit& line) {
  const size_t end = signal_.size();
  size_t good = first + 1, bad = end + 1;  // ends
  line = fit(first, good);
  const auto test = [&](size_t last) {
    const Fit tried = fit(first, last);
    if (holds(first, last, tried)) {
      good = last;
      line = tried;
    } else {
      bad = last;
    }
  };
  size_t step = std::max<size_t>(1, last_count_ / 4);
  if (first + last_count_ > good) test(std::min(end, first + last_count_));
  if (bad > end) {  // as long as the last one, or longer
    for (; bad > end && good < end; step *= 2) test(std::min(end, good + step));
  } else {
    for (; good == first + 1 && bad > first + 1 + step; step *= 2) test(bad - step);
  }
  while (bad - good > 1 && good < end) test(good + (bad - good) / 2);
  last_count_ = good - first;
  return good;
}

void TimeCoder::append(size_t first, const Fit& line, TimeTile& out) {
  out.begin.push_back(signal_[first].begin);
  Four<uint16_t> left{}, step{};
  for (size_t c = 0; c < 4; ++c) {
    const double right = line.left[c] + line.step[c], mean = line.left[c] + line.step[c] / 2;
    left[c] = to_half(static_cast<float>(line.left[c]));
    const auto kept = static_cast<double>(from_half(left[c]));
    // The step that keeps the mean, in which what the left end lost or won comes back at the right end.
    const double rise = 2 * (mean - kept);
    step[c] = to_half(static_cast<float>(rise));
    if (std::abs(line.left[c]) > static_cast<double>(kMostHalf) || std::abs(rise) > static_cast<double>(kMostHalf)) {
      ++out.deviation.clamped;
      continue;
    }
    const double off =
        std::max(std::abs(kept - line.left[c]), std::abs(kept + static_cast<double>(from_half(step[c])) - right));
    out.deviation.rounding = std::max(out.deviation.rounding, static_cast<float>(off / scale_[c]));
  }
  out.halves.left.push_back(left);
  out.halves.step.push_back(step);
}

}  // namespace kairos
