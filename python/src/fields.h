// The members of Kairos' structs, by the names that they have in Python: f(NAME, MEMBER) for each.
#pragma once

#include <kairos/make_scene.h>
#include <kairos/render.h>
#include <kairos/scene.h>

#include "convert.h"

namespace kairos::python {

template <class F, class M>
void material_fields(F& f, M& m) {
  f("name", m.name);
  f("base_color", m.base_color);
  f("emission", m.emission);
  f("metallic", m.metallic);
  f("roughness", m.roughness);
  f("specular", m.specular);
  f("specular_color", m.specular_color);
  f("clearcoat", m.clearcoat);
  f("clearcoat_roughness", m.clearcoat_roughness);
  f("transmission", m.transmission);
  f("ior", m.ior);
  f("thin_walled", m.thin_walled);
  f("alpha", m.alpha);
  f("alpha_mode", m.alpha_mode);
  f("alpha_cutoff", m.alpha_cutoff);
  f("double_sided", m.double_sided);
  f("one_sided_emission", m.one_sided_emission);
  f("lamp", m.lamp);
  f("emits_where_cut_out", m.emits_where_cut_out);
  f("unlit", m.unlit);
  f("base_color_texture", m.base_color_texture);
  f("emission_texture", m.emission_texture);
  f("metallic_roughness_texture", m.metallic_roughness_texture);
  f("alpha_texture", m.alpha_texture);
  f("normal_texture", m.normal_texture);
  f("normal_scale", m.normal_scale);
}

template <class F, class P>
void render_fields(F& f, P& p) {
  f("integrator", p.integrator);
  f("spp", p.spp);
  f("tc_rays", p.tc_rays);
  f("shading", p.shading);
  f("shading_samples", p.shading_samples);
  f("shading_interval", p.shading_interval);
  f("clusters", p.clusters);
  f("shadows", p.shadows);
  f("mirrors", p.mirrors);
  f("cells", p.cells);
  f("max_depth", p.max_depth);
  f("clamp", p.clamp);
  f("sampler", p.sampler);
  f("filter", p.filter);
  f("aovs", p.aovs);
  f("seed", p.seed);
  f("threads", p.threads);
  f("instruction_set", p.instruction_set);
  f("discrete_keys", p.discrete_keys);
}

template <class F, class O>
void load_fields(F& f, O& o) {
  f("animation", o.animation);
  f("gltf_scene", o.gltf_scene);
  f("strict", o.strict);
  f("root", o.root);
  f("memory_budget", o.memory_budget);
  f("threads", o.threads);
}

template <class F, class O>
void shot_fields(F& f, O& o) {
  f("camera", o.camera);
  f("frame", o.frame);
  f("fps", o.fps);
  f("textures", o.textures);
  f("motion_tolerance", o.motion_tolerance);
  f("strict", o.strict);
  f("lights", o.lights);
  f("threads", o.threads);
}

}  // namespace kairos::python
