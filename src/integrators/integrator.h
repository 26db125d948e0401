// What all integrators have in common: they answer for one pixel at a time.
#pragma once

#include <memory>

#include "base/monitor.h"
#include "integrators/shot_parts.h"
#include "pixel/record_builder.h"
#include "shading/pixel_context.h"

namespace kairos {

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// One thread's scratch memory and counters.
  class Worker {
   public:
    virtual ~Worker() = default;
    /// The pixel's record, which depends on nothing rendered before; valid until the next call. Polls the monitor, and
    /// so may throw Error(cancelled).
    virtual const PixelRecord& render_pixel(int x, int y, Monitor& monitor) = 0;
    /// Adds this worker's counts to `stats`.
    virtual void add_counts(RenderStats& stats) const = 0;
  };

  /// What has to be known of the whole frame before its first pixel; called once, adds what it traces to `stats`. The
  /// same for any crop.
  virtual void prepare(Monitor& /*monitor*/, RenderStats& /*stats*/) {}
  virtual std::unique_ptr<Worker> make_worker() const = 0;
  /// Pixels of a square of this side, aligned to the frame, are best asked for one after the other, of one worker. 0:
  /// any order will do.
  virtual int tile_side() const { return 0; }
};

/// A slow pixel must not keep one waiting: poll the monitor once per this many rays.
inline constexpr uint32_t kRaysPerPoll = 64;

// What the integrator takes of `parts` and `context` must outlive it.
std::unique_ptr<Integrator> make_tc_integrator(ShotParts& parts, const RenderParams& params,
                                               const PixelContext& context, RenderStats& stats);
std::unique_ptr<Integrator> make_bounds_integrator(const Shot& shot, const RenderParams& params,
                                                   const PixelContext& context, RenderStats& stats);
std::unique_ptr<Integrator> make_mixed_integrator(ShotParts& parts, const RenderParams& params,
                                                  const PixelContext& context, RenderStats& stats);
std::unique_ptr<Integrator> make_qmc_integrator(ShotParts& parts, const RenderParams& params,
                                                const PixelContext& context);

}  // namespace kairos
