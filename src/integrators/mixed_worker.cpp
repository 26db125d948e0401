#include "integrators/mixed_worker.h"

#include <algorithm>

namespace kairos {

MixedWorker::MixedWorker(const MixedFrame& frame, LookUps* look_ups)
    : frame_(frame),
      context_(frame.context),
      shading_(context_.shader, frame.tc_shading(), look_ups),
      packet_(context_),
      strip_packet_(context_),
      samples_(context_, frame.scene, look_ups),
      look_ups_(look_ups),
      contrast_(frame.shot.seen_background()),
      record_(context_.needs.surfaces()) {
  places_.reserve(static_cast<size_t>(frame.strip()));
  for (int i = 0; i < frame.strip(); ++i) places_.push_back({StillLayer(context_, frame.scene, look_ups)});
  here_ = places_.data();
  if (frame.resting_shadows)
    resting_.emplace(*frame.resting_shadows, frame.resting_mirrors ? &*frame.resting_mirrors : nullptr,
                     lit_sample_time(frame.shot, frame.params.shading));
}

const PixelRecord& MixedWorker::render_pixel(int x, int y, Monitor& monitor) {
  const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
  // Whoever asks for a pixel again gets it made again.
  const int left = x - x % frame_.strip();
  if (left != strip_x_ || y != strip_y_ || x <= last_x_) begin_strip(left, y, monitor);
  last_x_ = x;
  here_ = &places_[static_cast<size_t>(x - strip_x_)];
  const PixelPlan plan = here_->plan;
  const bool moves = frame_.mask.moves(x, y);
  moving_pixels_ += moves;
  record_.begin_pixel(x, y, context_.background, context_.times(x, y).window());
  record_.set_plan(plan, moves);
  if (plan.tc_rays > 0) {
    ++tc_pixels_;
    render_moving(x, y, pixel, plan, frame_.strip(plan.tc_rays) > 1, monitor);
  } else if (resting_ && !moves) {
    render_resting(x, y, pixel, monitor);
  } else {
    render_discrete(x, y, pixel, moves ? DiscreteLayer::all : DiscreteLayer::still, monitor);
  }
  return record_.finish();
}

void MixedWorker::begin_strip(int left, int y, Monitor& monitor) {
  strip_x_ = -1;  // until it is whole
  resting_strip_x_ = -1;
  if (resting_) resting_->begin_strip();
  strip_packet_.begin(y);
  const int right = std::min(left + frame_.strip(), frame_.shot.projection.width);
  for (int x = left; x < right; ++x) {
    here_ = &places_[static_cast<size_t>(x - left)];
    here_->plan = begin_pixel(x, y, monitor);
  }
  strip_x_ = left;
  strip_y_ = y;
}

PixelPlan MixedWorker::begin_pixel(int x, int y, Monitor& monitor) {
  const PixelPlan discrete{0, frame_.budget};
  here_->shares.reset();
  if (!frame_.is_over_time(x, y)) return discrete;
  const PixelPlan plan = frame_.plan_pixel(x, y);
  if (plan.tc_rays == 0) return discrete;
  // Of shots that follow on each other, rays are not to jump.
  here_->align = context_.needs.over_time() ? AlignedPoints() : align_points(frame_.mask, x, y);
  here_->still_layer.begin_pixel(x, y, context_.sampler.pixel(x, y), here_->align);
  if (has_still_edge_in_front(x, y, monitor) || shows_others(x, y)) return discrete;
  return plan;
}

void MixedWorker::add_counts(RenderStats& stats) const {
  add_ray_counts(stats);
  stats.moving_pixels += moving_pixels_;
  stats.tc_pixels += tc_pixels_;
}

void MixedWorker::add_ray_counts(RenderStats& stats) const {
  TraceCounters traced = workspace_.counters();
  traced += strip_workspace_.counters();
  stats.counters += traced;
  stats.counters += shading_.further_counters();
  stats.counters += packet_.shadow_counters();
  stats.counters += strip_packet_.shadow_counters();
  if (resting_) stats.counters += resting_->counters();
  stats.rays += traced.rays + samples_.ray_count() + share_rays_;
  stats.segments += traced.segments + samples_.hit_count();
  stats.shading_samples += shading_.evaluations() + samples_.evaluations();
  for (const Place& place : places_) {
    stats.rays += place.still_layer.ray_count();
    stats.shading_samples += place.still_layer.evaluations();
  }
}

/// Where something that stands still covers a part of the pixel in front of what moves, its outline is the noise,
/// and more rays are better than exact ones.
bool MixedWorker::has_still_edge_in_front(int x, int y, Monitor& monitor) {
  if (!frame_.automatic || frame_.still_layer_is_empty || context_.needs.over_time()) return false;
  const uint32_t probes = probe_rays(frame_.budget);
  const uint32_t in_front = here_->still_layer.count_nearer(probes, frame_.mask.depth(x, y), monitor);
  return in_front > 0 && in_front < probes;
}

/// Discrete samples over pixel and shutter: as many as the pixel needs, each time twice what there are. Where light is
/// shared, its noise is not the pixel's own, and all get the budget.
void MixedWorker::render_discrete(int x, int y, const Sampler::Pixel& pixel, DiscreteLayer layer, Monitor& monitor) {
  const std::optional<SampleSpread>& spread = frame_.plan.spread;
  if (!spread || look_ups_ != nullptr) return samples_.take(x, y, pixel, 0, frame_.budget, layer, record_, monitor);
  contrast_.begin_pixel();
  uint32_t taken = spread->first();
  samples_.take(x, y, pixel, 0, taken, layer, record_, monitor);
  contrast_.add(record_, 0);
  while (taken < spread->count(contrast_.square())) {
    samples_.take(x, y, pixel, taken, 2 * taken, layer, record_, monitor);
    contrast_.add(record_, taken);
    taken *= 2;
  }
}

bool MixedWorker::passes_in_mirrors(int x, int y) {
  if (resting_->mirrors() == nullptr) return false;
  constexpr uint32_t kLooks = 2;
  const Sampler::Pixel pixel = frame_.share_points.pixel(x, y);
  const TimeRange window = context_.times(x, y).window();
  for (uint32_t i = 0; i < kLooks; ++i) {
    const Ray ray = context_.ray(x, y, frame_.share_points.point(pixel, i));
    std::optional<DiscreteHit> still;
    frame_.scene.intersect({&ray, 1}, {&window.begin, 1}, {&still, 1}, DiscreteLayer::still);
    ++share_rays_;
    if (still && resting_->passes_in_mirror(ray, *still, window)) return true;
  }
  return false;
}

/// As many samples as render_discrete() takes, by a contrast that knows nothing of what passes; where that is seen in a
/// mirror, it is as uneven as things themselves are, and at least the budget is taken.
void MixedWorker::render_resting(int x, int y, const Sampler::Pixel& pixel, Monitor& monitor) {
  const std::optional<SampleSpread> spread = look_ups_ == nullptr ? frame_.plan.spread : std::nullopt;
  const ExactShadows* shadows = resting_->shadows();
  const ExactMirrors* mirrors = resting_->mirrors();
  uint32_t taken = spread ? spread->first() : frame_.budget;
  if (const uint32_t rays = exact_rays(taken); frame_.strip(rays) > 1)
    look_at_resting_strip(x, y, rays, monitor);
  else
    here_->still_layer.begin_pixel(x, y, pixel, {});
  here_->still_layer.add_rays(0, taken, shadows, mirrors, monitor, record_);
  if (spread) {
    contrast_.begin_pixel();
    contrast_.add(record_, record_.still_rays());
    const uint32_t least = passes_in_mirrors(x, y) ? frame_.budget : 0;
    while (taken < std::max(least, spread->count(contrast_.square()))) {
      here_->still_layer.add_rays(taken, 2 * taken, shadows, mirrors, monitor, record_);
      contrast_.add(record_, record_.still_rays().subspan(taken));
      taken *= 2;
    }
  }
  const uint32_t exact = exact_rays(taken);
  record_.set_plan({exact, taken}, false);
  resting_->add_exact(x, here_->still_layer, exact, context_.times(x, y).window(), record_, look_ups_);
}

void MixedWorker::look_at_resting_strip(int x, int y, uint32_t rays, Monitor& monitor) {
  const int strip = frame_.strip(rays), left = x - x % strip;
  if (left == resting_strip_x_) return;
  resting_strip_x_ = left;
  resting_->begin_strip();
  for (int px = left; px < std::min(left + strip, frame_.shot.projection.width); ++px) {
    Place& place = places_[static_cast<size_t>(px - strip_x_)];
    if (place.plan.tc_rays > 0 || frame_.mask.moves(px, y)) continue;
    place.still_layer.begin_pixel(px, y, context_.sampler.pixel(px, y), {});
    resting_->add_to_strip(px, place.still_layer, rays, monitor);
  }
  resting_->look_at_strip(context_.times(x, y).window());
}

uint32_t MixedWorker::exact_rays(uint32_t still_rays) const {
  if (!frame_.automatic) return std::min(still_rays, frame_.fixed_plan.tc_rays);
  return std::max(1u, still_rays / frame_.plan.still_rays_per_exact);
}

RowPacket::Rays MixedWorker::trace_alone(int x, int y, const Sampler::Pixel& pixel, uint32_t begin, uint32_t count,
                                         Monitor& monitor) {
  const uint32_t size = std::min(RowPacket::kMostRays, count - begin);
  std::span<const Segment> occluder_hints;
  if (frame_.occluder_hints) occluder_hints = here_->still_layer.occluder_hints(begin, size, monitor);
  packet_.begin(y);
  packet_.add(x, pixel, here_->align, begin, size, occluder_hints);
  packet_.trace(frame_.tracer, workspace_, frame_.plan.packets.together(count), context_.times(x, y).limits(),
                shading_.packet_shadows());
  return packet_.of(x);
}

RowPacket::Rays MixedWorker::trace_in_strip(int x, int y, Monitor& monitor) {
  if (strip_packet_.holds(x, y)) return strip_packet_.of(x);
  strip_packet_.begin(y);
  const int right = std::min(strip_x_ + frame_.strip(), frame_.shot.projection.width);
  for (int px = strip_x_; px < right; ++px) {
    Place& place = places_[static_cast<size_t>(px - strip_x_)];
    const uint32_t count = place.plan.tc_rays;
    const int strip = frame_.strip(count);
    if (strip == 1) continue;
    if (!strip_packet_.fits(px, count, strip)) {
      if (strip_packet_.holds(x, y)) break;
      strip_packet_.begin(y);
    }
    std::span<const Segment> occluder_hints;
    if (frame_.occluder_hints) occluder_hints = place.still_layer.occluder_hints(0, count, monitor);
    strip_packet_.add(px, context_.sampler.pixel(px, y), place.align, 0, count, occluder_hints);
  }
  strip_packet_.trace(frame_.tracer, strip_workspace_, true, {}, shading_.packet_shadows());
  return strip_packet_.of(x);
}

void MixedWorker::render_moving(int x, int y, const Sampler::Pixel& pixel, const PixelPlan& plan, bool strip,
                                Monitor& monitor) {
  const PixelTimes times = context_.times(x, y);
  for (uint32_t begin = 0; begin < plan.tc_rays; begin += RowPacket::kMostRays) {
    if (begin % kRaysPerPoll == 0) monitor.poll();
    const RowPacket::Rays rays =
        strip ? trace_in_strip(x, y, monitor) : trace_alone(x, y, pixel, begin, plan.tc_rays, monitor);
    for (const SeenByRay& ray : rays.seen) layers_ += ray.blended.size();
    shade_rays(rays, pixel.seed, begin, times.window(), shading_, ends_, record_);
  }
  if (!frame_.still_layer_is_empty && plan.discrete > 0) add_still_term(x, y, plan, monitor);
}

void MixedWorker::add_still_term(int x, int y, const PixelPlan& plan, Monitor& monitor) {
  const double share = shares_of(x, y).still;
  if (!(share > 0)) return;
  const uint32_t count = frame_.automatic ? still_rays(plan, share) : std::max(plan.tc_rays, plan.discrete);
  if (count <= plan.tc_rays) return;
  here_->still_layer.add_rays(0, count, frame_.tc_shadows ? &*frame_.tc_shadows : nullptr, nullptr, monitor, record_);
  record_.set_still(plan.tc_rays, static_cast<float>(share));
}

/// What is seen in mirrors and behind glass has noise of its own, which is the less the more places in the pixel there
/// are: more rays are better than exact ones.
bool MixedWorker::shows_others(int x, int y) {
  return frame_.automatic && frame_.any_shows_others && !context_.needs.over_time() && shares_of(x, y).others >= 0.5;
}

const MixedWorker::Shares& MixedWorker::shares_of(int x, int y) {
  if (here_->shares) return *here_->shares;
  const Sampler& sampler = frame_.share_points;
  const Sampler::Pixel pixel = sampler.pixel(x, y);
  std::array<Ray, kShareRays> rays;
  std::array<float, kShareRays> times{};
  std::array<std::optional<DiscreteHit>, kShareRays> hits;
  const PixelTimes pixel_times = context_.times(x, y);
  for (uint32_t i = 0; i < kShareRays; ++i) {
    const SamplePoint point = sampler.point(pixel, i);
    rays[i] = context_.ray(x, y, point);
    times[i] = pixel_times.instant(point.time);
  }
  frame_.scene.intersect(rays, times, hits, DiscreteLayer::all);
  share_rays_ += kShareRays;
  const auto share_of = [&](const auto& is_part) {
    return static_cast<double>(std::count_if(hits.begin(), hits.end(), is_part)) / kShareRays;
  };
  return here_->shares.emplace(
      Shares{share_of([&](const auto& hit) { return !hit || frame_.shot.meshes[hit->mesh].is_static(); }),
             share_of([&](const auto& hit) { return hit && context_.shader.shows_others(hit->mesh); })});
}

}  // namespace kairos
