#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <mutex>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/picture.h>
#include <kairos/render.h>
#include <kairos/version.h>

#include "base/parallel.h"
#include "discrete/uniform_runs.h"
#include "integrators/integrator.h"
#include "integrators/shot_parts.h"
#include "policy/ray_prices.h"
#include "policy/sample_spread.h"
#include "render/bands.h"
#include "render/measure_rays.h"
#include "shading/spread.h"

namespace kairos {

namespace {

constexpr int kTileSize = 16;                     // pixels; of a flat crop, tiles of about as many pixels are wider
constexpr int kMaxSide = 65536;                   // pixels
constexpr int64_t kMaxPixels = int64_t{1} << 28;  // of the part that is rendered
constexpr int kMaxShadingSamples = 1 << 16;
constexpr int kMostDepth = 64;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::bad_usage, "", what); }

bool shows_bounds(ShadingKind kind) { return kind == ShadingKind::bounds || kind == ShadingKind::bounds_exact; }

void check(const Projection& p, const RenderParams& params, const Crop& crop) {
  if (p.width < 1 || p.height < 1 || p.width > kMaxSide || p.height > kMaxSide)
    refuse("image width and height must be 1 to " + std::to_string(kMaxSide));
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 > p.width || crop.y1 > p.height || crop.x0 >= crop.x1 || crop.y0 >= crop.y1)
    refuse("crop " + std::to_string(crop.x0) + "," + std::to_string(crop.x1) + "," + std::to_string(crop.y0) + "," +
           std::to_string(crop.y1) + " is empty or leaves the frame of " + std::to_string(p.width) + "x" +
           std::to_string(p.height) + " pixels; give x0,x1,y0,y1 with 0 <= x0 < x1 <= width");
  if (int64_t{crop.x1 - crop.x0} * (crop.y1 - crop.y0) > kMaxPixels)
    refuse("more than " + std::to_string(kMaxPixels) + " pixels; render it in parts with a crop");
  if (params.shading_samples < 1 || params.shading_samples > kMaxShadingSamples)
    refuse("shading samples must be 1 to " + std::to_string(kMaxShadingSamples));
  if (!(params.shading_interval >= 0) || !std::isfinite(params.shading_interval))
    refuse("the interval of shading samples must be a number of at least 0");
  const bool takes_tc = params.integrator == IntegratorKind::tc || params.integrator == IntegratorKind::mixed;
  if (takes_tc && (params.tc_rays < 1 || static_cast<uint32_t>(params.tc_rays) > Sampler::kMaxCount))
    refuse("time-continuous rays per pixel must be 1 to " + std::to_string(Sampler::kMaxCount));
  if (params.integrator != IntegratorKind::tc &&
      (params.spp < 1 || static_cast<uint32_t>(params.spp) > Sampler::kMaxCount))
    refuse("samples per pixel must be 1 to " + std::to_string(Sampler::kMaxCount));
  if (params.max_depth < 0 || params.max_depth > kMostDepth)
    refuse("the depth of reflections must be 0 to " + std::to_string(kMostDepth));
  if (!(params.clamp >= 0)) refuse("the limit of scattered light must be a number of at least 0");
  if (params.threads < 0) refuse("the number of threads must not be negative");
  if (params.calibration) prices_of(*params.calibration);
  if (params.discrete_keys < 0 || params.discrete_keys > static_cast<int>(kMaxTimeSteps))
    refuse("keys for discrete rays must be 0 to " + std::to_string(kMaxTimeSteps));
}

void check(const Shot& shot, const RenderParams& params, const RecordNeeds& needs) {
  if (params.shading_interval > 0 &&
      (shot.shutter_close - shot.shutter_open) / params.shading_interval * params.shading_samples > kMaxShadingSamples)
    refuse("shading samples while the shutter is open must be " + std::to_string(kMaxShadingSamples) +
           " at most; give a longer interval");
  if (params.exposure) {
    const Exposure& exposure = *params.exposure;
    if (exposure.width() != shot.projection.width || exposure.height() != shot.projection.height ||
        exposure.shot_open() != shot.shutter_open || exposure.shot_close() != shot.shutter_close)
      refuse("the exposure is made for another shot or frame");
    if (exposure.shutter().curve.has_negative())
      refuse("a shutter's curve must not be negative anywhere; only what is recorded over time can be weighed with it");
    if (shows_bounds(params.shading)) refuse("pictures of bounds show the whole shutter, and no exposure of it");
  }
  const bool exact = needs.time == RecordNeeds::Time::segments;
  if (exact && (params.integrator == IntegratorKind::qmc || shows_bounds(params.shading)))
    refuse(
        "discrete rays and pictures of bounds have no segments, which a consumer needs; use the integrator tc, mixed "
        "or auto with "
        "another shading");
}

