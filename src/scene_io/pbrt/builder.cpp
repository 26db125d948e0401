#include "scene_io/pbrt/builder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

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
  camera_ = read_camera(kind, parameters, transform.pair(), times_, warnings);
  transform.name("camera", {inverse_affine(transform.pair().start), inverse_affine(transform.pair().end)});
}

void Builder::transform_times(double start, double end, const Place& place) {
  if (!(start <= end)) fail(place, "TransformTimes must not end before they start");
  times_ = {start, end};
}

void Builder::world_begin() {
  transform.reset();
  transform.active = {true, true};
  transform.name("world", {});
}

void Builder::begin(const std::string& what, const Place& place) {
  constexpr size_t kMaxDepth = 4096;
  if (saved_.size() >= kMaxDepth) fail(place, fmt::format("nested more than {} deep", kMaxDepth));
  saved_.push_back({what, place, now_, transform.pair(), transform.active});
}

void Builder::end(const std::string& what, const Place& place) {
  if (saved_.empty()) fail(place, what + "End without " + what + "Begin");
  Saved& saved = saved_.back();
  if (saved.what != what)
    fail(place, fmt::format("{}End, but what is open is {}Begin in line {}", what, saved.what, saved.place.line));
  if (what != "Transform") now_ = std::move(saved.attributes);
  transform.set(saved.pair);
  transform.active = saved.active;
  saved_.pop_back();
}

void Builder::object_begin(const std::string& name, const Place& place) {
  if (object_) fail(place, "ObjectBegin inside of ObjectBegin");
  begin("Object", place);
  object_ = name;
  objects_[name].clear();
}

void Builder::object_end(const Place& place) {
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
  const TransformPath path = transform.path(times_);
  for (const Use& part : found->second) {
    Use use = part;
    use.path = path.then(part.path);
    add_use(std::move(use), place);
  }
}

void Builder::area_light(const std::string& kind, const Parameters& parameters) {
  now_.emission = read_area_light(kind, parameters, textures.spectrum());
}

