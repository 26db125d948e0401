// What rays cost: measured once for a shot, or from counts of their work. Either are recorded numbers instead of
// clocks, so that a picture is the same every time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <kairos/render.h>
#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"
#include "motion/motion_mask.h"
#include "policy/packet_choice.h"
#include "shading/pixel_context.h"
#include "shading/spread.h"

namespace kairos {

/// Of time-continuous rays, but for the discrete ones by which the share of the still layer is found.
RayPrices without_shares(RayPrices prices);

/// Of one of `rays` time-continuous rays in a pixel: on straight lines over the logarithm of their number.
double tc_ray_price(const RayPrices& prices, double rays);

/// Throws Error(bad_usage) for times that nothing takes.
RayPrices prices_of(const Calibration& calibration);

/// What a ray took, in the mean over some.
struct RayWork {
  double nodes = 0, triangles = 0, root_solves = 0, hits = 0, segments = 0;  ///< see TraceCounters
  double evaluations = 0;                                                    ///< of the shader
  double layers = 0;                                                         ///< segments of blended surfaces
  /// The share of rays that come upon what no other has come upon just before: all that go together, whose counts fall
  /// with their number. Of those that follow each other in a pixel one by one, it is the first.
  double fresh = 1;

  RayWork() = default;
  /// Of `counters.rays` rays; zero of none. together: see PacketChoice, of as many rays in each pixel.
  RayWork(const TraceCounters& counters, uint64_t evaluations, uint64_t layers, bool together = true,
          uint32_t in_pixel = 1);
};

/// What a discrete sample of a pixel comes upon, in the mean over some.
struct SampleWork {
  /// Of rays that look for a sixteenth of the shutter: about what a discrete ray passes of what moves.
  RayWork instant;
  double placed = 0;  ///< the share of what these see that are instances
  double seen = 1;    ///< the share of samples that see anything
  double others = 0;  ///< the share of samples that see what shows others, see Shader::shows_others
};

/// Of rays through pixels in which something moves; zero where there are none.
struct WorkSample {
  /// Of time-continuous rays, where there are as many of them in a pixel as Calibration::kRays says: as they are
  /// traced, see PacketChoice.
  std::array<RayWork, Calibration::kRays.size()> tc{};
  SampleWork sample;
  /// As `tc`, without rays of other pixels.
  std::array<RayWork, Calibration::kRays.size()> alone{};
};

/// Sixteenths of the shutter are the shortest times of which a tree leaves out what happens at others.
inline constexpr uint32_t kInstants = 16;
inline TraceLimits instant_limits(uint32_t instant) {
  const auto width = 1.0f / static_cast<float>(kInstants), begin = static_cast<float>(instant % kInstants) * width;
  return {begin, begin + width};
}

/// Traces and shades a few hundred rays, spread over the pixels that the mask names, in parallel. hints: what stands
/// still, where the tracer knows nothing of it and is told of each ray what it meets there; else null.
WorkSample sample_ray_work(const PixelContext& context, const Shot& shot, const MotionMask& mask, const Tracer& tracer,
                           const DiscreteScene* hints, const PacketChoice& packets, const ShadingOptions& options);

/// Discrete rays of a pixel with time-continuous ones, by which the share of the still layer is found, where there is
/// one.
inline constexpr uint32_t kShareRays = 4;

// Nanoseconds; only their ratios matter.
/// For so much work of single time-continuous rays, see TraceCounters; what shadows are priced by.
double tracing_time(double nodes, double triangles, double hits);
/// What the time of a ray depends on, of a whole picture.
struct Surroundings {
  bool anything_still = false;  ///< does any mesh have a single key?
  bool still_layer = false;     ///< or is there a sky?
  size_t moving_trees = 1;      ///< DiscreteStats::trees of what moves: a discrete ray asks each
  double light = 0;             ///< of a shading sample, beyond one with normals
  uint32_t samples = 64;        ///< of a pixel, of which the first is dearer

  Surroundings() = default;
  Surroundings(const Shot& shot, const DiscreteScene& scene, const Shader& shader, ShadingKind shading,
               uint32_t samples);
};
/// Of a time-continuous ray from the camera, with shading.
double tc_ray_time(const RayWork& work, const Surroundings& around);
/// What rays that are traced with those of other pixels take, as a share of what they would by themselves; of `rays` in
/// a pixel.
double strip_share(const WorkSample& work, const Surroundings& around, uint32_t rays);
/// Of a discrete sample of everything where something moves.
double sample_time(const SampleWork& work, const Surroundings& around);
/// Of one to what stands still, where nothing else is; and of one that asks for what moves all the same.
double resting_sample_time(const SampleWork& work, const Surroundings& around);
double idle_sample_time(const SampleWork& work, const Surroundings& around);

/// Where anything stands still, a pixel's time-continuous rays come with discrete ones
/// (docs/method.md, "Static and moving in one pixel").
RayPrices estimate_prices(const WorkSample& work, const Surroundings& around);

}  // namespace kairos
