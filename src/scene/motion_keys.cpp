#include "scene/motion_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <kairos/error.h>

#include "base/parallel.h"

namespace kairos {

namespace {

constexpr int kMaxLevel = 12;  // 2^12 = kMaxKeySpans
static_assert(1 << kMaxLevel == kMaxKeySpans);

// Where in a span the chord is compared with the path. A parabola leaves its chord most at 1/2, a cubic that turns in
// the middle at 1/2 +- 1/sqrt(12); the others are for what lies between the two.
constexpr std::array<double, 5> kProbes{0.5, 0.2113, 0.7887, 0.35, 0.65};
// The part of the tolerance that is used: what a smooth path may do between the probes takes the rest.
constexpr double kRoomLeft = 0.9;
// A vertex that stays within this part of its distance rests: it is what float positions and a transform resolve.
constexpr double kRest = 1e-6;
// Nearer than this part of the mesh's largest distance from the eye, screen distances are not measured any closer.
constexpr double kNear = 1e-3;
// Positions of all keys of one mesh: 6 GB.
constexpr uint64_t kMaxPositions = uint64_t{1} << 29;
constexpr size_t kBlock = 1 << 15;  // vertices that are worth a task of their own

/// The largest value(vertex) >= 0; NaN is passed over.
template <class Value>
double largest(size_t vertices, const Value& value) {
  const size_t blocks = (vertices + kBlock - 1) / kBlock;
  std::vector<double> maxima(blocks, 0.0);
  const auto scan = [&](size_t first, size_t last) {
    for (size_t b = first; b < last; ++b)
      for (size_t v = b * kBlock; v < std::min(vertices, (b + 1) * kBlock); ++v)
        if (const double x = value(v); x > maxima[b]) maxima[b] = x;
  };
  if (blocks < 2)
    scan(0, blocks);
  else
    parallel_for(blocks, 1, scan);
  return blocks ? *std::max_element(maxima.begin(), maxima.end()) : 0;
}

/// Whether both sets of positions are the same as far as kRest tells.
bool at_same_place(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  const double reach = largest(a.size(), [&](size_t v) { return length(a[v]); });
  return largest(a.size(), [&](size_t v) {
           const double moved = length(a[v] - b[v]);
           return moved == 0 ? 0 : moved / std::max(length(a[v]), kNear * reach);
         }) <= kRest;
}

int spans_of(const Stretch& stretch, int level) {
  int spans = 1 << level;
  while (spans > 1 && (stretch.time_end - stretch.time_begin) / spans < 1.0 / kMaxKeySpans) spans /= 2;
  return spans;
}

/// Of the key that begins span `index` of `spans` (index == spans: the stretch's end).
double scene_time_of(const ShutterWindow& window, const Stretch& s, int index, int spans) {
  if (index == 0) return s.begin;
  if (index == spans) return s.end;
  const double weight = static_cast<double>(index) / spans;
  return window.scene_time(s.time_begin + weight * (s.time_end - s.time_begin));
}
Side side_of(int index) { return index == 0 ? Side::after : Side::before; }

/// Compares chords with true paths.
class ChordMeter {
 public:
  ChordMeter(const PathSampler& path, const View& view, double tolerance)
      : path_(path), view_(view), tolerance_(tolerance * kRoomLeft) {
    path_.positions(view.window().open, Side::after, first_);
    const Mat4 camera = view.camera_from_space(view.window().open, Side::after);
    const double reach = largest(first_.size(), [&](size_t v) { return length(transform_point(camera, first_[v])); });
    near_dist_ = std::max(kNear * reach, std::numeric_limits<double>::min());
  }

  /// The largest error in pixels over all stretches with 2^level spans in each; `to_the_end` false: any value above the
  /// tolerance may be returned once one is met.
  double error(const std::vector<Stretch>& stretches, int level, bool to_the_end) {
    double worst = 0;
    for (const Stretch& s : stretches) {
      const int spans = spans_of(s, level);
      for (int i = 0; i < spans; ++i) {
        worst = std::max(worst, span_error(s, i, spans, to_the_end));
        if (!to_the_end && worst > tolerance_) return worst;
      }
    }
    return worst;
  }
  bool within_tolerance(double error) const { return error <= tolerance_; }

  /// Whether every position that was looked at so far is where the first one was.
  bool at_rest() const { return at_rest_; }

 private:
  double span_error(const Stretch& s, int index, int spans, bool to_the_end) {
    const ShutterWindow& window = view_.window();
    if (index == 0) sample(s.begin, Side::after, begin_);
    sample(scene_time_of(window, s, index + 1, spans), Side::before, end_);
    double worst = 0;
    for (double probe : kProbes) {
      const double time = s.time_begin + (index + probe) / spans * (s.time_end - s.time_begin);
      // Rounding must not carry the instant across the kinks.
      const double scene_time = std::clamp(window.scene_time(time), s.begin, s.end);
      const Side side = scene_time > s.begin ? Side::before : Side::after;
      sample(scene_time, side, truth_);
      const Mat4 camera = view_.camera_from_space(scene_time, side);
      worst = std::max(worst, largest(truth_.size(), [&](size_t v) {
                         const Vec3d chord = lerp(begin_[v], end_[v], probe);
                         return view_.screen_distance(transform_point(camera, truth_[v]),
                                                      transform_point(camera, chord), near_dist_);
                       }));
      if (!to_the_end && worst > tolerance_) break;
    }
    begin_.swap(end_);
    return worst;
  }

