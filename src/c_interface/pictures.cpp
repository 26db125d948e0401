// kairos/kairos.h: scenes, shots and pictures.
#include <kairos/image.h>

#include "c_interface/handles.h"

struct kairos_renderer : kairos::c_interface::Counted {
  explicit kairos_renderer(kairos_shot* of) : shot(of) { kairos::c_interface::retain(shot); }
  ~kairos_renderer() {
    lit.reset();  // before the shot
    unlit.reset();
    kairos::c_interface::release(shot);
  }
  kairos_renderer(const kairos_renderer&) = delete;
  kairos_renderer& operator=(const kairos_renderer&) = delete;

  kairos_shot* shot;
  std::unique_ptr<kairos::Renderer> lit, unlit;  ///< made when first needed
};
struct kairos_image : kairos::c_interface::Counted {
  kairos::Image image;
  kairos::ViewTransform view = kairos::ViewTransform::standard;  ///< that shows it
};

namespace kairos::c_interface {

namespace {

ShotOptions options_of(const kairos_shot_options* given) {
  const kairos_shot_options from = taken(given, "options");
  ShotOptions options;
  if (from.world_space != 0) options.space = ShotOptions::Space::world;
  take(from.camera, options.camera);
  if (from.has_frame != 0) options.frame = from.frame;
  if (from.fps != 0) options.fps = from.fps;
  if (from.has_shutter != 0) options.shutter = {from.shutter_open, from.shutter_close};
  options.width = from.width;
  options.height = from.height;
  if (from.motion_tolerance != 0) options.motion_tolerance = from.motion_tolerance;
  options.strict = from.strict != 0;
  options.threads = from.threads;
  options.lights = LightChoice::automatic;
  take("lights", from.lights, options.lights);
  if (from.environment != nullptr)
    options.environment = EnvironmentPicture{from.environment, from.environment_rotation,
                                             from.environment_strength != 0 ? from.environment_strength : 1};
  return options;
}

/// What is seen beyond everything.
void apply_background(const kairos_shot_options& from, Shot& shot) {
  const auto& colour = from.background;
  if (from.has_background != 0) shot.backdrop = Vec3f{colour[0], colour[1], colour[2]};
  if (from.transparent != 0) shot.backdrop = Vec3f{};
}

void add_aovs(const std::string& names, std::vector<Aov>& aovs) {
  for (size_t at = 0; at <= names.size();) {
    const size_t comma = std::min(names.find(',', at), names.size());
    aovs.push_back(choice<Aov>("aovs", names.substr(at, comma - at)));
    at = comma + 1;
  }
}

RenderParams params_of(const kairos_render_params* given) {
  const kairos_render_params from = taken(given, "params");
  RenderParams params;
  params.shading = ShadingKind::whitted;
  if (from.spp != 0) params.spp = from.spp;
  if (from.tc_rays != 0) params.tc_rays = from.tc_rays;
  if (from.shading_samples != 0) params.shading_samples = from.shading_samples;
  take("integrator", from.integrator, params.integrator);
  take("shading", from.shading, params.shading);
  take("sampler", from.sampler, params.sampler);
  take("filter", from.filter, params.filter);
  if (from.aovs != nullptr) add_aovs(from.aovs, params.aovs);
  if (from.instruction_set != nullptr)
    params.instruction_set = choice<InstructionSet>("instruction_set", from.instruction_set);
  params.seed = from.seed;
  params.threads = from.threads;
  if (from.max_depth != 0) params.max_depth = from.max_depth == -1 ? 0 : from.max_depth;
  params.clamp = from.clamp;
  take("shadows", from.shadows, params.shadows);
  take("cells", from.cells, params.cells);
  take("mirrors", from.mirrors, params.mirrors);
  const auto& crop = from.crop;
  if (crop[0] != 0 || crop[1] != 0 || crop[2] != 0 || crop[3] != 0)
    params.crop = Crop{crop[0], crop[1], crop[2], crop[3]};
  return params;
}

Renderer& renderer_for(kairos_renderer& renderer, ShadingKind shading) {
  const bool unlit = !kairos::is_lit(shading) && renderer.shot->unlit;
  auto& made = unlit ? renderer.unlit : renderer.lit;
  if (!made) made = std::make_unique<Renderer>(unlit ? *renderer.shot->unlit : renderer.shot->shot);
  return *made;
}

}  // namespace

}  // namespace kairos::c_interface

using namespace kairos::c_interface;

