#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include <kairos/error.h>
#include <kairos/events.h>

#include "events/event_film.h"
#include "events/recording_state.h"

namespace kairos {

namespace {

/// Of a chunk, on both of its sides: so long before and after it passes a ray an edge is followed over the pixel.
constexpr double kReachShare = 0.1;
constexpr int kMostSide = 65535;  // pixels: what an event's 16 bits name
constexpr double kMostSeconds = 1e6;

void check(const EventOptions& options) {
  const auto need = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorCode::bad_usage, "", what);
  };
  const auto between = [](double value, double low, double high) { return value >= low && value <= high; };
  need(std::abs(options.from) <= kMostSeconds && std::abs(options.to) <= kMostSeconds && options.from < options.to,
       "a recording must end after it begins, and both within a million seconds of the scene's time 0");
  constexpr std::array<int, 5> kRays{1, 4, 16, 64, 256};
  need(std::find(kRays.begin(), kRays.end(), options.rays) != kRays.end(),
       "rays per pixel must be 1, 4, 16, 64 or 256: each stands for a square part of the pixel");
  need(options.looks >= 2 && options.looks <= 65536, "looks at colours must be 2 to 65536 a second");
  need(between(options.chunk, 1e-4, 60), "a chunk must be 0.0001 to 60 seconds long");
  const ShadingKind shading = options.render.shading;
  need(shading != ShadingKind::bounds && shading != ShadingKind::bounds_exact, "pictures of bounds show no light");
  const EventSensor& sensor = options.sensor;
  need(between(sensor.on, 1e-3, 100) && between(sensor.off, 1e-3, 100), "thresholds must be 0.001 to 100");
  need(between(sensor.mismatch, 0, 100), "the thresholds' mismatch must be 0 to 100");
  need(between(sensor.white, 1e-12, 1e12), "white must be 1e-12 to 1e12");
  need(between(sensor.dark, 1e-12, 1e6), "the dark floor must be 1e-12 to 1e6");
  need(between(sensor.refractory, 0, kMostSeconds), "the refractory time must be 0 to 1e6 seconds");
  need(between(sensor.cutoff, 0, 1e9), "the cutoff must be 0 to 1e9 Hz");
  need(between(sensor.leak, 0, 1e6) && between(sensor.shot_noise, 0, 1e6), "leak and shot noise must be 0 to 1e6 Hz");
  need(between(sensor.leak_spread, 0, 3) && between(sensor.leak_jitter, 0, 10),
       "the leak's spread must be 0 to 3, and its jitter 0 to 10");
  need(sensor.bayer.empty() || (sensor.bayer.size() == 4 && sensor.bayer.find_first_not_of("RGB") == std::string::npos),
       "a Bayer pattern has four of the letters R, G and B, such as RGGB");
}

/// A stretch of time on a grid that all recordings share; seconds from the recording's begin.
LightClock clock_of(const EventOptions& options, int64_t chunk) {
  const double begin = std::max(static_cast<double>(chunk) * options.chunk, options.from) - options.from;
  const double end = std::min(static_cast<double>(chunk + 1) * options.chunk, options.to) - options.from;
  const double reach = kReachShare * options.chunk;
  return {begin - reach, end + reach, begin, end, reach};
}

Shot shot_of(const Scene& scene, const EventOptions& options, const LightClock& clock) {
  ShotOptions shot_options = options.shot;
  shot_options.space = ShotOptions::Space::camera;
  shot_options.frame = 0;
  shot_options.fps = 1;  // so that times are seconds
  shot_options.shutter = std::array<double, 2>{clock.open + options.from, clock.close + options.from};
  Shot shot = make_shot(scene, shot_options);
  if (options.change_shot) options.change_shot(shot);
  if (shot.projection.width > kMostSide || shot.projection.height > kMostSide)
    throw Error(ErrorCode::bad_usage, "",
                "a sensor must be at most " + std::to_string(kMostSide) + " pixels wide and high");
  return shot;
}

}  // namespace

