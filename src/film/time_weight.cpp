#include <algorithm>
#include <cmath>

#include <kairos/error.h>
#include <kairos/time_weight.h>

namespace kairos {

namespace {

double between(const TimeWeight::Point& first, const TimeWeight::Point& second, double time) {
  if (time <= first.time) return first.weight;
  if (time >= second.time) return second.weight;
  return first.weight + (second.weight - first.weight) * ((time - first.time) / (second.time - first.time));
}

}  // namespace

TimeWeight::TimeWeight(std::vector<Point> points) : points_(std::move(points)) {
  const auto refuse = [](const char* what) { throw Error(ErrorCode::bad_usage, "TimeWeight", what); };
  if (points_.size() < 2) refuse("give at least two points");
  for (size_t i = 0; i < points_.size(); ++i) {
    if (!(points_[i].time >= 0 && points_[i].time <= 1)) refuse("times must be 0 to 1");
    if (!std::isfinite(points_[i].weight)) refuse("weights must be finite");
    if (i > 0 && points_[i].time < points_[i - 1].time) refuse("times must not descend");
  }
}

std::vector<TimeWeight::Point> TimeWeight::points() const {
  if (is_box()) return {{0, 1}, {1, 1}};
  return points_;
}

double TimeWeight::at(double time) const {
  if (is_box()) return time >= 0 && time <= 1 ? 1 : 0;
  if (time < points_.front().time || time > points_.back().time) return 0;
  // The point after the time, or the last: of a step's two points the later one counts.
  const auto after = std::upper_bound(points_.begin() + 1, points_.end() - 1, time,
                                      [](double value, const Point& point) { return value < point.time; });
  return between(after[-1], after[0], time);
}

double TimeWeight::integral(double begin, double end) const {
  if (is_box()) return end - begin;
  const auto [first, second] = moments(begin, end);
  return first + second;
}

std::array<double, 2> TimeWeight::moments(double begin, double end) const {
  if (is_box()) return {(end - begin) / 2, (end - begin) / 2};
  std::array<double, 2> sums{};
  if (!(begin < end)) return sums;
  auto point = std::upper_bound(points_.begin(), points_.end(), begin,
                                [](double value, const Point& p) { return value < p.time; });
  if (point != points_.begin()) --point;
  for (; point + 1 != points_.end() && point->time < end; ++point) {
    const double from = std::max(begin, point[0].time), to = std::min(end, point[1].time);
    if (!(from < to)) continue;
    // Simpson's rule is exact for a product of two straight lines.
    const double middle = 0.5 * (from + to);
    for (const auto& [time, share] : {std::pair(from, 1.0), std::pair(middle, 4.0), std::pair(to, 1.0)}) {
      const double weight = between(point[0], point[1], time) * share * (to - from) / 6;
      const double place = (time - begin) / (end - begin);
      sums[0] += weight * (1 - place);
      sums[1] += weight * place;
    }
  }
  return sums;
}

}  // namespace kairos
