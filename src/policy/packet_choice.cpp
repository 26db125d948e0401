#include "policy/packet_choice.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <span>

#include "base/parallel.h"

namespace kairos {

namespace {

/// Pairs of a ray and a triangle solved, relative to single rays, up to which packets are faster. Measured: packets of
/// 16 take 0.75 to 0.85 of the time at 2 and as much at 3; packets of four 0.9 at 1.6. Those of strips keep the hits of
/// several pixels at a time: with four rays in a pixel pictures take 0.8 of the time at 1, 0.9 at 1.8; with one, whose
/// strips are long, 0.87 at 1.4 and 1.2 times as long at 2.
constexpr double kMostOfLarge = 2.5, kMostOfSmall = 1.8, kMostOfStrips = 1.9, kMostOfLongStrips = 1.5;
constexpr uint32_t kPacketPixels = 24, kPacketRays = Tracer::kMaxPacket;
constexpr size_t kPacketPixelsPerTask = 4;

/// Pairs solved, each for kPacketRays rays of a pixel.
struct Solves {
  uint64_t single = 0, small = 0, large = 0, strip = 0, long_strip = 0;

  Solves& operator+=(const Solves& other) {
    single += other.single;
    small += other.small;
    large += other.large;
    strip += other.strip;
    long_strip += other.long_strip;
    return *this;
  }
};

/// Per ray, of the strip in which pixel (x, y) lies, which has `count` rays in each of its pixels.
double solves_of_strip(const PixelContext& context, const Projection& projection, const Tracer& tracer, int x, int y,
                       uint32_t count) {
  const Sampler points(SamplerKind::owen_sobol, count, 0);
  const int pixels = PacketChoice().strip(count), left = x - x % pixels;
  std::array<Ray, kPacketRays> rays;
  uint32_t size = 0;
  for (int px = left; px < std::min(left + pixels, projection.width); ++px) {
    const Sampler::Pixel pixel = points.pixel(px, y);
    for (uint32_t i = 0; i < count; ++i) rays[size++] = context.ray(px, y, points.point(pixel, i));
  }
  Tracer::Workspace workspace;
  tracer.trace_packet(std::span(rays).first(size), Visibility::visible, workspace);
  return static_cast<double>(workspace.counters().root_solves) / size;
}

}  // namespace

PacketChoice choose_packets(const PixelContext& context, const Projection& projection, const Tracer& tracer) {
  const Sampler places(SamplerKind::owen_sobol, kPacketPixels, 0), points(SamplerKind::owen_sobol, kPacketRays, 0);
  Solves sum;
  std::mutex mutex;  // of the sum
  parallel_for(kPacketPixels, kPacketPixelsPerTask, [&](size_t begin, size_t end) {
    Tracer::Workspace one_by_one, by_four, all;
    std::array<Ray, kPacketRays> rays;
    Solves here;
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
      const auto for_all = [&](uint32_t count) {
        return static_cast<uint64_t>(kPacketRays * solves_of_strip(context, projection, tracer, x, y, count));
      };
      here += {0, 0, 0, for_all(4), for_all(1)};
    }
    here += {one_by_one.counters().root_solves, by_four.counters().root_solves, all.counters().root_solves, 0, 0};
    const std::lock_guard<std::mutex> lock(mutex);
    sum += here;
  });
  const auto few = [&](uint64_t solves, double most) {
    return static_cast<double>(solves) <= most * static_cast<double>(sum.single);
  };
  return {few(sum.large, kMostOfLarge), few(sum.small, kMostOfSmall), few(sum.strip, kMostOfStrips),
          few(sum.long_strip, kMostOfLongStrips)};
}

}  // namespace kairos
