// Reduces a scene to linear motion between keys during one opening of the shutter.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/printable.h>
#include <kairos/scene.h>

#include "base/memory_budget.h"
#include "base/parallel.h"
#include "camera/film_plane.h"
#include "scene/clean_triangles.h"
#include "scene/frame_camera.h"
#include "scene/instancing.h"
#include "scene/load_textures.h"
#include "scene/make_shot_notes.h"
#include "scene/motion_keys.h"
#include "scene/scene.h"
#include "scene/shot_lights.h"
#include "scene/view.h"

namespace kairos {

namespace {

// Meshes of more vertices are made one after the other, in parallel inside, so that working copies of few are alive.
constexpr size_t kLargeMesh = 1 << 15;
constexpr uint32_t kNoObject = 0xffffffff;  // of a mesh that is no instance
// Normals that differ by no more are the same.
constexpr float kSameNormal = 1e-6f;

ShutterWindow shutter_window(const Scene& scene, const ShotOptions& options) {
  ShutterWindow window;
  const bool in_frames = options.frame || options.fps || options.shutter || !scene.shutter;
  if (in_frames) {
    const double frame = options.frame.value_or(0), fps = options.fps.value_or(scene.fps);
    const std::array<double, 2> shutter = options.shutter.value_or(std::array<double, 2>{0, 0.5});
    if (!(fps > 0) || !std::isfinite(fps))
      throw Error(ErrorCode::bad_usage, "shutter", fmt::format("{} frames per second make no sense", fps));
    window = {(frame + shutter[0]) / fps, (frame + shutter[1]) / fps};
    if (shutter[0] < shutter[1] && window.open == window.close)
      throw Error(ErrorCode::bad_usage, "shutter",
                  fmt::format("opens and closes at {}: so far from 0 it cannot be told when; give an earlier frame",
                              window.open));
  } else {
    window = {(*scene.shutter)[0], (*scene.shutter)[1]};
  }
  if (!std::isfinite(window.open) || !std::isfinite(window.close) || !(window.open <= window.close))
    throw Error(ErrorCode::bad_usage, "shutter",
                fmt::format("closes before it opens: it opens at {} and closes at {}", window.open, window.close));
  return window;
}

/// The camera called `wanted`, else the one with that index, else (empty) the first; nullptr for a scene without any.
const SceneCamera* find_camera(const Scene& scene, const std::string& wanted) {
  if (wanted.empty()) return scene.cameras.empty() ? nullptr : &scene.cameras.front();
  for (const SceneCamera& camera : scene.cameras)
    if (camera.name == wanted) return &camera;
  size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, failure] = std::from_chars(wanted.data(), end, index);
  if (failure == std::errc() && stop == end && index < scene.cameras.size()) return &scene.cameras[index];

  std::string there;
  for (size_t i = 0; i < scene.cameras.size(); ++i)
    there += fmt::format("{}{} '{}'", i ? ", " : "", i, scene.cameras[i].name);
  throw Error(ErrorCode::bad_usage, "camera '" + wanted + "'",
              there.empty() ? "the scene has no cameras" : "not there; the scene has " + there);
}

Projection projection_of(const Scene& scene, const ShotOptions& options, const SceneCamera* camera) {
  Projection projection;
  if (scene.image_size) {
    projection.width = (*scene.image_size)[0];
    projection.height = (*scene.image_size)[1];
  }
  if (options.width != 0) projection.width = options.width;
  if (options.height != 0) projection.height = options.height;
  constexpr int kMaxSize = 1 << 16;
  if (projection.width < 1 || projection.height < 1 || projection.width > kMaxSize || projection.height > kMaxSize)
    throw Error(ErrorCode::bad_usage, "image",
                fmt::format("a size of {}x{} is not between 1 and {}", projection.width, projection.height, kMaxSize));
  if (!camera) return projection;
  check_lens(*camera, "camera '" + camera->name + "'");
  static_cast<Lens&>(projection) = *camera;
  return projection;
}

bool is_same(Vec3f a, Vec3f b) {
  const Vec3f change = a - b;
  return !(std::abs(change.x) > kSameNormal || std::abs(change.y) > kSameNormal || std::abs(change.z) > kSameNormal);
}
bool is_same(const Vec4f& a, const Vec4f& b) { return is_same(Vec3f{a.x, a.y, a.z}, Vec3f{b.x, b.y, b.z}); }

/// Normals, or tangents, at the motion keys, or at one instant for all of them: read(scene_time, side, out) gives them.
template <class T, class Read>
std::vector<std::vector<T>> at_keys(const VertexMotion& motion, const MotionKeys& keys, const ShutterWindow& window,
                                    const Read& read) {
  std::vector<std::vector<T>> values;
  const auto add = [&](double scene_time, Side side) {
    values.emplace_back(motion.vertex_count());
    read(scene_time, side, values.back());
  };
  const size_t key_count = keys.positions.size();
  // What keeps still in the camera's eye may turn in the world all the same; one set of normals has to do, the
  // middle's.
  if (key_count == 1)
    add(window.scene_time(0.5), Side::after);
  else if (window.holds_still(motion))
    add(window.open, Side::after);
  if (!values.empty()) return values;

  bool same = true;
  for (size_t k = 0; k < key_count; ++k) {
    add(keys.scene_times[k], keys.sides[k]);
    for (size_t v = 0; same && v < values[k].size(); ++v) same = is_same(values[k][v], values[0][v]);
  }
  if (same) values.resize(1);
  return values;
}

void add_directions(const VertexMotion& motion, const MotionKeys& keys, const ShutterWindow& window, Mesh& mesh) {
  if (motion.has_normals())
    mesh.normals = at_keys<Vec3f>(motion, keys, window, [&](double time, Side side, std::vector<Vec3f>& out) {
      motion.normals(time, side, out);
    });
  if (motion.has_tangents())
    mesh.tangents = at_keys<Vec4f>(motion, keys, window, [&](double time, Side side, std::vector<Vec4f>& out) {
      motion.tangents(time, side, out);
    });
}

/// See Material::double_sided.
bool is_one_sided(const Material& material) { return !material.double_sided && !(material.transmission > 0); }

/// How many keys each vertex of what moves may have, so that all of them together stay within the budget: the same for
/// all, whatever the order in which meshes are made.
uint64_t most_keys(const Scene& scene, const std::vector<uint32_t>& object_of, const View& view, uint64_t bytes) {
  constexpr uint64_t kBytesPerKey = 2 * sizeof(Vec3f);  // a position and a normal
  constexpr uint64_t kVerticesOfPlacement = (sizeof(AffineMap) + sizeof(DirectionMap)) / kBytesPerKey + 1;
  uint64_t vertices = 1;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const VertexMotion& motion = *scene.meshes[m].motion;
    if (!view.space_moves() && view.window().holds_still(motion)) continue;
    vertices += object_of[m] != kNoObject ? kVerticesOfPlacement : motion.vertex_count();
  }
  return bytes / (kBytesPerKey * vertices);
}

