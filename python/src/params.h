// RenderParams of Python's options.
#pragma once

#include <kairos/render.h>

#include "fields.h"
#include "shot.h"

namespace kairos::python {

template <class F, class C>
void calibration_fields(F& f, C& c) {
  f("discrete_sample", c.discrete_sample);
  f("still_ray", c.still_ray);
  f("tc_ray", c.tc_ray);
}

inline RenderParams render_params(const HeldShot& shot, const py::dict& values) {
  RenderParams params;
  std::optional<std::array<int, 4>> crop;
  Reader reader("", values);
  render_fields(reader, params);
  reader("crop", crop);
  if (crop) params.crop = Crop{(*crop)[0], (*crop)[1], (*crop)[2], (*crop)[3]};
  if (const py::object calibration = reader.take("calibration"); !calibration.is_none()) {
    Reader measured("calibration", py::dict(calibration.attr("__dict__")));
    calibration_fields(measured, params.calibration.emplace());
  }
  reader.finish();
  params.alpha = shot.transparent();
  params.exposure = shot.exposure();
  return params;
}

inline py::dict stats_to(const RenderStats& stats) {
  Writer f;
  f("build_seconds", stats.build_seconds);
  f("render_seconds", stats.render_seconds);
  f("render_cpu_seconds", stats.render_cpu_seconds);
  f("prepare_seconds", stats.prepare_seconds);
  f("rays", stats.rays);
  f("segments", stats.segments);
  f("shading_samples", stats.shading_samples);
  f("accel_memory_bytes", stats.accel_memory_bytes);
  f("moving_pixels", stats.moving_pixels);
  f("tc_pixels", stats.tc_pixels);
  f("threads", stats.threads);
  f("instruction_set", stats.instruction_set);
  f("embree_instruction_set", stats.embree_instruction_set);
  return f.values;
}

}  // namespace kairos::python
