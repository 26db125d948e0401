// What looks and races find out in one pixel of mixed and auto, before the picture.
#include <algorithm>

#include <kairos/picture.h>

#include "integrators/mixed_worker.h"

namespace kairos {

namespace {

/// Of one of two pictures that know nothing of each other, as a display shows them.
double squared_error(const std::array<Vec3f, 2>& pair) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double a = std::clamp(pair[0][c], 0.0f, 1.0f), b = std::clamp(pair[1][c], 0.0f, 1.0f);
    sum += (a - b) * (a - b) / 2;
  }
  return sum;
}

TraceCounters since(const TraceCounters& before, TraceCounters now) {
  now.rays -= before.rays;
  now.nodes -= before.nodes;
  now.triangles -= before.triangles;
  now.root_solves -= before.root_solves;
  now.hits -= before.hits;
  now.segments -= before.segments;
  return now;
}

}  // namespace

void MixedWorker::colour_unlit() {
  if (look_ups_ == nullptr) return;
  for (const LookUps::Link& link : look_ups_->links()) {
    const Knot& knot = record_.knots()[link.knot];
    const Vec3f colour = context_.shader.unlit_colour(look_ups_->queries()[link.query]);
    record_.set_knot(link.knot, knot.time, knot.colour + colour, {}, {});
  }
  look_ups_->clear();
}

/// Look-ups of the pixel's time-continuous rays.
uint64_t MixedWorker::awaited_by_rays() const {
  const auto sees = [](const PixelRay& ray) { return ray.parts > 0; };
  const auto still = std::count_if(record_.still_rays().begin(), record_.still_rays().end(), sees);
  return look_ups_->count() - std::min(look_ups_->count(), static_cast<uint32_t>(still));
}

MixedWorker::Look MixedWorker::look_at(int x, int y, Monitor& monitor) {
  constexpr uint32_t kRays = 2;  // that say what a sample passes
  const bool moves = frame_.mask.moves(x, y);
  const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
  const uint32_t first = first_samples(frame_.budget);
  SampleWork work;
  if (moves) {
    here_->align = {};
    here_->still_layer.begin_pixel(x, y, pixel, here_->align);
    work = find_sample_work(x, y, pixel, kRays, monitor);
  }
  record_.begin_pixel(x, y, context_.background);
  contrast_.begin_pixel();
  if (look_ups_ != nullptr) look_ups_->clear();
  double shadows = 0;
  std::span<const PixelRay> rays;
  if (resting_ && !moves) {
    here_->still_layer.begin_pixel(x, y, pixel, {});
    here_->still_layer.add_rays(0, first, resting_->shadows(), resting_->mirrors(), monitor, record_);
    rays = record_.still_rays();
    contrast_.add(record_, rays);
    const double before = resting_->time();
    resting_->add_exact(x, here_->still_layer, exact_rays(first), {}, record_, look_ups_);
    shadows = (resting_->time() - before) / first;
  } else {
    samples_.take(x, y, pixel, 0, first, moves ? DiscreteLayer::all : DiscreteLayer::still, record_, monitor);
    rays = record_.rays();
    contrast_.add(record_, 0);
  }
  work.seen = work.others = 0;
  for (const PixelRay& ray : rays.first(first)) {
    const uint32_t mesh = ray.parts > 0 ? record_.parts()[ray.first_part].where.mesh : kNoMesh;
    work.seen += mesh != kNoMesh;
    work.others += mesh != kNoMesh && context_.shader.shows_others(mesh);
  }
  work.seen /= first;
  work.others /= first;
  const Surroundings& around = frame_.surroundings;
  if (moves) return {{contrast_.square(), sample_time(work, around)}, sample_time(work, around)};
  return {{contrast_.square(), resting_sample_time(work, around) + shadows}, idle_sample_time(work, around)};
}

double MixedWorker::still_rays_share(int x, int y) {
  if (frame_.still_layer_is_empty) return 0;
  const double share = shares_of(x, y).still;
  return share > 0 ? static_cast<double>(still_rays({1, frame_.budget}, share)) / frame_.budget : 0;
}