/// What a mesh takes beside its keys when it is no instance.
uint64_t bytes_of_copy(const SceneMesh& mesh) {
  uint64_t bytes = mesh.triangles.size() * sizeof(Triangle) + mesh.uvs.size() * sizeof(Vec2f) +
                   mesh.colors.size() * sizeof(Vec4f) + mesh.prim_ids.size() * sizeof(uint32_t);
  for (const auto& set : mesh.more_uvs) bytes += set.size() * sizeof(Vec2f);
  return bytes;
}

/// Few bytes of a file may place a large shape very often: what is copied all the same is paid for first.
void charge_copies(const Scene& scene, const std::vector<uint32_t>& object_of, MemoryBudget& budget) {
  std::set<const void*> seen;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const SceneMesh& mesh = scene.meshes[m];
    if (object_of[m] == kNoObject && !mesh.triangles.empty() && !seen.insert(mesh.triangles.identity()).second)
      budget.charge(bytes_of_copy(mesh), "mesh '" + mesh.name + "'");
  }
}

uint64_t key_bytes(const Mesh& mesh) {
  uint64_t vectors = 0;
  for (const auto* keys : {&mesh.positions, &mesh.normals})
    for (const std::vector<Vec3f>& key : *keys) vectors += key.size();
  return vectors * sizeof(Vec3f) + mesh.placements.size() * sizeof(AffineMap) +
         mesh.directions.size() * sizeof(DirectionMap);
}

void note_dropped(const DroppedTriangles& dropped, const ShotOptions& options, const std::string& name,
                  MeshReport& report) {
  report.dropped = dropped;
  if (options.strict && dropped.total() > 0)
    throw Error(ErrorCode::bad_input, "mesh '" + name + "'",
                fmt::format("{} triangles have a vertex that is not finite, {} have no area", dropped.not_finite,
                            dropped.zero_area));
}

Mesh make_mesh(const SceneMesh& source, const View& view, const ShotOptions& options, uint64_t keys_at_most,
               MeshReport& report) {
  const std::string place = "mesh '" + source.name + "'";
  MotionKeys keys = choose_motion_keys(*source.motion, view, options.motion_tolerance, place, keys_at_most);
  Mesh mesh;
  mesh.name = source.name;
  mesh.triangles = source.triangles;
  add_directions(*source.motion, keys, view.window(), mesh);
  mesh.positions = std::move(keys.positions);
  if (mesh.key_count() > 1) mesh.key_times = std::move(keys.times);
  mesh.uvs = source.uvs;
  mesh.more_uvs = source.more_uvs;
  mesh.colors = source.colors;
  mesh.prim_ids = source.prim_ids;
  mesh.material = source.material;
  report.excess = keys.excess;
  note_dropped(clean_triangles(mesh), options, source.name, report);
  return mesh;
}

