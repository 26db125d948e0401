#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <kairos/event_compare.h>

namespace kairos {

namespace {

/// By pixel, polarity and time.
std::vector<Event> by_pixel(std::span<const Event> events) {
  std::vector<Event> sorted(events.begin(), events.end());
  std::sort(sorted.begin(), sorted.end(), [](const Event& a, const Event& b) {
    return std::tuple(a.y, a.x, a.polarity, a.time) < std::tuple(b.y, b.x, b.polarity, b.time);
  });
  return sorted;
}

/// -1 or 1 where one belongs to an earlier pixel or polarity; 0: they may be partners.
int order(const Event& a, const Event& b) {
  const std::tuple left(a.y, a.x, a.polarity), right(b.y, b.x, b.polarity);
  return left < right ? -1 : right < left ? 1 : 0;
}

/// The claimed brightness of a pixel is a staircase in each stream; their difference is one, too.
void compare_brightness(std::span<const Event> reference, std::span<const Event> events, EventDifference& result) {
  struct Step {
    int32_t y, x;
    int64_t time;
    int change;
  };
  std::vector<Step> steps;
  steps.reserve(reference.size() + events.size());
  for (const Event& event : reference) steps.push_back({event.y, event.x, event.time, -event.polarity});
  for (const Event& event : events) steps.push_back({event.y, event.x, event.time, event.polarity});
  if (steps.empty()) return;
  const auto [first, last] =
      std::minmax_element(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.time < b.time; });
  const int64_t end = last->time;
  const auto length = static_cast<double>(end - first->time);
  if (!(length > 0)) return;
  std::sort(steps.begin(), steps.end(),
            [](const Step& a, const Step& b) { return std::tuple(a.y, a.x, a.time) < std::tuple(b.y, b.x, b.time); });
  double sum = 0, squares = 0, pixels = 0, apart = 0;
  for (size_t i = 0; i < steps.size(); ++i) {
    const bool is_last =
        i + 1 == steps.size() || std::tie(steps[i].y, steps[i].x) != std::tie(steps[i + 1].y, steps[i + 1].x);
    apart += steps[i].change;
    const double share = static_cast<double>((is_last ? end : steps[i + 1].time) - steps[i].time) / length;
    sum += std::abs(apart) * share;
    squares += apart * apart * share;
    if (!is_last) continue;
    ++pixels;
    apart = 0;
  }
  result.brightness_mean = sum / pixels;
  result.brightness_rms = std::sqrt(squares / pixels);
}

}  // namespace

EventDifference compare_events(std::span<const Event> reference, std::span<const Event> events, int64_t window) {
  const std::vector<Event> wanted = by_pixel(reference), given = by_pixel(events);
  EventDifference result;
  result.reference = wanted.size();
  result.events = given.size();
  compare_brightness(reference, events, result);
  std::vector<double> apart;
  for (size_t i = 0, j = 0; i < wanted.size() || j < given.size();) {
    const int first = i == wanted.size() ? 1 : j == given.size() ? -1 : order(wanted[i], given[j]);
    const int64_t delay = first == 0 ? given[j].time - wanted[i].time : 0;
    if (first < 0 || delay > window) {
      ++result.missing;
      ++i;
    } else if (first > 0 || -delay > window) {
      ++result.extra;
      ++j;
    } else {
      apart.push_back(std::abs(static_cast<double>(delay)));
      ++i;
      ++j;
    }
  }
  result.matched = apart.size();
  if (apart.empty()) return result;
  std::sort(apart.begin(), apart.end());
  const auto quantile = [&](double share) {
    return apart[static_cast<size_t>(share * static_cast<double>(apart.size() - 1))];
  };
  double squares = 0;
  for (const double value : apart) squares += value * value;
  result.median = quantile(0.5);
  result.p95 = quantile(0.95);
  result.most = apart.back();
  result.rms = std::sqrt(squares / static_cast<double>(apart.size()));
  return result;
}

double pillar_share(std::span<const Event> events) {
  constexpr size_t kBusiest = 20;
  std::vector<uint64_t> counts;
  for (size_t i = 0; i < events.size();) {
    const int64_t stamp = events[i].time / 1000;
    size_t next = i;
    while (next < events.size() && events[next].time / 1000 == stamp) ++next;
    counts.push_back(next - i);
    i = next;
  }
  std::sort(counts.rbegin(), counts.rend());
  uint64_t sum = 0;
  for (size_t i = 0; i < std::min(kBusiest, counts.size()); ++i) sum += counts[i];
  return events.empty() ? 0 : static_cast<double>(sum) / static_cast<double>(events.size());
}

}  // namespace kairos