extern "C" {

void kairos_scene_retain(kairos_scene* scene) { retain(scene); }
void kairos_scene_release(kairos_scene* scene) { release(scene); }
void kairos_shot_retain(kairos_shot* shot) { retain(shot); }
void kairos_shot_release(kairos_shot* shot) { release(shot); }
void kairos_renderer_retain(kairos_renderer* renderer) { retain(renderer); }
void kairos_renderer_release(kairos_renderer* renderer) { release(renderer); }
void kairos_image_retain(kairos_image* image) { retain(image); }
void kairos_image_release(kairos_image* image) { release(image); }

kairos_status kairos_load(const char* const* paths, size_t path_count, const kairos_load_options* options,
                          kairos_scene** out) {
  return guarded([&] {
    needed(out, "out");
    std::vector<std::string> names;
    for (size_t i = 0; i < path_count; ++i) names.emplace_back(&needed((&needed(paths, "paths"))[i], "paths"));
    const kairos_load_options from = taken(options, "options");
    kairos::LoadOptions load;
    take(from.animation, load.animation);
    take(from.gltf_scene, load.gltf_scene);
    take(from.root, load.root);
    load.strict = from.strict != 0;
    if (from.memory_budget != 0) load.memory_budget = from.memory_budget;
    load.threads = from.threads;
    auto made = std::make_unique<kairos_scene>();
    made->scene = kairos::load_scene(names, load);
    *out = made.release();
  });
}

kairos_status kairos_make_shot(const kairos_scene* scene, const kairos_shot_options* options, kairos_shot** out) {
  return guarded([&] {
    needed(out, "out");
    const kairos::Scene& of = *needed(scene, "scene").scene;
    kairos::ShotOptions made_with = options_of(options);
    const kairos_shot_options from = taken(options, "options");
    auto made = std::make_unique<kairos_shot>();
    made->shot = kairos::make_shot(of, made_with);
    made->transparent = from.transparent != 0;
    apply_background(from, made->shot);
    if (made_with.lights == kairos::LightChoice::automatic &&
        made->shot.lights.size() > kairos::contents(of).lights.size()) {
      made_with.lights = kairos::LightChoice::file;
      kairos::Shot unlit = kairos::make_shot(of, made_with);
      apply_background(from, unlit);
      made->unlit = std::make_unique<const kairos::Shot>(std::move(unlit));
    }
    *out = made.release();
  });
}

kairos_status kairos_shot_size(const kairos_shot* shot, int32_t* width, int32_t* height) {
  return guarded([&] {
    const kairos::Projection& projection = needed(shot, "shot").shot.projection;
    if (width != nullptr) *width = projection.width;
    if (height != nullptr) *height = projection.height;
  });
}

kairos_status kairos_shot_mesh_count(const kairos_shot* shot, size_t* count) {
  return guarded([&] { needed(count, "count") = needed(shot, "shot").shot.meshes.size(); });
}

kairos_status kairos_shot_mesh_name(const kairos_shot* shot, size_t mesh, const char** name) {
  return guarded([&] {
    const auto& meshes = needed(shot, "shot").shot.meshes;
    if (mesh >= meshes.size()) refuse("mesh", "is not below " + std::to_string(meshes.size()));
    needed(name, "name") = meshes[mesh].name.c_str();
  });
}

kairos_status kairos_make_renderer(kairos_shot* shot, kairos_renderer** out) {
  return guarded([&] { needed(out, "out") = new kairos_renderer(&needed(shot, "shot")); });
}

kairos_status kairos_render(kairos_renderer* renderer, const kairos_render_params* params, kairos_progress progress,
                            void* user, kairos_image** out) {
  return guarded([&] {
    needed(out, "out");
    kairos::RenderParams with = params_of(params);
    with.alpha = needed(renderer, "renderer").shot->transparent;
    kairos::Progress told;
    if (progress != nullptr) told = [&](double fraction) { return progress(user, fraction) != 0; };
    auto made = std::make_unique<kairos_image>();
    made->image = renderer_for(needed(renderer, "renderer"), with.shading).render(with, nullptr, told);
    if (kairos::is_lit(with.shading) && kairos::reflects_light(renderer->shot->shot))
      made->view = kairos::ViewTransform::filmic;
    *out = made.release();
  });
}

kairos_status kairos_image_size(const kairos_image* image, int32_t* width, int32_t* height) {
  return guarded([&] {
    const kairos::Image& of = needed(image, "image").image;
    if (width != nullptr) *width = of.width;
    if (height != nullptr) *height = of.height;
  });
}

kairos_status kairos_image_channel(const kairos_image* image, const char* name, const float** values) {
  return guarded([&] {
    const std::string wanted = &needed(name, "name");
    const kairos::Channel* channel = needed(image, "image").image.find(wanted);
    if (channel == nullptr) refuse("name", "there is no channel '" + wanted + "'");
    needed(values, "values") = channel->values.data();
  });
}

kairos_status kairos_write_image(const kairos_image* image, const char* path) {
  return kairos_write_image_as(image, path, nullptr);
}

kairos_status kairos_write_image_as(const kairos_image* image, const char* path, const kairos_write_options* options) {
  return guarded([&] {
    const kairos_write_options from = taken(options, "options");
    kairos::WriteOptions write;
    write.view = needed(image, "image").view;
    take("view", from.view, write.view);
    write.half = from.half != 0;
    write.exposure = from.exposure;
    kairos::write_image(image->image, &needed(path, "path"), write);
  });
}

}  // extern "C"
