#include "shading/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace kairos {

namespace {

constexpr int kBins = 16;
constexpr int kDeepest = 40;  // below, nodes are halved, which ends after 32 more

Vec3d lower(Vec3d a, Vec3d b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3d upper(Vec3d a, Vec3d b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

double angle_between(Vec3d a, Vec3d b) { return 2 * std::atan2(length(a - b), length(a + b)); }

/// The cone around both.
void widen(LightBounds& sum, const LightBounds& other) {
  const LightBounds &wide = sum.spread >= other.spread ? sum : other, &slim = sum.spread >= other.spread ? other : sum;
  const bool two_sided = sum.two_sided || other.two_sided;
  const Vec3d slim_axis = two_sided && dot(wide.axis, slim.axis) < 0 ? -slim.axis : slim.axis;
  const double apart = angle_between(wide.axis, slim_axis), fade = std::max(sum.fade, other.fade);
  double spread = wide.spread;
  Vec3d axis = wide.axis;
  if (apart + slim.spread > wide.spread) {
    spread = (apart + slim.spread + wide.spread) / 2;
    const Vec3d across = normalize(slim_axis - wide.axis * dot(slim_axis, wide.axis));
    const double turn = spread - wide.spread;
    if (spread >= std::numbers::pi || across == Vec3d{})
      spread = std::numbers::pi;
    else
      axis = normalize(wide.axis * std::cos(turn) + across * std::sin(turn));
  }
  sum.axis = axis;
  sum.spread = std::min(spread, std::numbers::pi);
  sum.fade = fade;
  sum.two_sided = two_sided;
}

void add_to(LightBounds& sum, const LightBounds& other) {
  if (!(sum.power > 0)) {
    sum = other;
    return;
  }
  widen(sum, other);
  const auto unite = [](LightBox& box, const LightBox& more) {
    box = {lower(box.low, more.low), upper(box.high, more.high)};
  };
  unite(sum.first, other.first);
  unite(sum.last, other.last);
  sum.power += other.power;
}

/// What a node costs: the light in it, times how far and how differently it is spread.
double cost(const LightBounds& bounds) {
  if (!(bounds.power > 0)) return 0;
  const Vec3d size = (bounds.first.high - bounds.first.low + bounds.last.high - bounds.last.low) * 0.5;
  const double area = size.x * size.y + size.y * size.z + size.z * size.x + dot(size, size) * 1e-3;
  return bounds.power * area * (1 + bounds.spread);
}

/// Halfway through the shutter.
Vec3d centre_of(const LightBounds& bounds) {
  return (bounds.first.low + bounds.first.high + bounds.last.low + bounds.last.high) * 0.25;
}

/// The cosine of an angle of which `cosine` and `sine` are given, less one of which the others are; 1 where that would
/// be below 0.
double cosine_of_rest(double cosine, double sine, double less_cosine, double less_sine) {
  return cosine >= less_cosine ? 1 : cosine * less_cosine + sine * less_sine;
}

}  // namespace

void LightBounds::set_boxes(std::span<const LightBox> boxes, std::span<const float> times) {
  first = boxes.front();
  last = boxes.back();
  // Where it bends out of the way from the first box to the last, both grow: what is straight is then within a straight
  // way at all times if it is at those where it bends.
  Vec3d below, above;
  for (size_t i = 1; i + 1 < boxes.size(); ++i) {
    const auto time = static_cast<double>(times[i]);
    below = upper(below, lerp(first.low, last.low, time) - boxes[i].low);
    above = upper(above, boxes[i].high - lerp(first.high, last.high, time));
  }
  for (LightBox* box : {&first, &last}) *box = {box->low - below, box->high + above};
}

LightTree::LightTree(std::span<const LightBounds> lights, size_t leaf_size) : order_(lights.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!lights.empty()) build(lights, 0, static_cast<uint32_t>(lights.size()), leaf_size, 0);
}

void LightTree::build(std::span<const LightBounds> lights, uint32_t begin, uint32_t end, size_t leaf_size, int depth) {
  const auto index = static_cast<uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Vec3d low = centre_of(lights[order_[begin]]), high = low;
  {
    Node& node = nodes_.back();
    for (uint32_t i = begin; i < end; ++i) {
      const LightBounds& light = lights[order_[i]];
      add_to(node.bounds, light);
      low = lower(low, centre_of(light));
      high = upper(high, centre_of(light));
    }
    node.begin = begin;
    node.end = end;
  }
  if (end - begin <= leaf_size) return;
  const Vec3d size = high - low;
  // The cheapest of kBins - 1 cuts along each axis.
  double best = std::numeric_limits<double>::infinity();
  int best_axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2, best_cut = -1;
  const auto bin_of = [&](uint32_t light, int axis) {
    const double place = (centre_of(lights[light])[axis] - low[axis]) / size[axis];
    return std::clamp(static_cast<int>(place * kBins), 0, kBins - 1);
  };
  for (int axis = 0; axis < 3 && depth < kDeepest; ++axis) {
    if (!(size[axis] > 0)) continue;
    std::array<LightBounds, kBins> bins;
    for (uint32_t i = begin; i < end; ++i)
      add_to(bins[static_cast<size_t>(bin_of(order_[i], axis))], lights[order_[i]]);
    std::array<double, kBins> above{};
    LightBounds sum;
    for (size_t i = kBins; i-- > 1;) {
      if (bins[i].power > 0) add_to(sum, bins[i]);
      above[i] = cost(sum);
    }
    sum = {};
    for (size_t i = 0; i + 1 < kBins; ++i) {
      if (bins[i].power > 0) add_to(sum, bins[i]);
      if (!(sum.power > 0) || !(above[i + 1] > 0)) continue;
      const double both = cost(sum) + above[i + 1];
      if (both < best) {
        best = both;
        best_axis = axis;
        best_cut = static_cast<int>(i);
      }
    }
  }
  const auto first = order_.begin() + begin, last = order_.begin() + end;
  auto cut = first;
  if (best_cut >= 0)
    cut = std::stable_partition(first, last, [&](uint32_t light) { return bin_of(light, best_axis) <= best_cut; });
  if (cut == first || cut == last) {
    cut = first + (end - begin) / 2;
    std::stable_sort(first, last, [&](uint32_t a, uint32_t b) {
      return centre_of(lights[a])[best_axis] < centre_of(lights[b])[best_axis];
    });
  }
  const auto between = begin + static_cast<uint32_t>(cut - first);
  build(lights, begin, between, leaf_size, depth + 1);
  nodes_[index].second = static_cast<uint32_t>(nodes_.size());
  build(lights, between, end, leaf_size, depth + 1);
}

double LightTree::worth(const LightBounds& bounds, Vec3d point, Vec3d normal, double time) {
  const Vec3d low = lerp(bounds.first.low, bounds.last.low, time),
              high = lerp(bounds.first.high, bounds.last.high, time);
  const Vec3d way = (low + high) * 0.5 - point;
  const double squared = dot(way, way), radius = length(high - low) / 2;
  if (squared <= radius * radius) return radius > 0 ? bounds.power / (radius * radius) : bounds.power;
  const double dist = std::sqrt(squared), sin_size = radius / dist, cos_size = std::sqrt(1 - sin_size * sin_size);
  const auto sine = [](double cosine) { return std::sqrt(std::max(0.0, 1 - cosine * cosine)); };
  const double cos_lit = dot(normal, way) / dist;
  const double lit = cosine_of_rest(cos_lit, sine(cos_lit), cos_size, sin_size);
  if (!(lit > 0)) return 0;
  if (bounds.spread >= std::numbers::pi) return bounds.power * lit / squared;
  const double along = -dot(bounds.axis, way) / dist;
  const double away = std::acos(std::clamp(bounds.two_sided ? std::abs(along) : along, -1.0, 1.0)) - bounds.spread -
                      std::asin(std::min(1.0, sin_size));
  if (away > bounds.fade) return 0;
  return bounds.power * lit * (away > 0 ? std::max(std::cos(away), 1e-3) : 1) / squared;
}

std::optional<double> LightTree::share_of_first(size_t index, Vec3d point, Vec3d normal, double time) const {
  const double first = worth(nodes_[index + 1].bounds, point, normal, time);
  const double second = worth(nodes_[nodes_[index].second].bounds, point, normal, time);
  if (!(first + second > 0)) return std::nullopt;
  return first / (first + second);
}

LightTree::Leaf LightTree::choose(Vec3d point, Vec3d normal, float time, double& u) const {
  if (nodes_.empty()) return {};
  size_t index = 0;
  double probability = 1;
  while (nodes_[index].second != 0) {
    const size_t second = nodes_[index].second;
    const std::optional<double> of_first = share_of_first(index, point, normal, static_cast<double>(time));
    if (!of_first) return {};
    const double share = *of_first;
    if (u < share) {
      u = std::min(u / share, 1 - 0x1p-53);
      probability *= share;
      ++index;
    } else {
      u = std::clamp((u - share) / (1 - share), 0.0, 1 - 0x1p-53);
      probability *= 1 - share;
      index = second;
    }
  }
  return {nodes_[index].begin, nodes_[index].end, probability};
}

LightTree::Leaf LightTree::leaf_of(uint32_t place, Vec3d point, Vec3d normal, float time) const {
  size_t index = 0;
  double probability = 1;
  while (nodes_[index].second != 0) {
    const size_t second = nodes_[index].second;
    const std::optional<double> of_first = share_of_first(index, point, normal, static_cast<double>(time));
    if (!of_first) return {};
    const double share = *of_first;
    const bool is_left = place < nodes_[second].begin;
    probability *= is_left ? share : 1 - share;
    index = is_left ? index + 1 : second;
  }
  return {nodes_[index].begin, nodes_[index].end, probability};
}

}  // namespace kairos
