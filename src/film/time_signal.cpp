#include "film/time_signal.h"

#include <algorithm>
#include <cmath>

namespace kairos {

namespace {

Rgba colour_of(const Vec3f& colour, double coverage) {
  return {static_cast<double>(colour.x), static_cast<double>(colour.y), static_cast<double>(colour.z), coverage};
}

Rgba difference(const Rgba& to, const Rgba& from, double scale) {
  Rgba result;
  for (size_t c = 0; c < 4; ++c) result[c] = (to[c] - from[c]) * scale;
  return result;
}

void add_to(Rgba& sum, const Rgba& value, double scale) {
  for (size_t c = 0; c < 4; ++c) sum[c] += value[c] * scale;
}

uint64_t tick_of(float time) {
  return static_cast<uint64_t>(std::clamp(static_cast<double>(time), 0.0, 1.0) * static_cast<double>(kTicks));
}

bool is_zero(const Rgba& value) { return value == Rgba{}; }

double coverage_of(const SeenPart& part) { return part.where.mesh == kNoMesh ? 0 : 1; }

/// What layers seen at the same time make of the parts behind each other.
struct Layering {
  double open = 1;
  double covered = 0;  // by layers that count, though there may be others
  bool sky = false;

  /// Returns how much of the layer is seen.
  double pass(const SeenPart& layer, bool counts) {
    const double share = open * static_cast<double>(layer.opacity);
    if (layer.where.mesh == kNoMesh) {
      sky = true;
    } else {
      open *= 1 - static_cast<double>(layer.opacity);
      if (counts) covered += share;
    }
    return share;
  }
  /// How much of the background is seen through them.
  double gap() const { return sky ? 0 : open; }
};

/// Parts that are seen at the same time: the first of `parts` and those right behind it.
std::span<const SeenPart> layers_at(std::span<const SeenPart> parts, size_t first) {
  size_t next = first + 1;
  while (next < parts.size() && parts[next].layer > 0) ++next;
  return parts.subspan(first, next - first);
}

bool is_opaque(std::span<const SeenPart> layers) { return layers.size() == 1 && layers[0].opacity == 1; }

}  // namespace

/// What changes at a tick: in the event before, if that is at the same one.
TimeSignal::Event& TimeSignal::event(uint64_t tick) {
  if (!order_.empty() && order_.back() >> 32 == tick) return events_.back();
  order_.push_back(tick << 32 | events_.size());
  return events_.emplace_back();
}

/// Notes how much of the signal's variation lies at a cut that may have been rounded.
void TimeSignal::vary(const Rgba& by) {
  for (size_t c = 0; c < 4; ++c) variation_[c] += std::abs(by[c]);
}

void TimeSignal::jump(uint64_t tick, const Rgba& by) {
  vary(by);
  if (tick >= kTicks || is_zero(by)) return;
  if (tick == 0) return add_to(start_, by, 1);
  add_to(event(tick).jump, by, 1);
}

void TimeSignal::turn(uint64_t tick, const Rgba& by) {
  if (tick < kTicks && !is_zero(by)) add_to(event(tick).slope, by, 1);
}

std::span<const SignalPiece> TimeSignal::make(const PixelRecord& record) {
  mesh_.reset();
  background_ = colour_of(record.background, 0);
  return make_counted(record);
}

std::span<const SignalPiece> TimeSignal::make_of_mesh(const PixelRecord& record, uint32_t mesh) {
  mesh_ = mesh;
  background_ = {};
  return make_counted(record);
}

bool TimeSignal::any_counts(std::span<const SeenPart> layers) const {
  return std::any_of(layers.begin(), layers.end(), [&](const SeenPart& layer) { return counts(layer); });
}

std::span<const SignalPiece> TimeSignal::make_counted(const PixelRecord& record) {
  record_ = &record;
  start_ = variation_ = {};
  events_.clear();
  order_.clear();
  double weights = 0;
  for (const PixelRay& ray : record.rays) weights += static_cast<double>(ray.weight);
  if (weights > 0)
    for (const PixelRay& ray : record.rays) add(ray, static_cast<double>(ray.weight) / weights);
  if (!record.still.rays.empty()) {
    const auto add_still = [&](std::span<const PixelRay> rays, double share) {
      double sum = 0;
      for (const PixelRay& ray : rays) sum += static_cast<double>(ray.weight);
      if (!(sum > 0)) return;
      for (const PixelRay& ray : rays) add_instant(record.parts_of(ray), share * static_cast<double>(ray.weight) / sum);
    };
    add_still(record.still.rays, static_cast<double>(record.still.share));
    add_still(record.still.rays.first(record.still.own), -static_cast<double>(record.still.share));
  }
  sweep();
  return pieces_;
}

/// What a ray of one instant sees, all the time.
void TimeSignal::add_instant(std::span<const SeenPart> parts, double share) {
  if (parts.empty()) return add_to(start_, background_, share);
  for (size_t first = 0; first < parts.size();) {
    const auto layers = layers_at(parts, first);
    Layering layering;
    for (const SeenPart& layer : layers) {
      const double passed = layering.pass(layer, counts(layer));
      if (counts(layer)) add_to(start_, colour_of(record_->knots[layer.first_knot].colour, 0), share * passed);
    }
    add_to(start_, background_, share * layering.gap());
    start_[3] += share * layering.covered;
    first += layers.size();
  }
}

void TimeSignal::add(const PixelRay& ray, double share) {
  const std::span<const SeenPart> parts = record_->parts_of(ray);
  if (!ray.is_over_time()) return add_instant(parts, share);
  const Rgba& background = background_;
  add_to(start_, background, share);
  Rgba level = background;  // the ray's, before `until`; from there on the background's unless something begins
  uint64_t until = 0;
  const auto step_to = [&](uint64_t tick, const Rgba& value) {
    jump(tick, difference(value, level, share));
    level = value;
  };
  for (size_t first = 0; first < parts.size();) {
    const auto layers = layers_at(parts, first);
    first += layers.size();
    const SeenPart& part = layers[0];
    const uint64_t begin = tick_of(part.where.begin), end = tick_of(part.where.end);
    if (begin >= end || (mesh_ && !any_counts(layers))) continue;
    if (until < begin) step_to(until, background);
    if (!is_opaque(layers)) {
      step_to(begin, background);
      add_layers(layers, share);
    } else if (part.knots > 1) {
      step_to(begin, background);
      add_knots(part, background, share, coverage_of(part));
    } else {
      step_to(begin, colour_of(record_->knots[part.first_knot].colour, coverage_of(part)));
    }
    until = end;
  }
  step_to(until, background);
}

/// Straight lines between the knots of a part, in place of `outside`.
void TimeSignal::add_knots(const SeenPart& part, const Rgba& outside, double share, double coverage) {
  const std::span<const Knot> knots = record_->knots_of(part);
  const auto tick = [&](const Knot& knot) { return tick_of(std::clamp(knot.time, part.where.begin, part.where.end)); };
  Rgba level = colour_of(knots[0].colour, coverage), slope{};
  jump(tick_of(part.where.begin), difference(level, outside, share));
  uint64_t from = tick(knots[0]);
  for (size_t i = 1; i < knots.size(); ++i) {
    const uint64_t to = tick(knots[i]);
    const Rgba next = colour_of(knots[i].colour, coverage), rise = difference(next, level, share);
    level = next;
    if (from >= to) {
      jump(to, rise);
      continue;
    }
    vary(rise);
    const Rgba next_slope = difference(rise, {}, 1 / static_cast<double>(to - from));
    turn(from, difference(next_slope, slope, 1));
    slope = next_slope;
    from = to;
  }
  turn(from, difference({}, slope, 1));
  jump(tick_of(part.where.end), difference(outside, level, share));
}

/// Layers seen at the same time, from front to back, in place of the background.
void TimeSignal::add_layers(std::span<const SeenPart> layers, double share) {
  Layering layering;
  for (const SeenPart& layer : layers) {
    const double passed = layering.pass(layer, counts(layer));
    if (counts(layer)) add_knots(layer, {}, share * passed, 0);
  }
  Rgba behind = background_;
  for (double& value : behind) value *= layering.gap() - 1;
  behind[3] = layering.covered;
  const SeenPart& front = layers[0];
  jump(tick_of(front.where.begin), difference(behind, {}, share));
  jump(tick_of(front.where.end), difference({}, behind, share));
}

/// Sorts events by their ticks. Rays see much the same, so ticks lie all over the time: a few fall into each of its
/// equal parts.
void TimeSignal::sort_events() {
  constexpr size_t kFew = 32, kParts = 256;
  constexpr int kPartShift = 56;  // of a key: its tick's uppermost bits
  if (order_.size() > kFew) {
    std::array<uint32_t, kParts + 1> ends{};
    for (const uint64_t key : order_) ++ends[(key >> kPartShift) + 1];
    for (size_t i = 0; i < kParts; ++i) ends[i + 1] += ends[i];
    sorted_.resize(order_.size());
    const auto begins = ends;
    for (const uint64_t key : order_) sorted_[ends[key >> kPartShift]++] = key;
    order_.swap(sorted_);
    const auto at = [&](uint32_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    for (size_t i = 0; i < kParts; ++i)
      if (begins[i + 1] > begins[i] + kFew) std::sort(at(begins[i]), at(begins[i + 1]));
  }
  for (size_t i = 1; i < order_.size(); ++i) {
    const uint64_t key = order_[i];
    size_t place = i;
    for (; place > 0 && order_[place - 1] > key; --place) order_[place] = order_[place - 1];
    order_[place] = key;
  }
}

void TimeSignal::sweep() {
  sort_events();
  pieces_.clear();
  pieces_.push_back({0, start_, {}});
  Rgba value = start_, slope{};
  uint64_t now = 0;
  const auto go_to = [&](uint64_t tick) {
    add_to(value, slope, static_cast<double>(tick - now));
    pieces_.back().right = value;
    now = tick;
  };
  for (const uint64_t key : order_) {
    const uint64_t tick = key >> 32;
    if (tick != now) {
      go_to(tick);
      pieces_.push_back({static_cast<uint32_t>(tick), {}, {}});
    }
    const Event& event = events_[key & 0xffffffffu];
    for (size_t c = 0; c < 4; ++c) {
      value[c] += event.jump[c];
      slope[c] += event.slope[c];
    }
    pieces_.back().left = value;
  }
  go_to(kTicks);
  shift_ = *std::max_element(variation_.begin(), variation_.end()) * kTick;
}

}  // namespace kairos
