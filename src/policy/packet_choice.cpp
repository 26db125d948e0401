#include "policy/packet_choice.h"

#include <array>
#include <mutex>
#include <span>

#include "base/parallel.h"

namespace kairos {

namespace {

/// Pairs of a ray and a triangle solved, relative to single rays, up to which packets are faster. Measured with
/// bench_rays: packets of 16 gain a fifth at 1.9 and lose a tenth at 3.0; packets of four gain a little at 0.9, nothing
/// at 1.4, and lose a third at 3.2.
constexpr double kMostOfLarge = 2.5, kMostOfSmall = 1.4;
constexpr uint32_t kPacketPixels = 24, kPacketRays = Tracer::kMaxPacket;
constexpr size_t kPacketPixelsPerTask = 4;

}  // namespace

PacketChoice choose_packets(const PixelContext& context, const Projection& projection, const Tracer& tracer) {
  const Sampler places(SamplerKind::owen_sobol, kPacketPixels, 0), points(SamplerKind::owen_sobol, kPacketRays, 0);
  uint64_t single = 0, small = 0, large = 0;  // solves
  std::mutex mutex;                           // of these sums
  parallel_for(kPacketPixels, kPacketPixelsPerTask, [&](size_t begin, size_t end) {
    Tracer::Workspace one_by_one, by_four, all;
    std::array<Ray, kPacketRays> rays;
    for (size_t i = begin; i < end; ++i) {
      const SamplePoint place = places.point(places.pixel(0, 0), static_cast<uint32_t>(i));
      const int x = static_cast<int>(place.x * static_cast<float>(projection.width));
      const int y = static_cast<int>(place.y * static_cast<float>(projection.height));
      const Sampler::Pixel pixel = points.pixel(x, y);
      for (uint32_t k = 0; k < kPacketRays; ++k) rays[k] = context.ray(x, y, points.point(pixel, k));
      for (const Ray& ray : rays) tracer.trace(ray, Visibility::visible, one_by_one);
      for (size_t k = 0; k < kPacketRays; k += 4)
        tracer.trace_packet(std::span(rays).subspan(k, 4), Visibility::visible, by_four);
      tracer.trace_packet(rays, Visibility::visible, all);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    single += one_by_one.counters().root_solves;
    small += by_four.counters().root_solves;
    large += all.counters().root_solves;
  });
  const auto few = [&](uint64_t solves, double most) {
    return static_cast<double>(solves) <= most * static_cast<double>(single);
  };
  return {few(large, kMostOfLarge), few(small, kMostOfSmall)};
}

}  // namespace kairos