void Builder::light(const std::string& kind, const Parameters& parameters) {
  if (object_) {
    warnings.add(parameters.place(), "a light inside of an object is left out");
    return;
  }
  const auto source = read_light(kind, parameters, transform.pair(), textures.spectrum());
  if (!source) return;
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

void Builder::shape(const std::string& kind, const Parameters& parameters) {
  Alpha alpha;
  const Texture texture = textures.color(parameters, "alpha", {1, 1, 1});
  alpha.image = texture.image;
  alpha.map = texture.map;
  const double value = mean(texture.factor);
  alpha.value = value > 0 ? std::min(value, 1.0) : 0.0;  // also for NaN
  for (const char* passed_over : {"shadowalpha", "S", "faceIndices"}) parameters.find(passed_over);
  const std::shared_ptr<const Geometry> geometry = read_geometry(kind, parameters);
  if (!geometry) return;
  parameters.warn_unused("shape '" + printable(kind) + "'", warnings);
  if (alpha.value == 0 || (now_.surface->invisible && !now_.emission)) {
    warnings.add(parameters.place(), "shapes that cannot be seen are left out");
    return;
  }
  const bool textured = !now_.surface->material.base_color_texture.empty();
  if ((textured || !alpha.image.empty()) && geometry->uvs.empty())
    warnings.add(parameters.place(), "a textured mesh has no texture coordinates");
  if (textured && !alpha.image.empty() && alpha.map != now_.surface->map)
    warnings.add(parameters.place(), "an alpha image lies on its shape as the colour's image does");
  Use use{name_of(kind, parameters), geometry,     transform.path(times_), textured ? now_.surface->map : alpha.map,
          material_index(alpha),     now_.reversed};
  add_use(std::move(use), parameters.place());
}

void Builder::add_use(Use use, const Place& place) {
  const uint64_t triangles = use.geometry->triangles.size();
  if (triangles > triangles_left_ || uses_left_ == 0) fail(place, "the scene has too many triangles or instances");
  triangles_left_ -= triangles;
  --uses_left_;
  // Where it comes to lie it gets copies of its triangles, and perhaps of its texture coordinates.
  constexpr uint64_t kBytesOfUse = 512;  // with its motion and its mesh
  load_.budget.charge(
      kBytesOfUse + triangles * (sizeof(Triangle) + sizeof(uint32_t)) + use.geometry->uvs.size() * sizeof(Vec2f),
      place.text());
  (object_ ? objects_[*object_] : uses_).push_back(std::move(use));
}

uint32_t Builder::material_index(const Alpha& alpha) {
  const Vec3f emission = now_.emission.value_or(Vec3f{});
  const MaterialKey key{
      now_.surface,  {emission.x, emission.y, emission.z}, now_.emission.has_value(), alpha.image, alpha.value,
      alpha.map.wrap};
  const auto [found, is_new] = material_indices_.try_emplace(key, static_cast<uint32_t>(scene_.materials.size()));
  if (!is_new) return found->second;
  Material material = now_.surface->material;
  if (now_.surface->invisible) material.base_color = {};
  material.emission = emission;
  if (!alpha.image.empty()) {
    if (material.alpha_mode == Material::AlphaMode::opaque) material.alpha_mode = Material::AlphaMode::mask;
    material.alpha_texture.picture = alpha.image;
    material.alpha_texture.wrap = material.base_color_texture.empty() ? std::array{alpha.map.wrap, alpha.map.wrap}
                                                                      : material.base_color_texture.wrap;
  } else if (alpha.value < 1) {
    material.alpha_mode = Material::AlphaMode::blend;
    material.alpha *= static_cast<float>(alpha.value);
  }
  scene_.materials.push_back(std::move(material));
  return found->second;
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

SceneMesh Builder::make_mesh(const Use& use, const TransformPath& outside) const {
  SceneMesh mesh;
  mesh.name = use.name;
  mesh.triangles = use.geometry->triangles;
  mesh.prim_ids = use.geometry->prim_ids;
  mesh.material = use.material;
  mesh.uvs = use.geometry->uvs;
  for (Vec2f& uv : mesh.uvs) {
    const double u = uv.x * use.map.scale.x + use.map.offset.x, v = uv.y * use.map.scale.y + use.map.offset.y;
    uv = {static_cast<float>(u), static_cast<float>(1 - v)};  // pbrt counts from the lower edge, we from the upper
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {};
  }
  const auto motion = std::make_shared<InstanceMotion>(use.geometry->vertices, outside.then(use.path), use.reversed);
  if (motion->mirrors() != use.reversed)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  mesh.motion = motion;
  return mesh;
}

Scene Builder::finish() {
  if (!saved_.empty()) warnings.add(saved_.back().place, saved_.back().what + "Begin without its end");
  const Camera camera = camera_.value_or(Camera{});
  const bool mirror = camera.world_is_left_handed();
  TransformPath outside;
  if (mirror) {
    outside = TransformPath(AnimatedTransform(scaling({-1, 1, 1})));
    for (Light& light : scene_.lights) mirror_in_x(light);
  }
  constexpr std::array<int, 2> kDefaultSize{1280, 720};  // pbrt's
  if (camera_) {
    scene_.cameras.push_back(make_camera(camera, image_size_.value_or(kDefaultSize), warnings));
    scene_.image_size = image_size_.value_or(kDefaultSize);
  } else {
    scene_.image_size = image_size_;
  }
  scene_.shutter = camera.shutter;
  scene_.meshes.reserve(uses_.size());
  for (const Use& use : uses_) scene_.meshes.push_back(make_mesh(use, outside));
  if (scene_.materials.empty()) scene_.materials.push_back(Materials::none_given().material);
  scene_.warnings = warnings.lines();
  return std::move(scene_);
}

}  // namespace kairos::pbrt
