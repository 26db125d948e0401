// One pixel of mixed and auto: time-continuous rays for what moves, discrete rays for what stands still.
// docs/method.md, "Static and moving in one pixel".
//
// Let L_k be what time-continuous ray k sees. Still rays are cheap, so there are more of them. With their mean S and
// the mean S' over those that lie on the time-continuous rays' own places, the control variate
//   I = mean_k(L_k) + B (S - S')
// takes from the still layer (background included) the noise of the few rays and puts in that of the many, if B is
// about the share of the shutter in which it is seen. B must know nothing of the rays k: W_k, the share that ray k
// sees, goes with the colour along it, and I would be biased. Its second term is handed on as a term of its own,
// PixelRecord::still.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "integrators/contrast.h"
#include "integrators/discrete_samples.h"
#include "integrators/mixed_frame.h"
#include "integrators/resting_pixels.h"
#include "integrators/row_packet.h"
#include "integrators/still_layer.h"
#include "motion/aligned_points.h"

namespace kairos {

class MixedWorker : public Integrator::Worker {
 public:
  /// look_ups: see MakeWorker.
  explicit MixedWorker(const MixedFrame& frame, LookUps* look_ups = nullptr);

  const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override;
  void add_counts(RenderStats& stats) const override;
  /// Those alone that looks have, too.
  void add_ray_counts(RenderStats& stats) const;

  /// What the pixel gets.
  PixelPlan begin_pixel(int x, int y, Monitor& monitor);
  /// What a pixel's first samples say.
  struct Look {
    PixelLook pixel;   ///< its price in nanoseconds, as those of sample_time()
    double asked = 0;  ///< what a sample of everything takes, whether or not anything moves
  };
  Look look_at(int x, int y, Monitor& monitor);
  /// How many still rays a pixel takes beside time-continuous ones, as a share of the budget.
  double still_rays_share(int x, int y);

  /// By both kinds of ray for the same price.
  RacedPixel race(int x, int y, Monitor& monitor);

  // Of pixels in which nothing moves, where the frame has resting_shadows.
  /// Nanoseconds, as those of shadow_prices.h, of an exact look into the pixel; 0 where nothing passes before a light.
  double passing_shadow_time(int x, int y, Monitor& monitor);
  /// Squared errors times what they take.
  struct ShadowRace {
    double exact = 0, sampled = 0;
  };
  ShadowRace race_shadows(int x, int y, Monitor& monitor);

 private:
  /// What a few discrete rays, independent of all others, see of the pixel.
  struct Shares {
    double still = 0;   ///< of what stands still
    double others = 0;  ///< of what shows something else, see Shader::shows_others
  };
  /// What is known of a pixel before it is rendered.
  struct Place {
    StillLayer still_layer;
    PixelPlan plan{};
    AlignedPoints align{};           ///< of its time-continuous rays
    std::optional<Shares> shares{};  ///< once they are known
  };

  bool has_still_edge_in_front(int x, int y, Monitor& monitor);
  bool shows_others(int x, int y);
  void render_discrete(int x, int y, const Sampler::Pixel& pixel, DiscreteLayer layer, Monitor& monitor);
  /// Is something that passes seen in a mirror at rest, by a few rays independent of all others?
  bool passes_in_mirrors(int x, int y);
  /// Unless it has been done already, begins all resting pixels of a strip and looks at the shadows of their first
  /// `rays` still rays together.
  void look_at_resting_strip(int x, int y, uint32_t rays, Monitor& monitor);
  void render_resting(int x, int y, const Sampler::Pixel& pixel, Monitor& monitor);
  /// Along how many of a pixel's still rays shadows are found exactly.
  uint32_t exact_rays(uint32_t still_rays) const;
  /// Plans all pixels of a strip.
  void begin_strip(int left, int y, Monitor& monitor);
  /// strip: with the rays of pixels beside it, see PacketChoice::strip; else by itself.
  void render_moving(int x, int y, const Sampler::Pixel& pixel, const PixelPlan& plan, bool strip, Monitor& monitor);
  RowPacket::Rays trace_alone(int x, int y, const Sampler::Pixel& pixel, uint32_t begin, uint32_t count,
                              Monitor& monitor);
  /// Unless it has been traced already, the packet of the strip that pixel (x, y) is in: each takes as many pixels as
  /// fit in.
  RowPacket::Rays trace_in_strip(int x, int y, Monitor& monitor);
  void add_still_term(int x, int y, const PixelPlan& plan, Monitor& monitor);
  const Shares& shares_of(int x, int y);
  /// Gives what waits for light that is shared, of a pixel that is looked at, colours without noise, which is not the
  /// pixel's own affair. Nothing where light is not shared.
  void colour_unlit();
  uint64_t awaited_by_rays() const;
  SampleWork find_sample_work(int x, int y, const Sampler::Pixel& pixel, uint32_t rays, Monitor& monitor);

  const MixedFrame& frame_;
  const PixelContext& context_;
  Tracer::Workspace workspace_, strip_workspace_, instants_;
  PacketShading shading_;
  RowPacket packet_, strip_packet_;
  std::vector<uint32_t> ends_;  // [ray of a packet]: of its parts
  std::vector<Place> places_;   // [pixel of the strip]
  int strip_x_ = -1, strip_y_ = -1, last_x_ = -1, resting_strip_x_ = -1;
  Place* here_;  // the pixel's
  DiscreteSamples samples_;
  LookUps* const look_ups_;
  std::optional<RestingPixels> resting_;
  Contrast contrast_;
  RecordBuilder record_;
  uint64_t moving_pixels_ = 0, tc_pixels_ = 0, share_rays_ = 0, layers_ = 0;
};

}  // namespace kairos