/// Samples per pixel that are asked for.
int sample_count(const RenderParams& params) {
  switch (params.integrator) {
    case IntegratorKind::tc:
      return params.tc_rays;
    case IntegratorKind::qmc:
    case IntegratorKind::automatic:
      return params.spp;
    case IntegratorKind::mixed:
      return std::max(params.spp, params.tc_rays);
  }
  return 0;
}

/// Sample points that a pixel may need.
uint32_t point_count(const RenderParams& params) {
  const auto samples = static_cast<uint32_t>(std::max(sample_count(params), 0));
  if (!spreads_samples(params) || samples > Sampler::kMaxCount) return samples;
  return most_samples(samples);
}

std::unique_ptr<Integrator> make_integrator(ShotParts& parts, const RenderParams& params, const PixelContext& context,
                                            RenderStats& stats) {
  if (shows_bounds(params.shading)) return make_bounds_integrator(parts.shot(), params, context, stats);
  switch (params.integrator) {
    case IntegratorKind::tc:
      return make_tc_integrator(parts, params, context, stats);
    case IntegratorKind::qmc:
      break;
    case IntegratorKind::automatic:
    case IntegratorKind::mixed:
      return make_mixed_integrator(parts, params, context, stats);
  }
  return make_qmc_integrator(parts, params, context);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void render_tiles(const Integrator& integrator, std::span<PixelConsumer* const> consumers, const Crop& crop,
                  Monitor& monitor, RenderStats& stats) {
  const int aligned = integrator.tile_side();
  const int height = aligned > 0 ? aligned : kTileSize;
  const int stretches = (kTileSize - 1) / std::min(kTileSize, crop.y1 - crop.y0) + 1;
  const int width = aligned > 0 ? aligned : stretches * kTileSize;
  const int first_x = crop.x0 - crop.x0 % (aligned > 0 ? aligned : kTileSize);  // strips of pixels stay whole
  const int first_y = aligned > 0 ? crop.y0 - crop.y0 % aligned : crop.y0;
  const int columns = (crop.x1 - first_x + width - 1) / width, rows = (crop.y1 - first_y + height - 1) / height;
  std::mutex mutex;  // of stats
  parallel_for(static_cast<size_t>(columns) * static_cast<size_t>(rows), 1, [&](size_t first_tile, size_t last_tile) {
    const auto worker = integrator.make_worker();
    for (size_t tile = first_tile; tile < last_tile; ++tile) {
      const int left = first_x + static_cast<int>(tile % static_cast<size_t>(columns)) * width;
      const int top = first_y + static_cast<int>(tile / static_cast<size_t>(columns)) * height;
      for (int y = std::max(top, crop.y0); y < std::min(top + height, crop.y1); ++y)
        for (int x = std::max(left, crop.x0); x < std::min(left + width, crop.x1); ++x) {
          const auto has_it = [&](const PixelConsumer* consumer) { return consumer->has(x, y); };
          if (consumers.empty() || !std::all_of(consumers.begin(), consumers.end(), has_it)) {
            const PixelRecord& record = worker->render_pixel(x, y, monitor);
            for (PixelConsumer* consumer : consumers) consumer->add(record);
          }
          monitor.finish_pixel();
        }
    }
    const std::lock_guard<std::mutex> lock(mutex);
    worker->add_counts(stats);
  });
}

std::string calibration_text(const std::optional<Calibration>& calibration) {
  if (!calibration) return "default";
  // As many digits as tell numbers apart: the picture depends on them.
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return std::string(text);
  };
  std::string text =
      "discrete_sample " + number(calibration->discrete_sample) + ", still_ray " + number(calibration->still_ray);
  for (size_t i = 0; i < Calibration::kRays.size(); ++i)
    text += ", tc_ray of " + std::to_string(Calibration::kRays[i]) + " " + number(calibration->tc_ray[i]);
  return text + " ns";
}