RacedPixel MixedWorker::race(int x, int y, Monitor& monitor) {
  here_->shares.reset();
  const Surroundings& around = frame_.surroundings;
  RacedPixel result;
  result.speed = frame_.speed(x, y);
  const auto look_ups = [&](uint32_t rays) { return static_cast<double>(rays) * frame_.shading.samples; };
  const auto counts = raced_counts(frame_.raced_rays(), context_.sampler.count(), frame_.races_thriftily());
  for (size_t i = 0; i < counts.size(); ++i) result.tc[i].count = counts[i];
  using Pair = std::array<Vec3f, 2>;
  Pair discrete;
  std::array<std::array<Pair, 2>, counts.size()> seen;  // [number of rays][corrected?]
  for (size_t half = 0; half < 2; ++half) {
    const Sampler::Pixel pixel = frame_.race_points[half].pixel(x, y);
    const auto begin = [&] {
      record_.begin_pixel(x, y, context_.background, context_.times(x, y).window());
      if (look_ups_ != nullptr) look_ups_->clear();
    };
    here_->align = align_points(frame_.mask, x, y);
    here_->still_layer.begin_pixel(x, y, pixel, here_->align);
    for (size_t i = 0; i < result.tc.size(); ++i) {
      if (result.tc[i].count == 0) continue;
      begin();
      const uint32_t count = result.tc[i].count;
      const TraceCounters before = workspace_.counters();
      const uint64_t known = shading_.evaluations(), layers = layers_;
      render_moving(x, y, pixel, {count, frame_.budget}, false, monitor);
      const uint64_t evaluations = shading_.evaluations() - known + (look_ups_ != nullptr ? awaited_by_rays() : 0);
      const RayWork work(since(before, workspace_.counters()), evaluations, layers_ - layers,
                         frame_.plan.packets.together(count), count);
      result.tc[i].time += count * tc_ray_time(work, around) / 2;
      colour_unlit();
      PixelRecord record = record_.finish();
      seen[i][1][half] = reduce(record, {}, false).colour;
      record.still = {};
      seen[i][0][half] = reduce(record, {}, false).colour;
    }
    constexpr uint32_t kRays = 4;
    result.sample_time += sample_time(find_sample_work(x, y, pixel, kRays, monitor), around) / 2;
    begin();
    render_discrete(x, y, pixel, DiscreteLayer::all, monitor);
    colour_unlit();
    discrete[half] = reduce(record_.finish(), {}, false).colour;
  }
  // Colours had no noise of light; what there is falls with the number of look-ups.
  result.discrete_error = squared_error(discrete) + frame_.light_error;
  for (size_t i = 0; i < result.tc.size(); ++i) {
    RacedPixel::Rays& rays = result.tc[i];
    if (rays.count == 0) continue;
    for (size_t way = 0; way < rays.error.size(); ++way)
      rays.error[way] = squared_error(seen[i][way]) + frame_.light_error * frame_.budget / look_ups(rays.count);
    // They were traced by themselves.
    rays.time *= strip_share(frame_.plan.work, around, rays.count);
    if (around.anything_still) rays.time += rays.count * resting_sample_time({}, around);
  }
  return result;
}

double MixedWorker::passing_shadow_time(int x, int y, Monitor& monitor) {
  const uint32_t looks = std::min(2u, frame_.budget);
  here_->still_layer.begin_pixel(x, y, frame_.race_points[0].pixel(x, y), {});
  record_.begin_pixel(x, y, context_.background);
  here_->still_layer.add_rays(0, looks, resting_->shadows(), resting_->mirrors(), monitor, record_);
  const double before = resting_->time();
  resting_->add_exact(x, here_->still_layer, looks, {}, record_);
  return resting_->changes() ? (resting_->time() - before) / looks : 0;
}

MixedWorker::ShadowRace MixedWorker::race_shadows(int x, int y, Monitor& monitor) {
  std::array<Vec3f, 2> exact, sampled;
  const TimeRange window = context_.times(x, y).window();
  const double before = resting_->time();
  for (size_t half = 0; half < 2; ++half) {
    const Sampler::Pixel pixel = frame_.race_points[half].pixel(x, y);
    record_.begin_pixel(x, y, context_.background, window);
    here_->still_layer.begin_pixel(x, y, pixel, {});
    here_->still_layer.add_rays(0, frame_.budget, resting_->shadows(), resting_->mirrors(), monitor, record_);
    resting_->add_exact(x, here_->still_layer, exact_rays(frame_.budget), window, record_);
    exact[half] = reduce(record_.finish(), {}, false).colour;
    record_.begin_pixel(x, y, context_.background, window);
    samples_.take(x, y, pixel, 0, frame_.budget, DiscreteLayer::still, record_, monitor);
    sampled[half] = reduce(record_.finish(), {}, false).colour;
  }
  const double samples = frame_.budget * lit_sample_time(frame_.shot, frame_.params.shading);
  const double both = samples + (resting_->time() - before) / 2;
  return {squared_error(exact) * both, squared_error(sampled) * samples};
}

/// Of a discrete sample of everything, by what rays pass that look for a moment only.
SampleWork MixedWorker::find_sample_work(int x, int y, const Sampler::Pixel& pixel, uint32_t rays, Monitor& monitor) {
  const uint32_t count = std::min(rays, context_.sampler.count());
  std::span<const Segment> hints;
  if (frame_.occluder_hints) hints = here_->still_layer.occluder_hints(0, count, monitor);
  const TraceCounters before = instants_.counters();
  for (uint32_t i = 0; i < count; ++i) {
    const Ray ray = context_.ray(x, y, here_->align(context_.sampler.point(pixel, i)));
    const auto instant = static_cast<uint32_t>(pixel.seed + uint64_t{i} * (kInstants / rays));
    frame_.tracer.trace_packet({&ray, 1}, Visibility::visible, instants_, hints.empty() ? hints : hints.subspan(i, 1),
                               false, instant_limits(instant));
  }
  SampleWork work = frame_.plan.work.sample;
  work.instant = RayWork(since(before, instants_.counters()), 0, 0);
  return work;
}

}  // namespace kairos
