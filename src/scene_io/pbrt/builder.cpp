#include "scene_io/pbrt/builder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>

#include "scene_io/pbrt/gzip.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

constexpr uint64_t kMaxUses = 1 << 22;  // meshes of a scene: 1 GiB without a triangle in them

std::string name_of(const std::string& kind, const Parameters& parameters) {
  if (kind != "plymesh") return kind;
  std::filesystem::path file = parameters.string("filename", kind);
  if (file.extension() == ".gz") file = file.stem();
  return printable(file.stem().string());
}

}  // namespace

Builder::Builder(SceneFolder folder, LoadContext& load, uint64_t max_triangles)
    : warnings(load.options.strict),
      textures(folder, warnings),
      materials(textures, warnings),
      folder_(std::move(folder)),
      load_(load),
      triangles_left_(max_triangles),
      uses_left_(std::min(max_triangles, kMaxUses)) {
  now_.surface = std::make_shared<const Surface>(Materials::none_given());
  now_.defaults = std::make_shared<const Defaults>();
  scene_.fps = 1;
}

void Builder::camera(const std::string& kind, const Parameters& parameters) {
  transform.require_affine("a camera", parameters.place());
  camera_ = read_camera(kind, parameters, transform.pair(), times_, warnings);
  transform.name("camera", {inverse_affine(transform.pair().start), inverse_affine(transform.pair().end)});
}

void Builder::transform_times(double start, double end, const Place& place) {
  if (!(start <= end)) fail(place, "TransformTimes must not end before they start");
  times_ = {start, end};
}

void Builder::world_begin() {
  if (camera_) screen_.emplace(*camera_, film_.value_or(Film{}).size);
  transform.reset();
  transform.active = {true, true};
  transform.name("world", {});
}

void Builder::begin(const std::string& what, const Place& place) {
  constexpr size_t kMaxDepth = 4096;
  if (saved_transforms_.size() >= kMaxDepth) fail(place, fmt::format("nested more than {} deep", kMaxDepth));
  saved_transforms_.push_back({what, place, transform.pair(), transform.active});
  if (what != "Transform") saved_attributes_.push_back(now_);
}

void Builder::end(const std::string& what, const Place& place) {
  const bool with_attributes = what != "Transform";
  if (saved_transforms_.empty() || (with_attributes && saved_attributes_.empty()))
    fail(place, what + "End without " + what + "Begin");
  const SavedTransform& saved = saved_transforms_.back();
  if (saved.what != what)
    warnings.add(place,
                 fmt::format("{}End closes the {}Begin of line {}, as in pbrt-v3", what, saved.what, saved.place.line));
  transform.set(saved.pair);
  transform.active = saved.active;
  saved_transforms_.pop_back();
  if (!with_attributes) return;
  now_ = std::move(saved_attributes_.back());
  saved_attributes_.pop_back();
}

void Builder::object_begin(const std::string& name, const Place& place) {
  if (object_) fail(place, "ObjectBegin inside of ObjectBegin");
  strands_.reset();
  begin("Object", place);
  object_ = name;
  objects_[name].clear();
}

void Builder::object_end(const Place& place) {
  if (!object_) fail(place, "ObjectEnd without ObjectBegin");
  strands_.reset();
  end("Object", place);
  object_.reset();
}

void Builder::object_instance(const std::string& name, const Place& place) {
  const auto found = objects_.find(name);
  if (found == objects_.end()) {
    warnings.add(place, "no object '" + printable(name) + "' was defined before: left out");
    return;
  }
  if (object_ && *object_ == name) fail(place, "object '" + printable(name) + "' holds an instance of itself");
  transform.require_affine("an instance", place);
  const TransformPath path = transform.path(times_);
  for (const Use& part : found->second) {
    Use use = part;
    use.path = path.then(part.path);
    add_use(std::move(use), place);
  }
}

void Builder::area_light(const std::string& kind, const Parameters& parameters) {
  scene_.brings_lights = true;
  now_.light = std::make_shared<const AreaLight>(read_area_light(kind, parameters, textures.spectrum()));
}

