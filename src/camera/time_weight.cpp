#include <algorithm>
#include <cmath>
#include <utility>

#include <kairos/error.h>
#include <kairos/time_weight.h>

namespace kairos {

namespace {

using Point = TimeWeight::Point;

double between(const Point& first, const Point& second, double time) {
  if (time <= first.time) return first.weight;
  if (time >= second.time) return second.weight;
  return first.weight + (second.weight - first.weight) * ((time - first.time) / (second.time - first.time));
}

[[noreturn]] void refuse(const char* what) { throw Error(ErrorCode::bad_usage, "TimeWeight", what); }

}  // namespace

struct TimeWeight::Curve {
  std::vector<Point> points;
  std::vector<double> sums;  // [point]: the integral before it

  explicit Curve(std::vector<Point> given) : points(std::move(given)), sums(points.size()) {
    for (size_t i = 1; i < points.size(); ++i)
      sums[i] = sums[i - 1] + 0.5 * (points[i - 1].weight + points[i].weight) * (points[i].time - points[i - 1].time);
  }
};

TimeWeight::TimeWeight(std::vector<Point> points) {
  if (points.size() < 2) refuse("give at least two points");
  for (size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].time >= 0 && points[i].time <= 1)) refuse("times must be 0 to 1");
    if (!std::isfinite(points[i].weight)) refuse("weights must be finite");
    if (i > 0 && points[i].time < points[i - 1].time) refuse("times must not descend");
  }
  curve_ = std::make_shared<const Curve>(std::move(points));
}

TimeWeight TimeWeight::stretched(double begin, double end, double scale) const {
  if (!(begin < end) || !std::isfinite(end - begin)) refuse("must begin before it ends");
  if (!std::isfinite(scale)) refuse("weights must be finite");
  static const std::shared_ptr<const Curve> box = std::make_shared<const Curve>(std::vector<Point>{{0, 1}, {1, 1}});
  TimeWeight result = *this;
  if (!curve_) result.curve_ = box;
  result.begin_ = begin + (end - begin) * begin_;
  result.length_ = (end - begin) * length_;
  result.scale_ = scale * scale_;
  return result;
}

std::vector<Point> TimeWeight::points() const {
  if (is_box()) return {{0, 1}, {1, 1}};
  std::vector<Point> result = curve_->points;
  for (Point& point : result) point = {begin_ + length_ * point.time, scale_ * point.weight};
  return result;
}

double TimeWeight::at(double time) const {
  if (is_box()) return time >= 0 && time <= 1 ? 1 : 0;
  const double place = (time - begin_) / length_;
  const std::vector<Point>& points = curve_->points;
  if (place < points.front().time || place > points.back().time) return 0;
  // The point after the time, or the last: of a step's two points the later one counts.
  const auto after = std::upper_bound(points.begin() + 1, points.end() - 1, place,
                                      [](double value, const Point& point) { return value < point.time; });
  return between(after[-1], after[0], place) * scale_;
}

double TimeWeight::integral(double begin, double end) const {
  if (is_box()) return end - begin;
  const auto [first, second] = moments(begin, end);
  return first + second;
}

std::array<double, 2> TimeWeight::moments(double begin, double end) const {
  if (is_box()) return {(end - begin) / 2, (end - begin) / 2};
  std::array<double, 2> sums{};
  begin = (begin - begin_) / length_;
  end = (end - begin_) / length_;
  if (!(begin < end)) return sums;
  const std::vector<Point>& points = curve_->points;
  auto point = std::upper_bound(points.begin(), points.end(), begin,
                                [](double value, const Point& p) { return value < p.time; });
  if (point != points.begin()) --point;
  for (; point + 1 != points.end() && point->time < end; ++point) {
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
  return {sums[0] * (scale_ * length_), sums[1] * (scale_ * length_)};
}

double TimeWeight::sum() const { return is_box() ? 1 : curve_->sums.back() * (scale_ * length_); }

double TimeWeight::variation() const {
  if (is_box()) return 2;
  const std::vector<Point>& points = curve_->points;
  double rises = std::abs(points.front().weight) + std::abs(points.back().weight);
  for (size_t i = 1; i < points.size(); ++i) rises += std::abs(points[i].weight - points[i - 1].weight);
  return rises * std::abs(scale_);
}

double TimeWeight::quantile(double share) const {
  if (is_box()) return share;
  const std::vector<double>& sums = curve_->sums;
  const double wanted = std::clamp(share, 0.0, 1.0) * sums.back();
  const auto after = std::upper_bound(sums.begin() + 1, sums.end() - 1, wanted);
  const auto i = static_cast<size_t>(after - sums.begin());
  const Point &first = curve_->points[i - 1], &second = curve_->points[i];
  const double length = second.time - first.time, left = wanted - sums[i - 1];
  const double slope = (second.weight - first.weight) / std::max(length, 1e-300);
  // Solves weight x s + slope s^2 / 2 = left for s, in the form that does not cancel.
  const double root = std::sqrt(std::max(0.0, first.weight * first.weight + 2 * slope * left));
  const double denominator = first.weight + root;
  const double s = denominator > 0 ? std::min(2 * left / denominator, length) : 0;
  return begin_ + length_ * (first.time + s);
}

bool TimeWeight::has_negative() const {
  if (is_box()) return false;
  return std::any_of(curve_->points.begin(), curve_->points.end(),
                     [&](const Point& point) { return point.weight * scale_ < 0; });
}

}  // namespace kairos
