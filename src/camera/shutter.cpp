#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/shutter.h>

namespace kairos {

namespace {

/// Of the shot's time: what unit conversions round away, and a thousandth of a pixel's way even at great speed.
constexpr double kRounding = 1e-9;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::bad_usage, "shutter", what); }

bool by_rows(const Shutter& shutter) { return shutter.scan == Scan::top || shutter.scan == Scan::bottom; }

int line_count(const Shutter& shutter, int width, int height) { return by_rows(shutter) ? height : width; }

int line_of(const Shutter& shutter, int x, int y, int width, int height) {
  switch (shutter.scan) {
    case Scan::top:
      return y;
    case Scan::bottom:
      return height - 1 - y;
    case Scan::left:
      return x;
    case Scan::right:
      return width - 1 - x;
  }
  return y;
}

}  // namespace

ExposureInterval line_interval(const Shutter& shutter, int line) {
  const double number = static_cast<double>(shutter.first_line) + line;
  return {shutter.open + number * shutter.open_line, shutter.close + number * shutter.close_line};
}

ExposureInterval whole_interval(const Shutter& shutter, int width, int height) {
  ExposureInterval whole{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto add = [&](double open, double close) {
    whole.open = std::min(whole.open, open);
    whole.close = std::max(whole.close, close);
  };
  if (shutter.map) {
    for (size_t i = 0; i < std::min(shutter.map->open.size(), shutter.map->close.size()); ++i)
      add(static_cast<double>(shutter.map->open[i]), static_cast<double>(shutter.map->close[i]));
    return whole;
  }
  for (const int line : {0, line_count(shutter, width, height) - 1}) {
    const ExposureInterval interval = line_interval(shutter, line);
    add(interval.open, interval.close);
  }
  return whole;
}

struct Exposure::Data {
  Shutter shutter;
  double frame_time;
  int width, height;
  double shot_open, shot_close;
  double curve_sum;
  double shortest = std::numeric_limits<double>::infinity();
  std::vector<TimeWeight> lines;  // none: by the map

  TimeWeight weight_of(const ExposureInterval& interval) const {
    const double length = shot_close - shot_open;
    double begin = (frame_time + interval.open - shot_open) / length,
           end = (frame_time + interval.close - shot_open) / length;
    if (end - begin < kShortest) {
      const double middle = std::clamp(0.5 * (begin + end), kShortest / 2, 1 - kShortest / 2);
      begin = middle - kShortest / 2;
      end = middle + kShortest / 2;
    }
    // As segments' ends are.
    begin = static_cast<double>(static_cast<float>(std::clamp(begin, 0.0, 1.0)));
    end = static_cast<double>(static_cast<float>(std::clamp(end, 0.0, 1.0)));
    const double integral = shutter.normalise == Normalise::energy
                                ? (interval.close - interval.open) / (shutter.close - shutter.open) * curve_sum
                                : 1;
    return shutter.curve.stretched(begin, end, integral / ((end - begin) * curve_sum));
  }

  void check(const ExposureInterval& interval, const std::string& whose) {
    if (!std::isfinite(interval.open) || !std::isfinite(interval.close))
      refuse(fmt::format("{} has an interval that is not finite", whose));
    if (interval.open > interval.close)
      refuse(fmt::format("{} closes before it opens: it is exposed from {:.9g} to {:.9g} s", whose, interval.open,
                         interval.close));
    const double slack = kRounding * (shot_close - shot_open);
    const double early = shot_open - (frame_time + interval.open), late = frame_time + interval.close - shot_close;
    if (std::max(early, late) > slack)
      refuse(fmt::format("{} is exposed {:.9g} s {} what was recorded, which goes from {:.9g} to {:.9g} s", whose,
                         std::max(early, late), early > late ? "before" : "after", shot_open - frame_time,
                         shot_close - frame_time));
    shortest = std::min(shortest, std::max(kShortest, (interval.close - interval.open) / (shot_close - shot_open)));
  }
};

Exposure::Exposure(const Shutter& shutter, double frame_time, int width, int height, double shot_open,
                   double shot_close) {
  if (width < 1 || height < 1) refuse("is laid over a frame without pixels");
  if (!(shot_open < shot_close)) refuse("is laid over a shot without duration");
  for (const double number :
       {frame_time, shot_open, shot_close, shutter.open, shutter.close, shutter.open_line, shutter.close_line})
    if (!std::isfinite(number)) refuse("times must be finite");
  auto data = std::make_shared<Data>();
  data->shutter = shutter;
  data->frame_time = frame_time;
  data->width = width;
  data->height = height;
  data->shot_open = shot_open;
  data->shot_close = shot_close;
  data->curve_sum = shutter.curve.sum();
  if (!(std::abs(data->curve_sum) > 0)) refuse("has a curve whose integral is zero");
  if (shutter.normalise == Normalise::energy && !(shutter.open < shutter.close))
    refuse("of no duration gathers no energy");
  if (shutter.map) {
    const IntervalMap& map = *shutter.map;
    if (map.width != width || map.height != height || map.open.size() != map.close.size() ||
        map.open.size() != static_cast<size_t>(width) * static_cast<size_t>(height))
      refuse(fmt::format("has a map of {}x{} pixels for a frame of {}x{}", map.width, map.height, width, height));
    for (size_t i = 0; i < map.open.size(); ++i)
      data->check({static_cast<double>(map.open[i]), static_cast<double>(map.close[i])},
                  fmt::format("pixel {},{}", i % static_cast<size_t>(width), i / static_cast<size_t>(width)));
  } else {
    for (int line = 0; line < line_count(shutter, width, height); ++line) {
      const ExposureInterval interval = line_interval(shutter, line);
      data->check(interval, fmt::format("line {}", line + shutter.first_line));
      data->lines.push_back(data->weight_of(interval));
    }
  }
  data_ = std::move(data);
}

TimeWeight Exposure::weight(int x, int y) const {
  const Data& data = *data_;
  if (!data.lines.empty()) return data.lines[static_cast<size_t>(line_of(data.shutter, x, y, data.width, data.height))];
  const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(data.width) + static_cast<size_t>(x);
  const IntervalMap& map = *data.shutter.map;
  return data.weight_of({static_cast<double>(map.open[pixel]), static_cast<double>(map.close[pixel])});
}

const Shutter& Exposure::shutter() const { return data_->shutter; }
double Exposure::frame_time() const { return data_->frame_time; }
int Exposure::width() const { return data_->width; }
int Exposure::height() const { return data_->height; }
double Exposure::shot_open() const { return data_->shot_open; }
double Exposure::shot_close() const { return data_->shot_close; }
double Exposure::shortest() const { return data_->shortest; }

}  // namespace kairos