void Builder::light(const std::string& kind, const Parameters& parameters) {
  scene_.brings_lights = true;
  if (object_) {
    warnings.add(parameters.place(), "a light inside of an object is left out");
    return;
  }
  const auto source = read_light(kind, parameters, transform.pair(), textures.spectrum());
  if (!source) return;
  if (source->moves) light_paths_[scene_.lights.size()] = transform.path(times_);
  scene_.lights.push_back(source->light);
  scene_.background = scene_.background + source->background;
}

std::shared_ptr<const Geometry> Builder::read_geometry(const std::string& kind, const Parameters& parameters) {
  ShapeContext context{folder_, load_, warnings, triangles_left_};
  if (kind != "plymesh") return read_shape(kind, parameters, context);
  // The same file may be asked for many times, which is not worth reading it again.
  const std::string name = parameters.string("filename", "");
  const auto found = ply_files_.find(name);
  if (found != ply_files_.end()) return found->second;
  return ply_files_[name] = read_shape(kind, parameters, context);
}

Alpha Builder::read_alpha(const Parameters& parameters) {
  Alpha alpha;
  const Texture texture = textures.color(parameters, "alpha", {1, 1, 1});
  if (texture.is_absent) return alpha;  // a surface whose alpha cannot be known is whole
  alpha.image = texture.reference();
  const double value = mean(texture.factor);
  alpha.value = value > 0 ? std::min(value, 1.0) : 0.0;  // also for NaN
  return alpha;
}

void Builder::shape(const std::string& kind, const Parameters& parameters) {
  const Alpha alpha = read_alpha(parameters);
  if (parameters.find("shadowalpha"))
    warnings.add(parameters.place(), "'shadowalpha' is left out: shadows are as 'alpha' says");
  for (const char* passed_over : {"S", "faceIndices"}) parameters.find(passed_over);  // for what Kairos does not have
  if (kind == "curve") return add_curve_shape(parameters, alpha);
  strands_.reset();
  Use use;
  use.name = name_of(kind, parameters);
  if (is_quadric(kind))
    use.quadric = std::make_shared<const Quadric>(read_quadric(kind, parameters));
  else
    use.geometry = read_geometry(kind, parameters);
  if (!use.quadric && !use.geometry) return;
  parameters.warn_unused("shape '" + printable(kind) + "'", warnings);
  if (transform.is_affine()) {
    use.path = transform.path(times_);
  } else if (transform.pair().start == transform.pair().end) {
    if (use.quadric) use.geometry = quadric_geometry(*use.quadric, kUnseenSteps);
    use.geometry = projected(*use.geometry, transform.pair().start, parameters.place());
    use.quadric.reset();
  } else {
    fail(parameters.place(), "a shape cannot move while its transform projects");
  }
  use.look = std::make_shared<const Look>(Look{now_.surface, now_.light, alpha, parameters.place()});
  use.reversed = now_.reversed;
  add_use(std::move(use), parameters.place());
}

void Builder::add_curve_shape(const Parameters& parameters, const Alpha& alpha) {
  constexpr size_t kMostVertices = 1 << 20;  // of a mesh, so that threads have something to share
  transform.require_affine("a curve", parameters.place());
  const Curve curve = read_curve(parameters);
  parameters.warn_unused("shape 'curve'", warnings);
  const bool goes_on = strands_ && strands_->look->surface == now_.surface && strands_->look->light == now_.light &&
                       strands_->look->alpha == alpha && strands_->pair == transform.pair() &&
                       strands_->times == times_ && strands_->reversed == now_.reversed &&
                       strands_->vertices->positions.size() < kMostVertices;
  if (!goes_on) {
    Strands strands{
        std::make_shared<Geometry>(), std::make_shared<Vertices>(), {}, transform.pair(), times_, now_.reversed};
    strands.look = std::make_shared<const Look>(Look{now_.surface, now_.light, alpha, parameters.place()});
    strands.geometry->vertices = strands.vertices;
    add_use({"curve", strands.geometry, nullptr, transform.path(times_), strands.look, now_.reversed},
            parameters.place());
    strands_ = std::move(strands);
  }
  Geometry& geometry = *strands_->geometry;
  const size_t before = geometry.triangles.size();
  // Where an object will be placed is not known yet.
  std::optional<CurveView> view;
  const TransformPath path = transform.path(times_);
  if (screen_ && !object_) view.emplace(CurveView{*screen_, path});
  add_curve(curve, view, geometry.triangles, geometry.uvs, *strands_->vertices);
  const size_t more = geometry.triangles.size() - before;
  take_triangles(more, parameters.place());
  // Twice, in the shape and in its mesh; a triangle brings about one vertex.
  constexpr uint64_t kBytesOfTriangle = 2 * sizeof(Triangle) + 2 * sizeof(Vec2f) + 2 * sizeof(Vec3f);
  load_.budget.charge(more * kBytesOfTriangle, parameters.place().text());
}