std::string curve_text(const TimeWeight& curve) {
  if (curve.is_box()) return "box";
  std::string text = "points:";
  for (const TimeWeight::Point& point : curve.points()) {
    char pair[64];
    std::snprintf(pair, sizeof pair, "%s%.9g %.9g", text.back() == ':' ? "" : ",", point.time, point.weight);
    text += pair;
  }
  return text;
}

}  // namespace

void describe(Image& image, const Shot& shot, const RenderParams& params, const RenderStats& stats) {
  const auto put = [&](const char* name, auto value) { image.attributes.push_back({name, value}); };
  if (!shot.projection.matrix) image.pixel_aspect = shot.projection.pixel_aspect;
  put("kairos:version", std::string(version()));
  if (!shows_bounds(params.shading)) put("kairos:integrator", std::string(to_string(params.integrator)));
  put("kairos:samples", sample_count(params));
  if (params.integrator == IntegratorKind::mixed) put("kairos:tc_rays", params.tc_rays);
  if (params.integrator != IntegratorKind::qmc) {
    put("kairos:shading_samples", params.shading_samples);
    put("kairos:clusters", std::string(to_string(clusters_of(params))));
    if (is_lit(params.shading)) put("kairos:shadows", std::string(to_string(params.shadows)));
    if (params.shading == ShadingKind::whitted) put("kairos:mirrors", std::string(to_string(params.mirrors)));
  }
  if (is_lit(params.shading)) put("kairos:cells", std::string(to_string(params.cells)));
  if (params.integrator == IntegratorKind::automatic) put("kairos:calibration", calibration_text(params.calibration));
  put("kairos:sampler", std::string(to_string(params.sampler)));
  put("kairos:shading", std::string(to_string(params.shading)));
  if (is_lit(params.shading)) put("kairos:max_depth", params.max_depth);
  if (params.shading == ShadingKind::path && params.clamp > 0) put("kairos:clamp", params.clamp);
  put("kairos:filter", std::string(to_string(params.filter)));
  if (stats.instruction_set) put("kairos:instruction_set", std::string(to_string(*stats.instruction_set)));
  if (stats.embree_instruction_set)
    put("kairos:embree_instruction_set", std::string(to_string(*stats.embree_instruction_set)));
  put("kairos:seed", std::to_string(params.seed));
  put("kairos:shutter", std::array<double, 2>{shot.shutter_open, shot.shutter_close});
  if (params.exposure) {
    const Shutter& shutter = params.exposure->shutter();
    put("kairos:exposure", std::array<double, 2>{shutter.open, shutter.close});
    put("kairos:exposure_frame_time", params.exposure->frame_time());
    put("kairos:exposure_normalise", std::string(to_string(shutter.normalise)));
    if (shutter.map) {
      put("kairos:exposure_map", std::string("given"));
    } else {
      put("kairos:exposure_line", std::array<double, 2>{shutter.open_line, shutter.close_line});
      put("kairos:exposure_scan", std::string(to_string(shutter.scan)));
      put("kairos:exposure_first_line", shutter.first_line);
    }
    put("kairos:exposure_curve", curve_text(shutter.curve));
    put("expTime", shutter.close - shutter.open);
  } else {
    put("expTime", shot.shutter_close - shot.shutter_open);
  }
  put("kairos:render_seconds", stats.render_seconds);
  if (image.find("mesh.id") != nullptr) {
    std::vector<std::string> names;
    for (const Mesh& mesh : shot.meshes) names.push_back(mesh.name);
    put("kairos:mesh_names", names);
  }
}

