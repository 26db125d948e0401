// kairos info: what was loaded.
#include <filesystem>
#include <memory>
#include <numbers>
#include <set>

#include <nlohmann/json.hpp>

#include <kairos/animations.h>
#include <kairos/printable.h>
#include <kairos/time_file.h>

#include "arguments.h"
#include "commands.h"
#include "report.h"
#include "time_arguments.h"

namespace kairos::cli {

namespace {

struct InfoArguments {
  SceneArguments scene;
  bool json = false;
};

constexpr double kDegrees = 180 / std::numbers::pi;

nlohmann::ordered_json mesh_json(const Mesh& mesh) {
  nlohmann::ordered_json json;
  json["name"] = mesh.name;
  json["triangles"] = mesh.triangle_count();
  json["vertices"] = mesh.vertex_count();
  json["keys"] = mesh.key_count();
  json["key_times"] = mesh.is_static() ? std::vector<float>{} : mesh.key_times;
  json["memory_bytes"] = mesh_bytes(mesh);
  return json;
}

nlohmann::ordered_json camera_json(const SceneContents::Camera& camera) {
  nlohmann::ordered_json json;
  json["name"] = camera.name;
  json["type"] = camera.orthographic ? "orthographic" : "perspective";
  if (camera.orthographic)
    json["view_height"] = camera.view_height;
  else
    json["vfov_degrees"] = camera.vfov * kDegrees;
  return json;
}

/// Pictures that materials name and that are not there.
std::vector<std::string> absent_pictures(const SceneContents& scene) {
  const std::set<std::string> inside(scene.pictures.begin(), scene.pictures.end());
  std::set<std::string> absent;
  for (const Material& material : scene.materials)
    for (const TextureRef* texture :
         {&material.base_color_texture, &material.emission_texture, &material.metallic_roughness_texture,
          &material.alpha_texture, &material.normal_texture}) {
      std::error_code failure;
      if (!texture->empty() && !inside.count(texture->picture) && !std::filesystem::exists(texture->picture, failure))
        absent.insert(printable(texture->picture, std::string::npos));
    }
  return {absent.begin(), absent.end()};
}

nlohmann::ordered_json animation_json(const SceneAnimation& animation, double fps) {
  nlohmann::ordered_json json;
  json["name"] = animation.name;
  json["plays"] = animation.plays;
  if (animation.range) {
    const auto [begin, end] = *animation.range;
    json["range"] = {begin, end};
    json["frames"] = {begin * fps, end * fps};
  }
  return json;
}

std::string animation_text(const SceneAnimation& animation, double fps) {
  std::string text = fmt::format("'{}'", animation.name);
  if (animation.range) {
    const auto [begin, end] = *animation.range;
    text += fmt::format(", {:.6g} to {:.6g} s, frames {:.6g} to {:.6g}", begin, end, begin * fps, end * fps);
  }
  return text + (animation.plays ? "" : ", does not play");
}

std::string light_text(const Light& light) {
  struct Describe {
    std::string rgb(Vec3f c) const { return fmt::format("{:.4g} {:.4g} {:.4g}", c.x, c.y, c.z); }
    std::string operator()(const PointLight& l) const { return "point, intensity " + rgb(l.intensity); }
    std::string operator()(const SpotLight& l) const { return "spot, intensity " + rgb(l.intensity); }
    std::string operator()(const DirectionalLight& l) const { return "directional, irradiance " + rgb(l.irradiance); }
    std::string operator()(const ConstantLight& l) const { return "from all around, radiance " + rgb(l.radiance); }
    std::string operator()(const EnvironmentLight& l) const { return "environment '" + l.texture + "'"; }
  };
  return std::visit(Describe{}, light);
}

/// What of a loaded scene is told.
struct Loaded {
  const SceneContents& scene;
  const std::vector<SceneAnimation>& animations;
  const Shot& shot;
  double seconds;
};

nlohmann::ordered_json describe(const Loaded& loaded) {
  const auto& [scene, scene_animations, shot, seconds] = loaded;
  nlohmann::ordered_json json;
  uint64_t keys = 0;
  auto meshes = nlohmann::ordered_json::array();
  for (const Mesh& mesh : shot.meshes) {
    meshes.push_back(mesh_json(mesh));
    keys += mesh.key_count();
  }
  auto cameras = nlohmann::ordered_json::array();
  for (const SceneContents::Camera& camera : scene.cameras) cameras.push_back(camera_json(camera));
  json["triangles"] = triangle_count(shot.meshes);
  json["keys"] = keys;
  json["meshes"] = meshes;
  json["cameras"] = cameras;
  auto animations = nlohmann::ordered_json::array();
  for (const SceneAnimation& animation : scene_animations) animations.push_back(animation_json(animation, scene.fps));
  json["animations"] = animations;
  json["fps"] = scene.fps;
  json["absent_pictures"] = absent_pictures(scene);
  json["materials"] = shot.materials.size();
  json["lights"] = shot.lights.size();
  json["shutter"] = {shot.shutter_open, shot.shutter_close};
  json["image"] = {shot.projection.width, shot.projection.height};
  json["camera_moves"] = shot.camera_moves;
  json["geometry_memory_bytes"] = mesh_bytes(shot.meshes);
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["load_seconds"] = seconds;
  json["warnings"] = scene.warnings;
  json["notes"] = shot.notes;
  return json;
}

std::string key_times_text(const Mesh& mesh) {
  if (mesh.is_static()) return "still";
  constexpr size_t kMostShown = 6;
  std::string text = fmt::format("{} keys at", mesh.key_count());
  for (size_t i = 0; i < std::min(kMostShown, mesh.key_count()); ++i) text += fmt::format(" {:.4g}", mesh.key_times[i]);
  return mesh.key_count() > kMostShown ? text + " ... 1" : text;
}

void print_text(const Loaded& loaded) {
  const auto& [scene, scene_animations, shot, seconds] = loaded;
  fmt::print("{}, {}, {} of geometry, loaded in {:.2f} s with {} at most\n",
             amount(shot.meshes.size(), "mesh", "meshes"), amount(triangle_count(shot.meshes), "triangle", "triangles"),
             megabytes(mesh_bytes(shot.meshes)), seconds, megabytes(peak_memory_bytes()));
  fmt::print("{}x{} pixels, shutter {} to {} (scene time), camera {}\n", shot.projection.width, shot.projection.height,
             shot.shutter_open, shot.shutter_close, shot.camera_moves ? "moves" : "still");
  for (const Mesh& mesh : shot.meshes)
    fmt::print("mesh '{}': {}, {}, {}\n", mesh.name, amount(mesh.triangle_count(), "triangle", "triangles"),
               key_times_text(mesh), megabytes(mesh_bytes(mesh)));
  for (const SceneContents::Camera& camera : scene.cameras)
    fmt::print("camera '{}': {}\n", camera.name,
               camera.orthographic ? fmt::format("orthographic, {:.4g} high", camera.view_height)
                                   : fmt::format("perspective, {:.4g} degrees high", camera.vfov * kDegrees));
  for (size_t i = 0; i < scene.lights.size(); ++i) fmt::print("light {}: {}\n", i, light_text(scene.lights[i]));
  if (!scene_animations.empty()) fmt::print("{:.6g} frames a second, if --fps says nothing else\n", scene.fps);
  for (size_t i = 0; i < scene_animations.size(); ++i)
    fmt::print("animation {}: {}\n", i, animation_text(scene_animations[i], scene.fps));
  for (const std::string& picture : absent_pictures(scene)) fmt::print("absent picture: {}\n", picture);
  for (const std::string& note : shot.notes) fmt::print("note: {}\n", note);
  for (const std::string& warning : scene.warnings) fmt::print("warning: {}\n", warning);
}

void print_time_file(const std::string& path, bool as_json) {
  const TimeFile file = TimeFile::open(path);
  const TimeFrame& frame = file.picture().frame();
  const TimeQuality quality = file.picture().quality();
  const double pixels = static_cast<double>(frame.width) * frame.height;
  const double bytes = static_cast<double>(file.info().bytes);
  if (as_json) {
    nlohmann::ordered_json json;
    json["frame"] = {frame.frame_width, frame.frame_height};
    json["crop"] = {frame.left, frame.left + frame.width, frame.top, frame.top + frame.height};
    json["shutter"] = {frame.open, frame.close};
    json["frame_time"] = frame.frame_time;
    json["fps"] = frame.fps;
    json["bytes"] = file.info().bytes;
    json["slabs"] = file.info().slabs;
    json["tiles"] = file.info().tiles;
    json["tiles_there"] = file.info().tiles_there;
    json["finished"] = file.info().finished;
    json["pieces"] = quality.pieces;
    json["tolerance"] = quality.tolerance;
    json["deviation"] = quality.deviation;
    json["rounding"] = quality.rounding;
    json["clamped"] = quality.clamped;
    json["objects"] = frame.objects.size();
    json["geometry"] = file.has_geometry();
    json["rays"] = file.has_rays();
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("a picture over time, {}x{} pixels of a frame of {}x{}, {}; {:.1f} bytes and {:.1f} pieces a pixel\n",
             frame.width, frame.height, frame.frame_width, frame.frame_height, megabytes(file.info().bytes),
             bytes / pixels, static_cast<double>(quality.pieces) / pixels);
  fmt::print("shutter {} to {} (scene time), the frame's time is {}, {} frames per second\n", frame.open, frame.close,
             frame.frame_time, frame.fps);
  if (file.info().slabs > 1) fmt::print("in {} slabs of time, a frame each\n", file.info().slabs);
  fmt::print("{}\n", quality_text(quality));
  if (file.picture().has_objects())
    fmt::print("what each of {} meshes contributes, and how far away it is\n", frame.objects.size());
  if (file.has_geometry()) fmt::print("where everything is, for kairos flow\n");
  if (file.has_rays()) fmt::print("all that each ray sees, for deep segments\n");
  if (!file.info().finished)
    fmt::print("not finished: {} of {} tiles are there\n", file.info().tiles_there, file.info().tiles);
}

void run_info(const InfoArguments& arguments) {
  if (holds_time(arguments.scene.paths)) return print_time_file(arguments.scene.paths[0], arguments.json);
  const Stopwatch loading;
  const auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  const Shot shot = make_shot(*scene, shot_options(arguments.scene, *scene));
  const double seconds = loading.seconds();
  const SceneContents held = contents(*scene);
  const std::vector<SceneAnimation> held_animations = animations(*scene);
  const Loaded loaded{held, held_animations, shot, seconds};
  if (arguments.json)
    fmt::print("{}\n", describe(loaded).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  else
    print_text(loaded);
}

}  // namespace

void add_info_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("info", "Say what a scene holds: meshes, keys, memory, cameras, warnings");
  const auto arguments = std::make_shared<InfoArguments>();
  add_scene_arguments(command, arguments->scene);
  command.add_flag("--json", arguments->json, "As JSON");
  command.callback([arguments, &chosen] {
    arguments->scene.shot.textures = false;
    arguments->scene.shot.strict = arguments->scene.load.strict;
    chosen = [arguments] { run_info(*arguments); };
  });
}

}  // namespace kairos::cli
