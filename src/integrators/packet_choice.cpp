#include "integrators/packet_choice.h"

#include <array>
#include <span>

namespace kairos {

namespace {

/// Pairs of a ray and a triangle solved, relative to single rays, up to which packets are faster. Measured with
/// bench_rays: packets of 16 gain a fifth at 1.9 and lose a tenth at 3.0; packets of four gain a little at 0.9, nothing
/// at 1.4, and lose a third at 3.2.
constexpr double kMostOfLarge = 2.5, kMostOfSmall = 1.4;
constexpr uint32_t kPixels = 24, kRays = Tracer::kMaxPacket;

}  // namespace

PacketChoice choose_packets(const PixelContext& context, const Projection& projection, const Tracer& tracer) {
  const Sampler places(SamplerKind::owen_sobol, kPixels, 0), points(SamplerKind::owen_sobol, kRays, 0);
  Tracer::Workspace single, small, large;
  std::array<Ray, kRays> rays;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const SamplePoint place = places.point(places.pixel(0, 0), i);
    const int x = static_cast<int>(place.x * static_cast<float>(projection.width));
    const int y = static_cast<int>(place.y * static_cast<float>(projection.height));
    const Sampler::Pixel pixel = points.pixel(x, y);
    for (uint32_t k = 0; k < kRays; ++k) rays[k] = context.ray(x, y, points.point(pixel, k));
    for (const Ray& ray : rays) tracer.trace(ray, Visibility::visible, single);
    for (size_t k = 0; k < kRays; k += 4)
      tracer.trace_packet(std::span(rays).subspan(k, 4), Visibility::visible, small);
    tracer.trace_packet(rays, Visibility::visible, large);
  }
  const auto solves = [](const Tracer::Workspace& w) { return static_cast<double>(w.counters().root_solves); };
  return {solves(large) <= kMostOfLarge * solves(single), solves(small) <= kMostOfSmall * solves(single)};
}

}  // namespace kairos