Renderer::Renderer(const Shot& shot) {
  validate_shot(shot);
  parts_ = std::make_unique<ShotParts>(shot);
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

namespace {

/// Renders on the threads that are here.
void render_here(ShotParts& parts, const RenderParams& params, const Crop& crop, const RecordNeeds& needs,
                 std::span<PixelConsumer* const> consumers, Monitor& monitor, RenderStats& stats) {
  const Shot& shot = parts.shot();
  stats.threads = thread_count();
  parts.choose_instruction_set(params.instruction_set);
  const bool discrete_rays = params.integrator != IntegratorKind::tc || is_lit(params.shading);
  if (discrete_rays && !shows_bounds(params.shading)) stats.embree_instruction_set = parts.embree_set();
  const bool want_variation =
      params.integrator != IntegratorKind::qmc && !needs.over_time() && clusters_of(params) == Clusters::pixel;
  const Shader& shader =
      parts.shader(params.shading, needs.normal, params.max_depth, params.discrete_keys, want_variation, params.clamp);
  auto start = std::chrono::steady_clock::now();
  const PixelContext context{CameraRays(shot.projection),
                             Sampler(params.sampler, point_count(params), params.seed),
                             PixelFilter(params.filter),
                             shader,
                             shot.seen_background(),
                             needs,
                             params.exposure};
  stats.build_seconds = seconds_since(start);  // of this picture alone
  for (const Crop& band : bands_of(crop)) {
    RenderParams of_band = params;
    of_band.crop = band;
    const auto integrator = make_integrator(parts, of_band, context, stats);
    const double masks_before = stats.parts.motion_mask;
    stats.parts = parts.take_build_seconds();
    stats.parts.motion_mask += masks_before;  // each band has one of its own

    start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    const auto cpu_seconds = [&] { return static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC; };
    integrator->prepare(monitor, stats);
    stats.prepare_seconds += seconds_since(start);
    stats.prepare_cpu_seconds += cpu_seconds();
    render_tiles(*integrator, consumers, band, monitor, stats);
    stats.render_seconds += seconds_since(start);
    stats.render_cpu_seconds += cpu_seconds();
  }
  stats.build_seconds += stats.parts.sum();
}

/// Calls `work` on `threads` threads, and `progress` on this one.
void run_with_progress(int threads, const Monitor& monitor, const Progress& progress,
                       const std::function<void()>& work) {
  if (!progress) return with_threads(threads, work);
  with_threads(threads, work, [&] { return progress(monitor.fraction()); });
  if (!progress(1)) throw Error(ErrorCode::cancelled, "", "rendering was stopped");
}

}  // namespace

void Renderer::render(const RenderParams& params, std::span<PixelConsumer* const> consumers, RenderStats* stats_out,
                      const Progress& progress) {
  const Projection& frame = parts_->shot().projection;
  const Crop crop = params.crop.value_or(Crop{0, frame.width, 0, frame.height});
  check(frame, params, crop);
  RecordNeeds needs;
  for (const PixelConsumer* consumer : consumers) needs = needs | consumer->needs();
  check(parts_->shot(), params, needs);
  Monitor monitor(static_cast<uint64_t>(crop.x1 - crop.x0) * static_cast<uint64_t>(crop.y1 - crop.y0));
  RenderStats stats;
  run_with_progress(params.threads, monitor, progress,
                    [&] { render_here(*parts_, params, crop, needs, consumers, monitor, stats); });
  if (stats_out != nullptr) *stats_out = stats;
}

Image Renderer::render(const RenderParams& params, RenderStats* stats_out, const Progress& progress) {
  const Shot& shot = parts_->shot();
  check(shot.projection, params, params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height}));
  Picture picture(shot.projection, params);
  PixelConsumer* const consumer = &picture;
  RenderStats stats;
  render(params, {&consumer, 1}, &stats, progress);
  Image image = picture.take_shown();
  describe(image, shot, params, stats);
  if (stats_out != nullptr) *stats_out = stats;
  return image;
}

Calibration Renderer::calibrate(const RenderParams& params, const Progress& progress) {
  const Projection& frame = parts_->shot().projection;
  check(frame, params, {0, frame.width, 0, frame.height});
  Monitor monitor(kMeasuringSteps);
  Calibration result;
  run_with_progress(params.threads, monitor, progress,  // threads build; measuring takes one
                    [&] { result = measure_rays(*parts_, params, monitor); });
  return result;
}

Image render(const Shot& shot, const RenderParams& params, RenderStats* stats, const Progress& progress) {
  return Renderer(shot).render(params, stats, progress);
}

}  // namespace kairos
