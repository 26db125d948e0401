// The time-continuous rays of a pixel, or of a few pixels beside each other, traced in one packet.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <kairos/tracer.h>

#include "motion/aligned_points.h"
#include "pixel/record_builder.h"
#include "shading/packet_shading.h"
#include "shading/packet_shadows.h"
#include "shading/pixel_context.h"

namespace kairos {

/// One thread's scratch memory. Which rays a packet has decides how they are rounded, so whoever fills it with those of
/// several pixels takes the same ones whichever of them are asked for.
class RowPacket {
 public:
  static constexpr uint32_t kMostRays = Tracer::kMaxPacket;

  explicit RowPacket(const PixelContext& context) : context_(context) {}

  /// Empties it, for pixels of row y.
  void begin(int y) {
    y_ = y;
    count_ = 0;
    pixels_.clear();
    occluder_hints_.clear();
  }
  /// May a pixel's `count` rays join it: are they few and near enough? strip: see PacketChoice.
  bool fits(int x, uint32_t count, int strip) const {
    return count_ + count <= kMostRays && (pixels_.empty() || x - pixels_.front().x < strip);
  }

  /// Adds rays `first` to `first + count - 1` of a pixel, which fit in. occluder_hints: of all pixels, or of none.
  void add(int x, const Sampler::Pixel& pixel, const AlignedPoints& align, uint32_t first, uint32_t count,
           std::span<const Segment> occluder_hints = {}) {
    pixels_.push_back({x, count_, count});
    for (uint32_t i = 0; i < count; ++i) {
      const SamplePoint point = align(context_.sampler.point(pixel, first + i));
      rays_[count_] = context_.ray(x, y_, point);
      film_[count_] = context_.film(point);
      times_[count_] = point.time;
      ++count_;
    }
    occluder_hints_.insert(occluder_hints_.end(), occluder_hints.begin(), occluder_hints.end());
  }

  /// limits: of all pixels. shadows: that are to be exact on what is seen; null: none are.
  void trace(const Tracer& tracer, Tracer::Workspace& workspace, bool together, const TraceLimits& limits,
             const ExactShadows* shadows) {
    const auto rays = std::span(rays_).first(count_);
    seen_ = tracer.trace_packet(rays, Visibility::visible, workspace, occluder_hints_, together, limits);
    has_shadows_ = shadows != nullptr;
    if (has_shadows_) shadows_.look(*shadows, rays, seen_, {limits.window_begin, limits.window_end});
  }
  TraceCounters shadow_counters() const { return shadows_.counters(); }

  bool holds(int x, int y) const { return y == y_ && find(x) != nullptr; }

  /// Of one pixel; valid until the workspace is used again.
  struct Rays {
    std::span<const Ray> rays;
    std::span<const SeenByRay> seen;
    std::span<const float> times;  ///< of the sample points
    std::span<const Vec2f> film;
    const PacketShadows* exact_shadows;  ///< of the packet; null: none
    size_t first;                        ///< number of the first ray within the packet
  };
  /// x: of a pixel that was added.
  Rays of(int x) const {
    const Place& place = *find(x);
    const auto some = [&](auto&& all) { return std::span(all).subspan(place.first, place.count); };
    return {some(rays_), some(seen_), some(times_), some(film_), has_shadows_ ? &shadows_ : nullptr, place.first};
  }

 private:
  struct Place {
    int x;
    uint32_t first, count;
  };
  const Place* find(int x) const {
    for (const Place& place : pixels_)
      if (place.x == x) return &place;
    return nullptr;
  }

  const PixelContext& context_;
  int y_ = 0;
  uint32_t count_ = 0;
  std::vector<Place> pixels_;
  std::array<Ray, kMostRays> rays_;
  std::array<Vec2f, kMostRays> film_{};
  std::array<float, kMostRays> times_{};
  std::vector<Segment> occluder_hints_;
  std::span<const SeenByRay> seen_;
  PacketShadows shadows_;
  bool has_shadows_ = false;
};

/// Shades a pixel's rays, of which they are those from `first_ray` on, and adds them with all that they see to its
/// record. ends: scratch memory.
inline void shade_rays(const RowPacket::Rays& rays, uint64_t pixel_seed, uint32_t first_ray, const TimeRange& window,
                       PacketShading& shading, std::vector<uint32_t>& ends, RecordBuilder& record) {
  ends.clear();
  uint32_t first = record.part_count();
  shading.shade({rays.rays, rays.seen, rays.times, pixel_seed, first_ray, window, rays.exact_shadows, rays.first},
                record, ends);
  for (uint32_t i = 0; i < rays.rays.size(); ++i) {
    const SeenByRay& seen = rays.seen[i];
    record.add_ray({rays.film[i], 1, PixelRay::kAll, first, ends[i] - first,
                    static_cast<uint32_t>(seen.segments.size() + seen.blended.size())});
    first = ends[i];
  }
}

}  // namespace kairos
