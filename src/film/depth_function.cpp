#include "film/depth_function.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/time_signal.h"

namespace kairos {

void DepthFunction::add(float begin, float end, float dist_begin, float dist_end) {
  const auto tick = [](float time) {
    return static_cast<uint64_t>(std::clamp(static_cast<double>(time), 0.0, 1.0) * static_cast<double>(kTicks));
  };
  const Stretch stretch{tick(begin), tick(end), static_cast<double>(dist_begin), static_cast<double>(dist_end)};
  if (stretch.begin < stretch.end && std::isfinite(dist_begin) && std::isfinite(dist_end))
    stretches_.push_back(stretch);
}

/// Between two cuts nothing begins and nothing ends. The nearest of straight lines bends where they cross, and lies
/// above the line between its ends.
void DepthFunction::find_nearest() {
  cuts_.assign({0, kTicks});
  for (const Stretch& stretch : stretches_) cuts_.insert(cuts_.end(), {stretch.begin, stretch.end});
  std::sort(cuts_.begin(), cuts_.end());
  cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
  std::sort(stretches_.begin(), stretches_.end(), [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
  nearest_.clear();
  active_.clear();
  size_t next = 0;
  for (size_t i = 0; i + 1 < cuts_.size(); ++i) {
    constexpr double kNothing = std::numeric_limits<double>::infinity();
    Stretch nearest{cuts_[i], cuts_[i + 1], kNothing, kNothing};
    std::erase_if(active_, [&](const Stretch& stretch) { return stretch.end <= nearest.begin; });
    for (; next < stretches_.size() && stretches_[next].begin == nearest.begin; ++next)
      active_.push_back(stretches_[next]);
    for (const Stretch& stretch : active_) {
      nearest.from = std::min(nearest.from, stretch.at(nearest.begin));
      nearest.to = std::min(nearest.to, stretch.at(nearest.end));
    }
    nearest_.push_back(nearest);
  }
}

void DepthFunction::append_to(DepthPieces& out) {
  if (out.first.empty()) out.first.push_back(0);
  find_nearest();
  for (size_t i = 0; i < nearest_.size();) {
    const Stretch& start = nearest_[i];
    double right = start.to;
    size_t next = i + 1;
    if (std::isinf(start.from)) {
      while (next < nearest_.size() && std::isinf(nearest_[next].from)) ++next;
    } else {
      // Slopes of lines from the start that pass by all ends so far: this wedge narrows until it is empty.
      double least = -std::numeric_limits<double>::infinity(), most = -least;
      const auto narrow = [&](uint64_t tick, double value) {
        const double room = tolerance_ * std::abs(value), time = static_cast<double>(tick - start.begin);
        least = std::max(least, (value - room - start.from) / time);
        most = std::min(most, (value + room - start.from) / time);
      };
      narrow(start.end, start.to);
      for (; next < nearest_.size() && !std::isinf(nearest_[next].from); ++next) {
        const double low = least, high = most;
        narrow(nearest_[next].begin, nearest_[next].from);
        narrow(nearest_[next].end, nearest_[next].to);
        if (least > most) {
          least = low;
          most = high;
          break;
        }
      }
      const Stretch& last = nearest_[next - 1];
      const double time = static_cast<double>(last.end - start.begin);
      right = start.from + std::clamp((last.to - start.from) / time, least, most) * time;
      if (next == i + 1) right = start.to;
    }
    out.begin.push_back(static_cast<uint32_t>(start.begin));
    out.left.push_back(static_cast<float>(start.from));
    out.right.push_back(static_cast<float>(right));
    i = next;
  }
  out.first.push_back(static_cast<uint32_t>(out.begin.size()));
}

}  // namespace kairos