  void sample(double scene_time, Side side, std::vector<Vec3d>& out) {
    path_.positions(scene_time, side, out);
    at_rest_ = at_rest_ && at_same_place(first_, out);
  }

  const PathSampler& path_;
  const View& view_;
  double tolerance_, near_dist_ = 0;
  bool at_rest_ = true;
  std::vector<Vec3d> first_, begin_, end_, truth_;
};

std::vector<Vec3f> rounded(const std::vector<Vec3d>& positions) {
  std::vector<Vec3f> out(positions.size());
  for (size_t v = 0; v < out.size(); ++v) out[v] = to_float(positions[v]);
  return out;
}

/// NaN equals NaN here.
bool same_positions(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  const auto same = [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::equal(a.begin(), a.end(), b.begin(),
                    [&](const Vec3f& p, const Vec3f& q) { return same(p.x, q.x) && same(p.y, q.y) && same(p.z, q.z); });
}

}  // namespace

PathSampler::PathSampler(const VertexMotion& motion, const View& view) : motion_(motion), view_(view) {
  const ShutterWindow& window = view.window();
  if (!window.holds_still(motion)) return;
  resting_.resize(motion.vertex_count());
  motion.positions(window.open, Side::after, resting_);
}

void PathSampler::positions(double scene_time, Side side, std::vector<Vec3d>& out) const {
  out.resize(motion_.vertex_count());
  const bool rests = !resting_.empty();
  if (!rests) motion_.positions(scene_time, side, out);
  const Mat4 transform = view_.space_from_world(scene_time, side);
  if (transform == Mat4{}) {
    if (rests) out = resting_;
    return;
  }
  const Vec3d* world = rests ? resting_.data() : out.data();
  parallel_for(out.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) out[v] = transform_point(transform, world[v]);
  });
}

MotionKeys choose_motion_keys(const VertexMotion& motion, const View& view, double tolerance, const std::string& place,
                              uint64_t most_keys) {
  const ShutterWindow& window = view.window();
  const bool rests = window.holds_still(motion);
  const PathSampler path(motion, view);
  MotionKeys keys;
  std::vector<Vec3d> now;
  const auto add_key = [&](double time, double scene_time, Side side) {
    keys.times.push_back(static_cast<float>(time));
    keys.scene_times.push_back(scene_time);
    keys.sides.push_back(side);
    keys.positions.push_back(rounded(now));
  };
  path.positions(window.open, Side::after, now);
  if (rests && !view.space_moves()) {
    add_key(0, window.open, Side::after);
    return keys;
  }

  const std::vector<double> own_kinks = rests ? std::vector<double>{} : motion.kinks(window.open, window.close);
  const std::vector<Stretch> stretches = divide_at_kinks(window, merge_kinks(own_kinks, view.space_kinks()));
  const auto key_count = [&](int level) {
    uint64_t count = 0;
    for (const Stretch& s : stretches) count += static_cast<uint64_t>(spans_of(s, level)) + 1;
    return count;
  };
  const auto fits = [&](int level) {
    return key_count(level) <= most_keys && key_count(level) * std::max<uint64_t>(1, now.size()) <= kMaxPositions;
  };
  if (!fits(0))
    throw Error(ErrorCode::bad_input, place,
                fmt::format("{} motion keys of {} vertices while the shutter is open are more than fits; use a shorter "
                            "shutter, or raise --memory-budget",
                            key_count(0), now.size()));

  int level = 0;
  const bool exact = motion.is_linear_between_kinks() && !view.space_moves();
  if (!exact) {
    ChordMeter meter(path, view, tolerance);
    for (;; ++level) {
      const bool last = level == kMaxLevel || !fits(level + 1);
      const double error = meter.error(stretches, level, last);
      if (meter.within_tolerance(error)) break;
      if (last) {
        keys.excess = error;
        break;
      }
    }
    if (level == 0 && meter.at_rest() && keys.excess == 0) {
      add_key(0, window.open, Side::after);
      return keys;
    }
  }

  std::vector<Vec3d> before;
  for (const Stretch& s : stretches) {
    const int spans = spans_of(s, level);
    for (int i = 0; i <= spans; ++i) {
      const double scene_time = scene_time_of(window, s, i, spans);
      path.positions(scene_time, side_of(i), now);
      if (i == 0 && !keys.times.empty() && at_same_place(before, now)) continue;  // a corner, not a jump
      const double weight = static_cast<double>(i) / spans;
      add_key(i == spans ? s.time_end : s.time_begin + weight * (s.time_end - s.time_begin), scene_time, side_of(i));
    }
    before.swap(now);
  }
  const bool all_same = std::all_of(keys.positions.begin(), keys.positions.end(),
                                    [&](const auto& key) { return same_positions(key, keys.positions.front()); });
  if (all_same) {
    keys.times.resize(1);
    keys.scene_times.resize(1);
    keys.sides.resize(1);
    keys.positions.resize(1);
  }
  return keys;
}

}  // namespace kairos