/// Says so when the shutter is open while nothing that is animated moves yet, or any more.
void note_animations(const Scene& scene, const ShotOptions& options, const ShutterWindow& window,
                     std::vector<std::string>& notes) {
  std::optional<std::array<double, 2>> range;
  for (const SceneAnimation& animation : scene.animations) {
    if (!animation.plays) continue;
    if (!animation.range) return;
    if (!range) range = animation.range;
    range = {std::min((*range)[0], (*animation.range)[0]), std::max((*range)[1], (*animation.range)[1])};
  }
  if (!range) return;
  const auto [begin, end] = *range;
  const bool is_before = window.close <= begin && window.open < begin, is_after = window.open >= end && end > begin;
  if (!is_before && !is_after) return;
  const double fps = options.fps.value_or(scene.fps);
  notes.push_back(
      fmt::format("the shutter is open {} the animation, which runs from {:.6g} to {:.6g}: frames {:.6g} to "
                  "{:.6g} at {:.6g} frames a second",
                  is_before ? "before" : "after", begin, end, begin * fps, end * fps, fps));
}

Shot make_shot_here(const Scene& scene, const ShotOptions& options) {
  if (!(options.motion_tolerance > 0) || !std::isfinite(options.motion_tolerance))
    throw Error(ErrorCode::bad_usage, "motion tolerance",
                fmt::format("{} is not a positive number of pixels", options.motion_tolerance));
  const ShutterWindow window = shutter_window(scene, options);
  const SceneCamera* found = find_camera(scene, options.camera);

  Shot shot;
  shot.projection = projection_of(scene, options, found);
  const SceneCamera camera = found ? *found : frame_scene(scene, shot.projection, window);
  const View view(camera, shot.projection, options.space, window);
  shot.materials = scene.materials;
  shot.background = scene.background;
  shot.brightest = scene.brightest;
  shot.shutter_open = window.open;
  shot.shutter_close = window.close;
  shot.world_from_camera = view.world_from_camera();
  shot.camera_position = view.camera_position();
  shot.camera_moves = view.camera_moves();

  MemoryBudget budget(scene.memory_budget);
  const std::vector<SharedObject> objects =
      find_shared_objects(scene, options.instances,
                          static_cast<uint64_t>(shot.projection.width) * static_cast<uint64_t>(shot.projection.height));
  std::vector<uint32_t> object_of(scene.meshes.size(), kNoObject);
  for (uint32_t i = 0; i < objects.size(); ++i)
    for (const size_t m : objects[i].meshes) object_of[m] = i;
  const uint64_t keys_at_most = most_keys(scene, object_of, view, budget.left());
  shot.meshes.resize(scene.meshes.size());
  std::vector<MeshReport> reports(scene.meshes.size());
  std::vector<size_t> small;
  charge_copies(scene, object_of, budget);
  std::vector<uint8_t> flat(scene.meshes.size(), 0);
  const auto make = [&](size_t i) {
    if (object_of[i] == kNoObject) {
      shot.meshes[i] = make_mesh(scene.meshes[i], view, options, keys_at_most, reports[i]);
      return;
    }
    const SharedObject& object = objects[object_of[i]];
    auto instance =
        make_instance(scene.meshes[i], object, view, options.motion_tolerance, keys_at_most, reports[i].excess);
    flat[i] = instance ? 0 : 1;
    if (!instance) return;
    shot.meshes[i] = std::move(*instance);
    if (i == object.meshes.front()) note_dropped(object.dropped, options, scene.meshes[i].name, reports[i]);
  };
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    if (object_of[i] != kNoObject || scene.meshes[i].motion->vertex_count() < kLargeMesh)
      small.push_back(i);
    else
      make(i);
  }
  parallel_for(small.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) make(small[i]);
  });
  for (size_t i = 0; i < flat.size(); ++i) {
    if (flat[i] == 0) continue;
    budget.charge(bytes_of_copy(scene.meshes[i]), "mesh '" + scene.meshes[i].name + "'");
    shot.meshes[i] = make_mesh(scene.meshes[i], view, options, keys_at_most, reports[i]);
  }
  for (Mesh& mesh : shot.meshes)
    mesh.one_sided = mesh.material < shot.materials.size() && is_one_sided(shot.materials[mesh.material]);

  shot.warnings = scene.warnings;
  shot.notes = scene.notes;
  note_animations(scene, options, window, shot.notes);
  if (!found) shot.notes.push_back("no camera in the scene: using one that frames it");
  for (const Mesh& mesh : shot.meshes) budget.take(std::min(budget.left(), key_bytes(mesh)));
  shot.textures = load_textures(scene, !options.textures, options.strict, budget, shot.notes);
  light_shot(shot, scene, options, camera, view, budget);
  for (std::string& note : shot_notes(shot.meshes, reports)) shot.notes.push_back(std::move(note));
  for (std::string& note : shot.notes) note = printable(note, std::string::npos);
  return shot;
}

}  // namespace

Shot make_shot(const Scene& scene, const ShotOptions& options) {
  Shot shot;
  with_threads(options.threads, [&] { shot = make_shot_here(scene, options); });
  return shot;
}

}  // namespace kairos
