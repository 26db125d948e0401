#include "study/curve.h"

#include <algorithm>
#include <cmath>

namespace kairos::study {

namespace {

/// Where x lies on the line through (x0, y0) and (x1, y1).
double on_line(double x0, double y0, double x1, double y1, double x) { return y0 + (y1 - y0) * ((x - x0) / (x1 - x0)); }

double psnr_on(const CurvePoint& a, const CurvePoint& b, double seconds) {
  return on_line(std::log(a.seconds), a.psnr, std::log(b.seconds), b.psnr, std::log(seconds));
}
double seconds_on(const CurvePoint& a, const CurvePoint& b, double psnr) {
  return std::exp(on_line(a.psnr, std::log(a.seconds), b.psnr, std::log(b.seconds), psnr));
}

}  // namespace

Curve::Curve(std::vector<CurvePoint> points) {
  std::erase_if(points, [](const CurvePoint& p) {
    return !std::isfinite(p.psnr) || !std::isfinite(p.seconds) || p.seconds <= 0;
  });
  std::sort(points.begin(), points.end(), [](const CurvePoint& a, const CurvePoint& b) {
    return a.seconds != b.seconds ? a.seconds < b.seconds : a.psnr > b.psnr;
  });
  for (const CurvePoint& p : points)
    if (points_.empty() || points_.back().seconds != p.seconds) points_.push_back(p);
}

std::optional<double> Curve::psnr_at(double seconds) const {
  if (points_.empty()) return std::nullopt;
  const size_t count = points_.size();
  const CurvePoint &first = points_.front(), &last = points_.back();
  if (count == 1) return seconds == first.seconds ? std::optional(first.psnr) : std::nullopt;
  if (!(seconds >= first.seconds / kReach && seconds <= last.seconds * kReach)) return std::nullopt;
  const auto above = std::upper_bound(points_.begin(), points_.end(), seconds,
                                      [](double value, const CurvePoint& p) { return value < p.seconds; });
  const size_t right = std::clamp<size_t>(static_cast<size_t>(above - points_.begin()), 1, count - 1);
  return psnr_on(points_[right - 1], points_[right], seconds);
}

std::optional<double> Curve::seconds_at(double psnr) const {
  const size_t count = points_.size();
  if (count == 0) return std::nullopt;
  const CurvePoint& first = points_.front();
  if (first.psnr == psnr) return first.seconds;
  if (count == 1) return std::nullopt;
  if (first.psnr > psnr) {  // before its first point
    if (!(points_[1].psnr > first.psnr)) return std::nullopt;
    const double seconds = seconds_on(first, points_[1], psnr);
    return seconds >= first.seconds / kReach ? std::optional(seconds) : std::nullopt;
  }
  for (size_t i = 1; i < count; ++i)
    if (points_[i].psnr >= psnr) return seconds_on(points_[i - 1], points_[i], psnr);
  const CurvePoint &before = points_[count - 2], &last = points_.back();  // after its last
  if (!(last.psnr > before.psnr)) return std::nullopt;
  const double seconds = seconds_on(before, last, psnr);
  return seconds <= last.seconds * kReach ? std::optional(seconds) : std::nullopt;
}

}  // namespace kairos::study
