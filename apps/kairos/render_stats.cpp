#include "render_stats.h"

#include <nlohmann/json.hpp>

#include <kairos/names.h>

#include "report.h"

namespace kairos::cli {

namespace {

double ratio(uint64_t a, uint64_t b) { return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b); }

}  // namespace

std::string stats_text(const RenderParams& params, const Shot& shot, const RenderStats& stats, const Timings& timings) {
  const bool tc = params.integrator == IntegratorKind::tc;
  const bool discrete_only = params.integrator == IntegratorKind::qmc;
  nlohmann::ordered_json json;
  json["load_seconds"] = timings.load + timings.shot;
  json["file_seconds"] = timings.load;
  json["shot_seconds"] = timings.shot;
  json["build_seconds"] = stats.build_seconds;
  json["render_seconds"] = stats.render_seconds;
  json["render_cpu_seconds"] = stats.render_cpu_seconds;
  json["write_seconds"] = timings.write;
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["geometry_memory_bytes"] = mesh_bytes(shot.meshes);
  json["accel_memory_bytes"] = stats.accel_memory_bytes;
  const uint64_t triangles = triangle_count(shot.meshes);
  json["triangles"] = triangles;
  // What a triangle costs: memory of the shot's meshes and of the trees, and the most that the process ever held.
  nlohmann::ordered_json& bytes = json["bytes_per_triangle"];
  bytes["geometry"] = ratio(mesh_bytes(shot.meshes), triangles);
  bytes["accel"] = ratio(stats.accel_memory_bytes, triangles);
  bytes["peak"] = ratio(peak_memory_bytes(), triangles);
  nlohmann::ordered_json& seconds = json["seconds_per_million_triangles"];
  const auto per_million = [&](double time) { return triangles ? time * 1e6 / static_cast<double>(triangles) : 0; };
  seconds["file"] = per_million(timings.load);
  seconds["shot"] = per_million(timings.shot);
  seconds["build"] = per_million(stats.build_seconds);
  json["rays"] = stats.rays;
  json["shading_samples"] = stats.shading_samples;
  json["threads"] = stats.threads;
  const std::optional<InstructionSet>& embree = stats.embree_instruction_set;
  json["instruction_set"] = to_string(stats.instruction_set ? *stats.instruction_set : embree.value());
  json["embree_instruction_set"] = embree ? nlohmann::ordered_json(to_string(*embree)) : nlohmann::ordered_json();
  json["integrator"] = to_string(params.integrator);
  json["samples"] = tc ? params.tc_rays : params.spp;
  json["seed"] = params.seed;
  json["shutter"] = {shot.shutter_open, shot.shutter_close};
  if (params.exposure) {
    const Shutter& shutter = params.exposure->shutter();
    nlohmann::ordered_json& exposure = json["exposure"];  // seconds
    exposure["frame_time"] = params.exposure->frame_time();
    exposure["interval"] = {shutter.open, shutter.close};
    exposure["line_times"] = {shutter.open_line, shutter.close_line};
    exposure["scan"] = to_string(shutter.scan);
    exposure["first_line"] = shutter.first_line;
    exposure["normalise"] = to_string(shutter.normalise);
    exposure["map"] = shutter.map != nullptr;
    for (const TimeWeight::Point& point : shutter.curve.points())
      exposure["curve"].push_back({point.time, point.weight});
  }
  if (stats.prices) {
    nlohmann::ordered_json& chosen = json["auto"];
    chosen["calibration"] = params.calibration ? "measured" : "default";
    nlohmann::ordered_json& prices = chosen["prices"];  // in discrete samples
    prices["still_ray"] = stats.prices->still_ray;
    for (size_t i = 0; i < Calibration::kRays.size(); ++i)
      prices["tc_ray"][std::to_string(Calibration::kRays[i])] = stats.prices->tc_ray[i];
    const Crop crop = params.crop.value_or(Crop{0, shot.projection.width, 0, shot.projection.height});
    const auto pixels = static_cast<uint64_t>(crop.x1 - crop.x0) * static_cast<uint64_t>(crop.y1 - crop.y0);
    chosen["moving_pixels"] = ratio(stats.moving_pixels, pixels);
    chosen["tc_pixels"] = ratio(stats.tc_pixels, pixels);
    chosen["mean_tc_rays"] = ratio(stats.counters.rays, stats.tc_pixels);
  }
  // Embree does not count its work: null, rather than a number that is not known.
  nlohmann::ordered_json& counters = json["counters"];
  const auto counted = [&](uint64_t count) {
    return discrete_only ? nlohmann::ordered_json() : nlohmann::ordered_json(count);
  };
  counters["nodes"] = counted(stats.counters.nodes);
  counters["triangles_tested"] = counted(stats.counters.triangles);
  counters["root_solves"] = counted(stats.counters.root_solves);
  counters["hits"] = counted(stats.counters.hits);
  counters["segments"] = stats.segments;
  counters["segments_per_ray"] = ratio(stats.segments, stats.rays);
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace kairos::cli
