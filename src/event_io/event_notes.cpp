// What a recording is and how it was made, as JSON beside it.
#include "event_io/event_notes.h"

#include <kairos/event_file.h>
#include <kairos/files.h>
#include <kairos/version.h>

#include "event_io/sensor_file.h"

namespace kairos {

using nlohmann::ordered_json;

ordered_json event_notes(const EventOptions& options, const EventStats& stats, const std::string& command_line) {
  ordered_json json;
  json["kairos"] = std::string(version());
  json["command_line"] = command_line;
  json["from_s"] = options.from;
  json["to_s"] = options.to;
  json["width"] = stats.width;
  json["height"] = stats.height;
  json["origin"] = "pixel (0, 0) is the upper left one; times count from from_s";
  json["order"] = "time, y, x";
  json["rays"] = options.rays;
  json["edges"] = std::string(to_string(options.edges));
  json["looks_per_s"] = options.looks;
  json["chunk_s"] = options.chunk;
  json["motion_tolerance_px"] = options.shot.motion_tolerance;
  json["shading"] = std::string(to_string(options.render.shading));
  json["seed"] = options.render.seed;
  json["sensor"] = sensor_json(options.sensor);
  json["events"] = {{"on", stats.on}, {"off", stats.off}, {"leak", stats.leak}, {"shot", stats.shot}};
  if (options.labels) json["meshes"] = stats.meshes;  // numbered from 1
  json["moving_edges"] = stats.edges;
  json["steps"] = stats.steps;
  json["rays_traced"] = stats.rays;
  json["shading_samples"] = stats.shading_samples;
  json["cpu_s"] = stats.cpu_seconds;
  json["fastest_edge_px_per_s"] = stats.fastest;
  const EventErrors errors = event_errors(options);
  json["errors_px"] = {{"motion", errors.motion}, {"edges", errors.area}};
  return json;
}

void write_notes(const std::string& path, const ordered_json& notes) {
  write_file(path, notes.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

void write_event_notes(const std::string& path, const EventOptions& options, const EventStats& stats,
                       const std::string& command_line) {
  write_notes(path, event_notes(options, stats, command_line));
}

}  // namespace kairos
