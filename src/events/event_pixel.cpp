#include "events/event_pixel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "math/hash.h"

namespace kairos {

namespace {

// Kinds of random numbers of a pixel.
enum : uint64_t { kOn = 1, kOff, kLeak, kLeakJitter, kWait, kStrike, kSide, kLevel };

constexpr double kLeastThreshold = 0.01;

/// In (0, 1): never one of the ends, which logarithms would not take.
double unit(uint64_t bits) { return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53; }
/// Of mean 0 and deviation 1, by G. Box and M. Muller 1958.
double normal(uint64_t bits) {
  return std::sqrt(-2 * std::log(unit(bits))) * std::cos(2 * std::numbers::pi * unit(hash(bits, 1)));
}

/// Where in [begin, end] a monotone function passes `target`, which lies between its values there.
template <class Value>
double where_passed(const Value& value, double begin, double end, double target) {
  const bool rises = value(end) > value(begin);
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (begin + end);
    if (!(begin < middle && middle < end)) break;
    ((value(middle) < target) == rises ? begin : end) = middle;
  }
  return end;
}

/// The brightness itself over a piece of light. Its thresholds are those of the logarithm, raised.
struct BrightnessRun {
  double begin, length;  // seconds
  double c0, c1, c2;     // over the piece, from 0 to 1
  double least;          // a parabola through what is clamped may dip below it

  BrightnessRun(double from, double to, double first, double middle, double last, double dark)
      : begin(from),
        length(to - from),
        c0(first),
        c1(4 * middle - 3 * first - last),
        c2(2 * (first - 2 * middle + last)),
        least(dark) {}

  double value(double at) const {
    const double x = at / length;
    return std::max(c0 + x * (c1 + x * c2), least);
  }
  double signal(double at) const { return std::log(value(at)); }
  void set_leak(double /*fall*/) {}
  static double threshold(double level, double /*since*/) { return std::exp(level); }
  /// Where it stops to rise or fall.
  std::array<double, 2> turns() const {
    const double none = length;
    return {c2 != 0 ? -c1 / (2 * c2) * length : none, none};
  }
  double solve(double from, double to, double target) const {
    const double half = 0.5 * c1, offset = c0 - target;
    const double root = std::sqrt(std::max(half * half - c2 * offset, 0.0));
    // The larger of the two numerators, so that nothing cancels.
    const double q = -(half + std::copysign(root, half));
    // Of the two the one within; by rounding it may lie just beyond.
    const auto beyond = [&](double at) {
      return std::isfinite(at) ? std::max({from - at, at - to, 0.0}) : length + to;
    };
    const double one = q / c2 * length, other = offset / q * length;
    const double nearer = beyond(one) < beyond(other) || (beyond(one) == beyond(other) && one < other) ? one : other;
    return std::isfinite(nearer) ? std::clamp(nearer, from, to) : to;
  }
};

/// The logarithm of that, while the level leaks.
struct LeakingRun {
  BrightnessRun light;
  double begin, length, fall = 0;

  explicit LeakingRun(const BrightnessRun& of) : light(of), begin(of.begin), length(of.length) {}
  void set_leak(double per_second) { fall = per_second; }

  /// As if the signal rose instead of the level falling, from `begin` on.
  double value(double at) const { return light.signal(at) + fall * at; }
  double signal(double at) const { return light.signal(at); }
  double threshold(double level, double since) const { return level - fall * (begin - since); }
  std::array<double, 2> turns() const {
    // c1 + 2 c2 x + fall length (c0 + c1 x + c2 x^2) = 0
    const double leak = fall * length, a = leak * light.c2, h = 0.5 * (2 * light.c2 + leak * light.c1),
                 c = light.c1 + leak * light.c0;
    const double disc = h * h - a * c;
    if (!(disc >= 0)) return {length, length};
    const double q = -(h + std::copysign(std::sqrt(disc), h));
    return {q / a * length, c / q * length};
  }
  double solve(double from, double to, double target) const {
    return where_passed([&](double at) { return value(at); }, from, to, target);
  }
};

/// A slow photoreceptor that follows a logarithm a + b at with the time constant `slow`.
struct SlowRun {
  double begin, length;
  double a, b, slow, rest;  // rest: by how much it lags behind at the beginning, beyond where it goes
  double fall = 0;

  SlowRun(double from, double to, double first, double last, double start, double time_constant)
      : begin(from),
        length(to - from),
        a(first),
        b((last - first) / (to - from)),
        slow(time_constant),
        rest(start - first + b * time_constant) {}
  void set_leak(double per_second) { fall = per_second; }