void Builder::add_use(Use use, const Place& place) {
  if (use.geometry) take_triangles(use.geometry->triangles.size(), place);
  if (uses_left_ == 0) fail(place, "the scene has too many instances");
  --uses_left_;
  constexpr uint64_t kBytesOfUse = 512;  // with its motion and its mesh
  load_.budget.charge(kBytesOfUse, place.text());
  if (use.geometry) charge_surface(use.geometry, place);
  (object_ ? objects_[*object_] : uses_).push_back(std::move(use));
}

/// The meshes that are made of a geometry share triangles, in both orders, and texture coordinates; a light's are its
/// own, but triangles of lights are few.
void Builder::charge_surface(const std::shared_ptr<const Geometry>& geometry, const Place& place) {
  if (!charged_.insert(geometry).second) return;
  load_.budget.charge(
      geometry->triangles.size() * (2 * sizeof(Triangle) + sizeof(uint32_t)) + geometry->uvs.size() * sizeof(Vec2f),
      place.text());
}

void Builder::take_triangles(uint64_t count, const Place& place) {
  if (count > triangles_left_) fail(place, "the scene has too many triangles");
  triangles_left_ -= count;
}

void Builder::defaults(const std::string& target, Parameters parameters) {
  constexpr size_t kMostParameters = 64, kMostNumbers = 256;
  auto changed = std::make_shared<Defaults>(*now_.defaults);
  const Place place = parameters.place();
  parameters.add_missing((*changed)[target]);
  std::vector<Parameter> list = parameters.take_all();
  if (list.size() > kMostParameters || std::any_of(list.begin(), list.end(), [](const Parameter& parameter) {
        return parameter.numbers.size() + parameter.strings.size() > kMostNumbers;
      }))
    fail(place, "an Attribute holds too many values");
  (*changed)[target] = std::move(list);
  now_.defaults = std::move(changed);
}

void Builder::add_defaults(const std::string& target, Parameters& parameters) const {
  const auto found = now_.defaults->find(target);
  if (found != now_.defaults->end()) parameters.add_missing(found->second);
}

namespace {

/// Mean area of a shape's triangles in the world, when the transform begins.
double mean_triangle_area(const Geometry& geometry, const TransformPath& path) {
  const Mat4 matrix = path.at(-std::numeric_limits<double>::infinity(), Side::before);
  const auto corner = [&](uint32_t v) { return transform_point(matrix, to_double(geometry.vertices->positions[v])); };
  double sum = 0;
  for (const auto& [a, b, c] : geometry.triangles)
    sum += length(cross(corner(b) - corner(a), corner(c) - corner(a))) / 2;
  return sum / static_cast<double>(geometry.triangles.size());
}

/// Winds the triangles of a light so that their fronts are on the side of their normals, as pbrt sees them.
void turn_to_normals(const Geometry& geometry, std::vector<Triangle>& triangles) {
  const std::vector<Vec3f>&p = geometry.vertices->positions, &n = geometry.vertices->normals;
  if (n.empty()) return;
  for (Triangle& t : triangles) {
    const Vec3d origin = to_double(p[t[0]]);
    const Vec3d front = cross(to_double(p[t[1]]) - origin, to_double(p[t[2]]) - origin);
    if (dot(front, to_double(n[t[0]] + n[t[1]] + n[t[2]])) < 0) std::swap(t[1], t[2]);
  }
}

}  // namespace

const SceneMesh& Builder::surface_of(const std::shared_ptr<const Geometry>& geometry) {
  const auto [place, is_new] = surfaces_.try_emplace(geometry);
  SceneMesh& surface = place->second;
  if (!is_new) return surface;
  surface.triangles = geometry->triangles;
  surface.prim_ids = geometry->prim_ids;
  std::vector<Vec2f> uvs = geometry->uvs;
  for (Vec2f& uv : uvs) {
    uv.y = 1 - uv.y;  // pbrt counts from the lower edge, we from the upper
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {};
  }
  surface.uvs = std::move(uvs);
  return surface;
}

