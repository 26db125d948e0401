#include "integrators/mixed_worker.h"

#include <algorithm>

#include <kairos/picture.h>

namespace kairos {

MixedWorker::MixedWorker(const MixedFrame& frame)
    : frame_(frame),
      context_(frame.context),
      shading_(context_.shader, frame.shading),
      still_layer_(context_, frame.scene),
      samples_(context_, frame.scene),
      contrast_(frame.shot.seen_background()),
      record_(context_.needs.surfaces()) {}

const PixelRecord& MixedWorker::render_pixel(int x, int y, Monitor& monitor) {
  const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
  const PixelPlan plan = begin_pixel(x, y, monitor);
  const bool moves = frame_.mask.moves(x, y);
  moving_pixels_ += moves;
  record_.begin_pixel(x, y, context_.background, context_.times(x, y).window());
  record_.set_plan(plan, moves);
  if (plan.tc_rays > 0) {
    ++tc_pixels_;
    render_moving(x, y, pixel, plan, monitor);
  } else {
    render_discrete(x, y, pixel, moves ? DiscreteLayer::all : DiscreteLayer::still, monitor);
  }
  return record_.finish();
}

PixelPlan MixedWorker::begin_pixel(int x, int y, Monitor& monitor) {
  const PixelPlan discrete{0, frame_.budget};
  if (!frame_.is_over_time(x, y)) return discrete;
  const PixelPlan plan = frame_.plan_pixel(x, y);
  if (plan.tc_rays == 0) return discrete;
  // Of shots that follow on each other, rays are not to jump.
  align_ = context_.needs.over_time() ? AlignedPoints() : align_points(frame_.mask, x, y);
  still_layer_.begin_pixel(x, y, context_.sampler.pixel(x, y), align_);
  if (has_still_edge_in_front(x, y, monitor)) return discrete;
  return plan;
}

PixelLook MixedWorker::look_at(int x, int y, Monitor& monitor) {
  const DiscreteLayer layer = frame_.mask.moves(x, y) ? DiscreteLayer::all : DiscreteLayer::still;
  record_.begin_pixel(x, y, context_.background);
  samples_.take(x, y, context_.sampler.pixel(x, y), 0, first_samples(frame_.budget), layer, record_, monitor);
  contrast_.begin_pixel();
  contrast_.add(record_, 0);
  return {contrast_.square(), frame_.sample_price(layer)};
}

double MixedWorker::still_rays_share(int x, int y) {
  if (frame_.still_layer_is_empty) return 0;
  const double share = find_still_share(x, y);
  return share > 0 ? static_cast<double>(still_rays({1, frame_.budget}, share)) / frame_.budget : 0;
}

MixedWorker::RaceErrors MixedWorker::race(int x, int y, Monitor& monitor) {
  const PixelPlan plan = frame_.plan.allotment.plan_over_time(dither(x, y));
  std::array<Vec3f, 2> tc, discrete;
  for (size_t half = 0; half < 2; ++half) {
    const Sampler::Pixel pixel = frame_.race_points[half].pixel(x, y);
    const auto begin = [&] { record_.begin_pixel(x, y, context_.background, context_.times(x, y).window()); };
    align_ = align_points(frame_.mask, x, y);
    still_layer_.begin_pixel(x, y, pixel, align_);
    begin();
    render_moving(x, y, pixel, plan, monitor);
    tc[half] = reduce(record_.finish(), {}, false).colour;
    begin();
    render_discrete(x, y, pixel, DiscreteLayer::all, monitor);
    discrete[half] = reduce(record_.finish(), {}, false).colour;
  }
  const auto error = [](const std::array<Vec3f, 2>& pair) {
    double sum = 0;  // as a display shows them
    for (int c = 0; c < 3; ++c) {
      const double a = std::clamp(pair[0][c], 0.0f, 1.0f), b = std::clamp(pair[1][c], 0.0f, 1.0f);
      sum += (a - b) * (a - b) / 2;
    }
    return sum;
  };
  return {error(tc), error(discrete)};
}

void MixedWorker::add_counts(RenderStats& stats) const {
  add_ray_counts(stats);
  stats.moving_pixels += moving_pixels_;
  stats.tc_pixels += tc_pixels_;
}

void MixedWorker::add_ray_counts(RenderStats& stats) const {
  stats.counters += workspace_.counters();
  stats.rays += workspace_.counters().rays + samples_.ray_count() + still_layer_.ray_count() + share_rays_;
  stats.segments += workspace_.counters().segments + samples_.hit_count();
  stats.shading_samples += shading_.evaluations() + samples_.hit_count() + still_layer_.evaluations();
}

/// Where something that stands still covers a part of the pixel in front of what moves, its outline is the noise,
/// and more rays are better than exact ones.
bool MixedWorker::has_still_edge_in_front(int x, int y, Monitor& monitor) {
  if (!frame_.automatic || frame_.still_layer_is_empty || context_.needs.over_time()) return false;
  const uint32_t probes = probe_rays(frame_.budget);
  const uint32_t in_front = still_layer_.count_nearer(probes, frame_.mask.depth(x, y), monitor);
  return in_front > 0 && in_front < probes;
}

/// Discrete samples over pixel and shutter: as many as the pixel needs, each time twice what there are.
void MixedWorker::render_discrete(int x, int y, const Sampler::Pixel& pixel, DiscreteLayer layer, Monitor& monitor) {
  const std::optional<SampleSpread>& spread = frame_.plan.spread;
  if (!spread) return samples_.take(x, y, pixel, 0, frame_.budget, layer, record_, monitor);
  contrast_.begin_pixel();
  uint32_t taken = first_samples(frame_.budget);
  samples_.take(x, y, pixel, 0, taken, layer, record_, monitor);
  contrast_.add(record_, 0);
  while (taken < spread->count(contrast_.square())) {
    samples_.take(x, y, pixel, taken, 2 * taken, layer, record_, monitor);
    contrast_.add(record_, taken);
    taken *= 2;
  }
}

void MixedWorker::render_moving(int x, int y, const Sampler::Pixel& pixel, const PixelPlan& plan, Monitor& monitor) {
  constexpr uint32_t kMostRays = Tracer::kMaxPacket;
  const PixelTimes times = context_.times(x, y);
  for (uint32_t begin = 0; begin < plan.tc_rays; begin += kMostRays) {
    if (begin % kRaysPerPoll == 0) monitor.poll();
    const uint32_t size = std::min(kMostRays, plan.tc_rays - begin);
    for (uint32_t i = 0; i < size; ++i) {
      const SamplePoint point = align_(context_.sampler.point(pixel, begin + i));
      batch_[i] = context_.ray(x, y, point);
      film_[i] = context_.film(point);
      times_[i] = point.time;
    }
    std::span<const Segment> occluder_hints;
    if (frame_.occluder_hints) occluder_hints = still_layer_.occluder_hints(begin, size, monitor);
    const std::span<const Ray> rays = std::span(batch_).first(size);
    const auto seen = frame_.tracer.trace_packet(rays, Visibility::visible, workspace_, occluder_hints,
                                                 frame_.plan.packets.together(plan.tc_rays), times.limits());
    ends_.clear();
    uint32_t first = record_.part_count();
    shading_.shade({rays, seen, std::span(times_).first(size), pixel.seed, begin, times.window()}, record_, ends_);
    for (uint32_t i = 0; i < size; ++i) {
      record_.add_ray({film_[i], 1, PixelRay::kAll, first, ends_[i] - first,
                       static_cast<uint32_t>(seen[i].segments.size() + seen[i].blended.size())});
      first = ends_[i];
    }
  }
  if (!frame_.still_layer_is_empty) add_still_term(x, y, plan, monitor);
}

void MixedWorker::add_still_term(int x, int y, const PixelPlan& plan, Monitor& monitor) {
  const double share = find_still_share(x, y);
  if (!(share > 0)) return;
  const uint32_t count = frame_.automatic ? still_rays(plan, share) : std::max(plan.tc_rays, plan.discrete);
  if (count <= plan.tc_rays) return;
  still_layer_.add_rays(count, monitor, record_);
  record_.set_still(plan.tc_rays, static_cast<float>(share));
}

/// The share of a few discrete rays, independent of all others, that see what stands still.
double MixedWorker::find_still_share(int x, int y) {
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
  const auto is_still = [&](const auto& hit) { return !hit || frame_.shot.meshes[hit->mesh].is_static(); };
  return static_cast<double>(std::count_if(hits.begin(), hits.end(), is_still)) / kShareRays;
}

}  // namespace kairos