EventErrors event_errors(const EventOptions& options) {
  // docs/events.md, "What stamps may be off by".
  constexpr double kRadius = 5;
  const double rays = options.rays;
  return {options.shot.motion_tolerance,
          options.edges == EdgeModel::area ? 0.1 / (rays * kRadius) : std::pow(rays, -0.75) / std::sqrt(6.0)};
}

EventStats record_events(const Scene& scene, const EventOptions& options, EventSink& sink, const Progress& progress) {
  check(options);
  RenderParams params = options.render;
  params.integrator = IntegratorKind::tc;
  params.tc_rays = options.rays;
  params.sampler = SamplerKind::owen_sobol;  // of 4^n points one lies in each of as many squares
  params.filter = FilterKind::box;
  params.shading_interval = 1;
  params.shading_samples = options.looks / 2;  // and as many halfway between
  params.exposure.reset();
  params.crop = options.crop;
  params.aovs.clear();

  const auto first = static_cast<int64_t>(std::floor(options.from / options.chunk));
  RecordingState state;
  state.next_chunk = first;
  if (!options.resume.empty()) state = parse_recording(options.resume);
  EventStats& stats = state.stats;
  PixelStates& states = state.pixels;
  const EventPixels sensor(options.sensor, params.seed);
  std::set<std::string> told;
  const auto after = std::max(static_cast<int64_t>(std::ceil(options.to / options.chunk)), first + 1);
  for (int64_t chunk = state.next_chunk; chunk < after; ++chunk) {
    const LightClock clock = clock_of(options, chunk);
    if (!(clock.begin < clock.end)) continue;  // by rounding
    const Shot shot = shot_of(scene, options, clock);
    for (const std::vector<std::string>* lines : {&shot.warnings, &shot.notes})
      for (const std::string& note : *lines)
        if (chunk == first && told.insert(note).second) stats.notes.push_back(note);
    if (options.labels && chunk == first)
      for (const Mesh& mesh : shot.meshes) stats.meshes.push_back(mesh.name);
    if (states.pixels.empty()) states = PixelStates(shot.projection.width, shot.projection.height);
    if (states.width != shot.projection.width || states.height != shot.projection.height)
      throw Error(ErrorCode::bad_input, "", "the unfinished recording is of a sensor of another size");
    EventFilm film(shot, clock, options, sensor, states);
    RenderStats render_stats;
    PixelConsumer* const consumer = &film;
    const auto done = static_cast<double>(chunk - first), count = static_cast<double>(after - first);
    Progress of_chunk;
    if (progress) of_chunk = [&](double fraction) { return progress((done + fraction) / count); };
    Renderer(shot).render(params, {&consumer, 1}, &render_stats, of_chunk);
    // The last of a burst at the very end may be stamped later than the next chunk's first.
    EventBatch batch = film.take();
    batch.append(state.late);
    batch.sort();
    std::vector<Event>& events = batch.events;
    const auto chunk_end = static_cast<int64_t>(std::floor(clock.end * 1e9));
    const auto first_late =
        chunk + 1 == after ? events.end() : std::lower_bound(events.begin(), events.end(), Event{chunk_end, 0, 0, 0});
    state.late = batch.split(static_cast<size_t>(first_late - events.begin()));
    for (const Event& event : events) {
      ++(event.polarity > 0 ? stats.on : stats.off);
      stats.leak += event.kind == EventKind::leak;
      stats.shot += event.kind == EventKind::shot;
    }
    if (options.labels)
      sink.add_labelled(events, batch.labels);
    else
      sink.add(events);
    stats.width = states.width;
    stats.height = states.height;
    const LightCounts counts = film.counts();
    stats.edges += counts.edges;
    stats.steps += counts.steps;
    stats.fastest = std::max(stats.fastest, counts.fastest);
    stats.rays += render_stats.rays;
    stats.shading_samples += render_stats.shading_samples;
    stats.cpu_seconds += render_stats.render_cpu_seconds;
    state.next_chunk = chunk + 1;
    sink.end_chunk([&] { return recording_bytes(state); });
  }
  return stats;
}

}  // namespace kairos