void Builder::add_mesh(const Use& use, const TransformPath& outside, SceneLooks& looks, QuadricMeshes& quadrics) {
  const Look& look = *use.look;
  if (SceneLooks::is_nothing(look)) return warnings.add(look.place, "shapes that cannot be seen are left out");
  const std::shared_ptr<const Geometry> shared = use.quadric ? quadrics.mesh_of(*use.quadric, use.path) : use.geometry;
  const Geometry& geometry = *shared;
  if (use.quadric) {
    take_triangles(geometry.triangles.size(), look.place);
    charge_surface(shared, look.place);
  }
  SceneMesh mesh;
  mesh.name = use.name;
  const SceneMesh& surface = surface_of(shared);
  mesh.triangles = surface.triangles;
  mesh.prim_ids = surface.prim_ids;
  mesh.uvs = surface.uvs;
  Vec3f emitted;
  if (look.light) {
    emitted = look.light->radiance;
    // Each triangle of a mesh is a light of its own to pbrt, with all the power that the statement says; quadrics are
    // one.
    if (look.light->power > 0 && !geometry.triangles.empty()) {
      const double pieces = geometry.is_one_shape ? static_cast<double>(geometry.triangles.size()) : 1;
      emitted = light_of_power(*look.light, pieces * mean_triangle_area(geometry, use.path));
    }
    if (!look.light->two_sided) turn_to_normals(geometry, mesh.triangles.edit());
  }
  mesh.material = looks.material_of(look, emitted);
  const auto motion = std::make_shared<InstanceMotion>(geometry.vertices, outside.then(use.path), use.reversed);
  if (motion->mirrors() != use.reversed) mesh.triangles = turned_.of(mesh.triangles);
  mesh.motion = motion;
  scene_.meshes.push_back(std::move(mesh));
}

/// pbrt multiplies what its film has seen; here what is seen shines that much more.
void Builder::expose(const Camera& camera) {
  if (!film_) return;
  scene_.brightest = std::max(static_cast<float>(film_->brightest), std::numeric_limits<float>::min());
  const float factor = film_factor(*film_, camera.shutter, warnings);
  if (factor == 1) return;
  for (Light& light : scene_.lights) scale_light(light, factor);
  for (Material& material : scene_.materials)
    material.emission = limited(to_double(material.emission) * double{factor});
  scene_.background = limited(to_double(scene_.background) * double{factor});
}

Scene Builder::finish() {
  if (!saved_transforms_.empty())
    warnings.add(saved_transforms_.back().place, saved_transforms_.back().what + "Begin without its end");
  materials.finish();
  const Camera camera = camera_.value_or(Camera{});
  const bool mirror = camera.world_is_left_handed();
  TransformPath outside;
  if (mirror) {
    outside = TransformPath(AnimatedTransform(scaling({-1, 1, 1})));
    for (size_t i = 0; i < scene_.lights.size(); ++i)
      if (light_paths_.count(i) == 0) mirror_in_x(scene_.lights[i]);
  }
  if (camera_ || film_) scene_.image_size = film_.value_or(Film{}).size;
  if (camera_) scene_.cameras.push_back(make_camera(camera, *scene_.image_size, warnings));
  scene_.shutter = camera.shutter;
  SceneLooks looks(scene_.materials);
  QuadricMeshes quadrics(screen_);
  scene_.meshes.reserve(uses_.size());
  for (const Use& use : uses_) add_mesh(use, outside, looks, quadrics);
  if (scene_.materials.empty()) scene_.materials.push_back(Materials::none_given().material);
  scene_.pictures = textures.take_pictures();
  expose(camera);
  for (const auto& [index, path] : light_paths_) {
    Light& light = scene_.lights[index];
    const auto motion = std::make_shared<const LightMotion>(outside.then(path));
    scene_.moving_lights[index] = {light, motion};
    light = placed(light, motion->at(scene_.shutter->front(), Side::after));
  }
  scene_.warnings = warnings.lines();
  return std::move(scene_);
}

}  // namespace kairos::pbrt
