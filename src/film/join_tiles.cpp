#include "film/join_tiles.h"

#include <algorithm>
#include <limits>

#include "film/time_signal.h"

namespace kairos {

namespace {

/// A tick of a slab as one of all of the time.
uint32_t tick_in_all(uint32_t tick, size_t slab, size_t slabs) {
  return static_cast<uint32_t>((slab * kTicks + tick + slabs / 2) / slabs);
}

bool is_exact(const ObjectTile& tile) { return tile.signals.exact(); }
bool is_exact(const TimeTile& tile) { return tile.exact(); }

/// Of empty tiles nobody knows.
template <class Tile>
bool any_exact(std::span<const std::shared_ptr<const Tile>> slabs) {
  return std::any_of(slabs.begin(), slabs.end(), [](const auto& slab) { return slab && is_exact(*slab); });
}

/// Appends a slab's function, or one that is zero; several of these are one piece.
class SignalJoiner {
 public:
  SignalJoiner(TimeTile& to, bool exact, size_t slabs) : to_(to), exact_(exact), slabs_(slabs) { to_.first = {0}; }

  void add(const TimeTile* from, size_t function, size_t slab) {
    const bool is_gap = from == nullptr, goes_on = is_gap && in_gap_;
    in_gap_ = is_gap;
    if (goes_on) return;
    if (is_gap) {
      to_.begin.push_back(tick_in_all(0, slab, slabs_));
      if (exact_)
        add_zero(to_.floats);
      else
        add_zero(to_.halves);
      return;
    }
    const size_t begin = from->first[function], end = from->first[function + 1];
    for (size_t i = begin; i < end; ++i) to_.begin.push_back(tick_in_all(from->begin[i], slab, slabs_));
    if (exact_)
      add_values(to_.floats, from->floats, begin, end);
    else
      add_values(to_.halves, from->halves, begin, end);
  }
  void end_function() {
    to_.first.push_back(static_cast<uint32_t>(to_.begin.size()));
    in_gap_ = false;
  }

 private:
  template <class Number>
  static void add_zero(PieceValues<Number>& to) {
    to.left.push_back({});
    to.step.push_back({});
  }
  template <class Number>
  static void add_values(PieceValues<Number>& to, const PieceValues<Number>& from, size_t begin, size_t end) {
    to.left.insert(to.left.end(), from.left.data() + begin, from.left.data() + end);
    to.step.insert(to.step.end(), from.step.data() + begin, from.step.data() + end);
  }

  TimeTile& to_;
  bool exact_, in_gap_ = false;
  size_t slabs_;
};

/// The same for distances, which are infinite where nothing is known.
void add_depth(DepthPieces& to, const DepthPieces* from, size_t function, size_t slab, size_t slabs) {
  if (from == nullptr) {
    const bool goes_on = to.begin.size() > to.first.back() && to.left.back() == std::numeric_limits<float>::infinity();
    if (goes_on) return;
    to.begin.push_back(tick_in_all(0, slab, slabs));
    to.left.push_back(std::numeric_limits<float>::infinity());
    to.right.push_back(std::numeric_limits<float>::infinity());
    return;
  }
  for (size_t i = from->first[function]; i < from->first[function + 1]; ++i) {
    to.begin.push_back(tick_in_all(from->begin[i], slab, slabs));
    to.left.push_back(from->left[i]);
    to.right.push_back(from->right[i]);
  }
}

}  // namespace

TimeTile join_slabs(std::span<const std::shared_ptr<const TimeTile>> slabs, size_t pixels) {
  TimeTile joined;
  SignalJoiner out(joined, any_exact(slabs), slabs.size());
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    for (size_t slab = 0; slab < slabs.size(); ++slab) out.add(slabs[slab].get(), pixel, slab);
    out.end_function();
  }
  return joined;
}

ObjectTile join_slabs(std::span<const std::shared_ptr<const ObjectTile>> slabs, size_t pixels) {
  ObjectTile joined;
  joined.first = joined.depth.first = {0};
  SignalJoiner out(joined.signals, any_exact(slabs), slabs.size());
  std::vector<uint32_t> meshes;  // of a pixel
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    meshes.clear();
    for (const auto& slab : slabs)
      if (slab)
        meshes.insert(meshes.end(), slab->mesh.data() + slab->first[pixel], slab->mesh.data() + slab->first[pixel + 1]);
    std::sort(meshes.begin(), meshes.end());
    meshes.erase(std::unique(meshes.begin(), meshes.end()), meshes.end());
    for (const uint32_t mesh : meshes) {
      joined.mesh.push_back(mesh);
      for (size_t number = 0; number < slabs.size(); ++number) {
        const ObjectTile* slab = slabs[number].get();
        size_t object = 0;
        if (slab != nullptr) {
          const auto begin = slab->mesh.begin() + static_cast<std::ptrdiff_t>(slab->first[pixel]),
                     end = slab->mesh.begin() + static_cast<std::ptrdiff_t>(slab->first[pixel + 1]),
                     found = std::lower_bound(begin, end, mesh);
          object = static_cast<size_t>(found - slab->mesh.begin());
          if (found == end || *found != mesh) slab = nullptr;  // does not see it
        }
        out.add(slab == nullptr ? nullptr : &slab->signals, object, number);
        add_depth(joined.depth, slab == nullptr ? nullptr : &slab->depth, object, number, slabs.size());
      }
      out.end_function();
      joined.depth.first.push_back(static_cast<uint32_t>(joined.depth.begin.size()));
    }
    joined.first.push_back(static_cast<uint32_t>(joined.mesh.size()));
  }
  return joined;
}

}  // namespace kairos
