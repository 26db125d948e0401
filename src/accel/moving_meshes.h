// What the builder of trees asks of meshes that move: when their keys are, and where their triangles are between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <kairos/scene.h>

#include "accel/builder.h"
#include "accel/triangle_bounds.h"

namespace kairos {

/// When the meshes' keys are, by the sets of key times that there are.
class KeySets {
 public:
  explicit KeySets(std::span<const Mesh> meshes) : of_mesh_(meshes.size(), 0) {
    std::map<std::span<const float>, uint32_t, Less> known;
    for (size_t m = 0; m < meshes.size(); ++m) {
      if (meshes[m].is_static()) continue;
      const auto [place, is_new] = known.emplace(meshes[m].key_times, static_cast<uint32_t>(times_.size()));
      if (is_new) times_.push_back(meshes[m].key_times);
      of_mesh_[m] = place->second;
    }
  }

  uint32_t set_of(uint32_t mesh) const { return of_mesh_[mesh]; }
  std::span<const float> times(uint32_t mesh) const { return times_[of_mesh_[mesh]]; }
  std::span<const float> times_of_set(uint32_t set) const { return times_[set]; }
  /// True when some triangle may have more than one key span.
  bool several_spans() const {
    return std::any_of(times_.begin(), times_.end(), [](const auto& times) { return times.size() > 2; });
  }
  /// First and last key of a window that begins and ends at keys. Of several keys at one time, those inside.
  std::pair<size_t, size_t> keys_in(uint32_t mesh, TimeRange window) const {
    const auto all = times(mesh);
    if (all.size() == 2) return {0, 1};
    return {std::upper_bound(all.begin(), all.end(), window.begin) - all.begin() - 1,
            std::lower_bound(all.begin(), all.end(), window.end) - all.begin()};
  }

 private:
  struct Less {
    bool operator()(std::span<const float> a, std::span<const float> b) const {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    }
  };
  std::vector<uint32_t> of_mesh_;
  std::vector<std::span<const float>> times_;
};

/// What rounding does to a bound that is computed from the line between two keys is less than this share of the largest
/// coordinate: a ratio, two differences, a product and three sums of values up to three times as large, each rounded to
/// within 2^-24.
constexpr float kLineError = 32 * 0x1p-24f;

/// Differences and sums of a few numbers up to here don't overflow.
constexpr float kSafeSize = 1e37f;

/// Between its first and last key in a window a bound may leave the line between the two: moves the lines of a box out
/// as far as they must. bounds_at(key): the bounds there, lower and negated upper. Between neighbouring keys vertices
/// move straight, so keys alone decide.
template <class BoundsAt>
void widen_over_keys(std::span<const float> key_times, size_t first, size_t last, TimeRange window,
                     const BoundsAt& bounds_at_key, BoxLanes& box) {
  const auto sizes = [](Lanes a) { return higher_of(a, -a); };
  std::array<Lanes, 2> off{}, largest, lowest;
  for (size_t side = 0; side < 2; ++side) {
    largest[side] = higher_of(sizes(box.bound[side]), sizes(box.bound[2 + side]));
    lowest[side] = lower_of(box.bound[side], box.bound[2 + side]);
  }
  const float length = window.end - window.begin;
  for (size_t key = first + 1; key < last; ++key) {
    const std::array<Lanes, 2> here = bounds_at_key(key);
    const float time = (key_times[key] - window.begin) / length;
    for (size_t side = 0; side < 2; ++side) {
      const Lanes begin = box.bound[side], end = box.bound[2 + side];
      const Lanes line = begin + all_lanes(time) * (end - begin);
      off[side] = lower_of(here[side] - line, off[side]);
      largest[side] = higher_of(sizes(here[side]), largest[side]);
      lowest[side] = lower_of(here[side], lowest[side]);
    }
  }
  for (size_t side = 0; side < 2; ++side) {
    off[side] -= all_lanes(kLineError) * largest[side];
    for (size_t end = 0; end < 2; ++end) {
      Lanes& bound = box.bound[2 * end + side];
      const Lanes moved = bound + off[side];
      // Where sums overflow the box stands still instead: at its lowest.
      bound = largest[side] < all_lanes(kSafeSize) ? moved : lowest[side];
    }
  }
}

class MovingMeshes final : public MovingTriangles {
 public:
  MovingMeshes(std::span<const Mesh> meshes, const KeySets& keys) : meshes_(meshes), keys_(keys) {}

  uint32_t spans(uint32_t mesh, TimeRange window) const override {
    const auto [first, last] = keys_.keys_in(mesh, window);
    return static_cast<uint32_t>(last - first);
  }
  std::optional<float> middle_key(uint32_t mesh, TimeRange window) const override {
    const auto times = keys_.times(mesh);
    const float middle = window.begin + (window.end - window.begin) / 2;
    std::optional<float> nearest;
    const auto consider = [&](float time) {
      if (time > window.begin && time < window.end &&
          (!nearest || std::abs(time - middle) < std::abs(*nearest - middle)))
        nearest = time;
    };
    const auto after = std::lower_bound(times.begin(), times.end(), middle);
    if (after != times.begin()) consider(after[-1]);
    if (after != times.end()) consider(*after);
    return nearest;
  }
  bool has_key(uint32_t mesh, float time) const override {
    const auto times = keys_.times(mesh);
    return std::binary_search(times.begin(), times.end(), time);
  }
  bool same_keys(uint32_t mesh, uint32_t other) const override { return keys_.set_of(mesh) == keys_.set_of(other); }

  void set_primitive(TriangleId id, TimeRange window, Primitive& primitive) const override {
    const Mesh& mesh = meshes_[id.mesh];
    const Triangle& triangle = mesh.triangles[id.triangle];
    const auto [first, last] = keys_.keys_in(id.mesh, window);
    auto& bound = primitive.box.bound;
    const auto begin = bounds_at(mesh, triangle, first), end = bounds_at(mesh, triangle, last);
    for (size_t side = 0; side < 2; ++side) {
      bound[side] = begin[side];
      bound[2 + side] = end[side];
    }
    if (last - first > 1)
      widen_over_keys(
          mesh.key_times, first, last, window, [&](size_t key) { return bounds_at(mesh, triangle, key); },
          primitive.box);
    primitive.set_id(id);
  }

 private:
  std::span<const Mesh> meshes_;
  const KeySets& keys_;
};

}  // namespace kairos