  double signal(double at) const { return a + b * (at - slow) + rest * std::exp(-at / slow); }
  double value(double at) const { return signal(at) + fall * at; }
  double threshold(double level, double since) const { return level - fall * (begin - since); }
  std::array<double, 2> turns() const {
    const double share = (b + fall) * slow / rest;
    return {share > 0 ? -slow * std::log(share) : length, length};
  }
  double solve(double from, double to, double target) const {
    return where_passed([&](double at) { return value(at); }, from, to, target);
  }
};

}  // namespace

EventPixels::EventPixels(const EventSensor& sensor, uint64_t seed)
    : sensor_(sensor), seed_(seed), scale_(1 / sensor.white) {}

Vec3f EventPixels::channels(int x, int y) const {
  if (sensor_.bayer.empty()) return {0.2126f, 0.7152f, 0.0722f};  // Rec. 709
  const char letter = sensor_.bayer[static_cast<size_t>(y % 2 * 2 + x % 2)];
  return letter == 'R' ? Vec3f{1, 0, 0} : letter == 'G' ? Vec3f{0, 1, 0} : Vec3f{0, 0, 1};
}

EventPixels::Traits EventPixels::traits(int x, int y) const {
  Traits traits{hash(seed_, static_cast<uint64_t>(x), static_cast<uint64_t>(y)), sensor_.on, sensor_.off, 0};
  if (sensor_.mismatch > 0) {
    traits.on = std::max(kLeastThreshold, sensor_.on + sensor_.mismatch * normal(hash(traits.key, kOn)));
    traits.off = std::max(kLeastThreshold, sensor_.off + sensor_.mismatch * normal(hash(traits.key, kOff)));
  }
  if (sensor_.leak > 0) {
    traits.fall = sensor_.leak * sensor_.on;
    if (sensor_.leak_spread > 0) traits.fall *= std::pow(10.0, sensor_.leak_spread * normal(hash(traits.key, kLeak)));
  }
  return traits;
}

/// Until the next event.
double EventPixels::leak_of(const Traits& traits, const PixelState& pixel) const {
  if (!(traits.fall > 0) || !(sensor_.leak_jitter > 0)) return traits.fall;
  return std::max(0.0, traits.fall * (1 + sensor_.leak_jitter * normal(hash(traits.key, kLeakJitter, pixel.fired))));
}

/// When noise may strike next: at its highest rate, of which see_shot() takes a part.
void EventPixels::wait_for_shot(PixelState& pixel, const Traits& traits, double from) const {
  if (!(sensor_.shot_noise > 0)) return;
  const double rate = 0.5 * sensor_.shot_noise * (sensor_.on / traits.on + sensor_.off / traits.off);
  pixel.next_shot = from - std::log(unit(hash(traits.key, kWait, pixel.shots))) / rate;
}

void EventPixels::start(PixelState& pixel, const Traits& traits, const LightPiece& first) const {
  pixel.started = true;
  pixel.signal = pixel.level = std::log(brightness(first.first));
  pixel.since = first.begin;
  if (sensor_.random_level) pixel.level += traits.off - (traits.on + traits.off) * unit(hash(traits.key, kLevel));
  wait_for_shot(pixel, traits, first.begin);
}

template <class Run>
void EventPixels::follow(PixelState& pixel, const Traits& traits, Run run, int x, int y,
                         std::vector<Event>& events) const {
  double at = 0;
  const bool waits = sensor_.refractory_mode != Refractory::drop;
  const auto seconds = [&] { return run.begin + at; };
  const auto emit = [&](int polarity, EventKind kind) {
    ++pixel.fired;
    pixel.since = seconds();
    if (!waits && pixel.since < pixel.blind_until) return;
    // Several at one instant, as a jump gives them, follow each other at once.
    pixel.last = std::max(static_cast<int64_t>(std::floor(pixel.since * 1e9)), pixel.last + 1);
    events.push_back(
        {pixel.last, static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<int8_t>(polarity), kind});
    if (!(sensor_.refractory > 0)) return;
    pixel.blind_until = pixel.since + sensor_.refractory;
    pixel.stale = sensor_.refractory_mode == Refractory::resample;
  };
  for (;;) {
    const double fall = leak_of(traits, pixel);
    run.set_leak(fall);
    if (waits && seconds() < pixel.blind_until) {
      if (pixel.blind_until >= run.begin + run.length) return;
      at = pixel.blind_until - run.begin;
      if (pixel.stale) {
        pixel.level = run.signal(at);
        pixel.since = seconds();
        pixel.stale = false;
      }
    }
    while (pixel.next_shot < seconds()) {
      ++pixel.shots;
      wait_for_shot(pixel, traits, pixel.next_shot);
    }
    const bool shot = pixel.next_shot < run.begin + run.length;
    const double stop = shot ? pixel.next_shot - run.begin : run.length;
    const double upper = run.threshold(pixel.level + traits.on, pixel.since),
                 lower = run.threshold(pixel.level - traits.off, pixel.since);
    int polarity = 0;
    std::array<double, 4> ends{at, at, at, stop};
    std::array<double, 2> turns = run.turns();
    if (turns[1] < turns[0]) std::swap(turns[0], turns[1]);
    for (size_t i = 0; i < 2; ++i) ends[i + 1] = turns[i] > at && turns[i] < stop ? turns[i] : ends[i];
    if (const double now = run.value(at); now >= upper || now <= lower) {
      polarity = now >= upper ? 1 : -1;
    } else {
      for (size_t i = 1; i < ends.size() && polarity == 0; ++i) {
        if (!(ends[i - 1] < ends[i])) continue;
        const double then = run.value(ends[i]);
        if (then >= upper || then <= lower) {
          polarity = then >= upper ? 1 : -1;
          at = run.solve(ends[i - 1], ends[i], polarity > 0 ? upper : lower);
        }
      }
    }
    if (polarity != 0) {
      const double leaked = fall * (seconds() - pixel.since);
      pixel.level += (polarity > 0 ? traits.on : -traits.off) - leaked;
      emit(polarity, polarity > 0 && leaked > 0.5 * traits.on ? EventKind::leak : EventKind::signal);
      continue;
    }
    if (!shot) return;
    at = stop;
    const double bright = std::clamp(std::exp(run.signal(at)), 0.0, 1.0);
    const uint64_t ordinal = pixel.shots++;
    wait_for_shot(pixel, traits, seconds());
    if (unit(hash(traits.key, kStrike, ordinal)) > 1 - 0.75 * bright) continue;
    const double ons = sensor_.on / traits.on, offs = sensor_.off / traits.off;
    pixel.level = run.signal(at);
    emit(unit(hash(traits.key, kSide, ordinal)) * (ons + offs) < ons ? 1 : -1, EventKind::shot);
  }
}

/// Cuts the light until its logarithm runs straight, and the photoreceptor is equally fast, in each part.
void EventPixels::low_pass(PixelState& pixel, const Traits& traits, const LightPiece& piece, int x, int y,
                           std::vector<Event>& events) const {
  const BrightnessRun light(piece.begin, piece.end, brightness(piece.first), brightness(piece.middle),
                            brightness(piece.last), sensor_.dark);
  // As v2e has it: in steps of 8 bits, (value + 20) / 275 of the rate that it has in full light.
  const auto pace = [&](double at) { return (255 * (light.value(at) - sensor_.dark) + 20) / 275; };
  const double tolerance = std::min(traits.on, traits.off) / 200;
  constexpr double kEven = 0.02;
  constexpr int kMostHalvings = 12;
  const auto go = [&](const auto& self, double from, double to, int halvings) -> void {
    const double middle = 0.5 * (from + to), first = light.signal(from), last = light.signal(to);
    const double slower = std::min(pace(from), pace(to)), faster = std::max(pace(from), pace(to));
    const bool straight = std::abs(light.signal(middle) - 0.5 * (first + last)) <= tolerance;
    if (halvings < kMostHalvings && !(straight && faster - slower <= kEven * slower)) {
      self(self, from, middle, halvings + 1);
      self(self, middle, to, halvings + 1);
      return;
    }
    const SlowRun run(light.begin + from, light.begin + to, first, last, pixel.signal,
                      1 / (2 * std::numbers::pi * sensor_.cutoff * pace(middle)));
    follow(pixel, traits, run, x, y, events);
    pixel.signal = run.signal(run.length);
  };
  go(go, 0, light.length, 0);
}

void EventPixels::see(PixelState& pixel, int x, int y, std::span<const LightPiece> light,
                      std::vector<Event>& events) const {
  const Traits own = traits(x, y);
  for (const LightPiece& piece : light) {
    if (!pixel.started) start(pixel, own, piece);
    if (sensor_.cutoff > 0) {
      low_pass(pixel, own, piece, x, y, events);
      continue;
    }
    const BrightnessRun run(piece.begin, piece.end, brightness(piece.first), brightness(piece.middle),
                            brightness(piece.last), sensor_.dark);
    if (own.fall > 0)
      follow(pixel, own, LeakingRun(run), x, y, events);
    else
      follow(pixel, own, run, x, y, events);
  }
}

}  // namespace kairos
