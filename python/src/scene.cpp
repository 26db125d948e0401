// Scenes from files and from arrays, and shots of them.
#include <kairos/animations.h>
#include <kairos/make_scene.h>
#include <kairos/scene.h>

#include "bindings.h"
#include "description.h"
#include "fields.h"
#include "held_scene.h"
#include "shot.h"

namespace kairos::python {

namespace {

template <class F, class T>
void texture_fields(F& f, T& texture) {
  f("picture", texture.picture);
  f("uv_set", texture.uv_set);
  f("placement", texture.placement);
  f("wrap", texture.wrap);
  f("nearest", texture.nearest);
}

}  // namespace

void read(const std::string& name, py::handle value, TextureRef& out) {
  out = {};
  if (value.is_none()) return;
  Reader reader(name, py::dict(value.attr("__dict__")));
  texture_fields(reader, out);
  reader.finish();
}

py::object to_python(const TextureRef& texture) {
  if (texture.empty()) return py::none();
  Writer writer;
  texture_fields(writer, texture);
  return py::module_::import("kairos").attr("Texture")(**writer.values);
}

namespace {

py::object kairos_class(const char* name) { return py::module_::import("kairos").attr(name); }

HeldScene scene_from(const py::dict& values) {
  SceneDescription scene = description_from(values);
  const py::gil_scoped_release unlocked;
  return {make_scene(std::move(scene))};
}

HeldScene load(const std::vector<std::string>& paths, const py::dict& values) {
  LoadOptions options;
  Reader reader("load", values);
  load_fields(reader, options);
  reader.finish();
  const py::gil_scoped_release unlocked;
  return {load_scene(paths, options)};
}

// To Python.

py::object material_to(const Material& material) {
  Writer writer;
  material_fields(writer, material);
  return kairos_class("Material")(**writer.values);
}

py::dict contents_of(const HeldScene& held) {
  const SceneContents all = contents(*held.scene);
  py::list meshes, cameras, materials, played;
  for (const auto& mesh : all.meshes) {
    py::dict one;
    one["name"] = mesh.name;
    one["triangles"] = mesh.triangles;
    one["vertices"] = mesh.vertices;
    one["material"] = mesh.material;
    meshes.append(one);
  }
  for (const auto& camera : all.cameras) cameras.append(camera.name);
  for (const auto& material : all.materials) materials.append(material_to(material));
  for (const auto& animation : animations(*held.scene)) {
    py::dict one;
    one["name"] = animation.name;
    one["range"] = to_python(animation.range);
    one["plays"] = animation.plays;
    played.append(one);
  }
  py::dict out;
  out["meshes"] = meshes;
  out["cameras"] = cameras;
  out["materials"] = materials;
  out["animations"] = played;
  out["light_count"] = all.lights.size();
  out["background"] = to_python(all.background);
  out["shutter"] = to_python(all.shutter);
  out["size"] = to_python(all.image_size);
  out["fps"] = all.fps;
  out["warnings"] = all.warnings;
  return out;
}

std::shared_ptr<HeldShot> shot_of(const HeldScene& held, const py::dict& values) {
  ShotOptions options;
  options.lights = LightChoice::automatic;
  std::optional<std::array<int, 2>> size;
  std::optional<Vec3f> backdrop;
  bool transparent = false, world = false;
  std::string environment;
  EnvironmentPicture picture;
  Reader reader("", values);
  const py::object shutter = reader.take("shutter");
  std::optional<Shutter> exposed;
  if (py::hasattr(shutter, "open_line"))
    exposed = shutter_from(shutter);
  else
    read("shutter", shutter, options.shutter);
  shot_fields(reader, options);
  reader("size", size);
  reader("background", backdrop);
  reader("transparent", transparent);
  reader("world", world);
  reader("environment", environment);
  reader("environment_rotation_degrees", picture.rotation_degrees);
  reader("environment_strength", picture.strength);
  reader.finish();
  if (size) {
    if ((*size)[0] < 1 || (*size)[1] < 1) refuse("size", "is not (width, height) in pixels");
    options.width = (*size)[0];
    options.height = (*size)[1];
  }
  if (transparent) backdrop = Vec3f{};
  if (world) options.space = ShotOptions::Space::world;
  if (!environment.empty()) {
    picture.path = environment;
    options.environment = picture;
  }
  const py::gil_scoped_release unlocked;
  return std::make_shared<HeldShot>(held.scene, options, backdrop, transparent, std::move(exposed));
}

template <class Row>
py::object stacked(const std::vector<std::vector<Row>>& keys) {
  if (keys.empty()) return py::none();
  constexpr py::ssize_t kSides = sizeof(Row) / sizeof(float);
  std::vector<float> all;
  all.reserve(keys.size() * keys.front().size() * kSides);
  for (const auto& key : keys) {
    const auto* first = reinterpret_cast<const float*>(key.data());
    all.insert(all.end(), first, first + key.size() * kSides);
  }
  return array_from(std::move(all),
                    {static_cast<py::ssize_t>(keys.size()), static_cast<py::ssize_t>(keys.front().size()), kSides});
}
template <class Row>
py::object flat(const std::vector<Row>& rows) {
  return rows.empty() ? py::none() : py::object(stacked<Row>({rows}).attr("__getitem__")(0));
}

py::object mesh_of(const HeldShot& held, size_t index) {
  const auto& meshes = held.shot().meshes;
  if (index >= meshes.size()) throw py::index_error("the shot has " + std::to_string(meshes.size()) + " meshes");
  const Mesh mesh = expanded(meshes[index]);
  py::dict values;
  values["name"] = mesh.name;
  values["positions"] = stacked(mesh.positions);
  std::vector<uint32_t> corners;
  corners.reserve(mesh.triangles.size() * 3);
  for (const Triangle& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  values["triangles"] = array_from(std::move(corners), {static_cast<py::ssize_t>(mesh.triangles.size()), 3});
  if (mesh.key_count() > 1) values["key_times"] = py::cast(mesh.key_times);
  values["normals"] = stacked(mesh.normals);
  values["uvs"] = flat(mesh.uvs);
  values["colors"] = flat(mesh.colors);
  values["material"] = mesh.material;
  py::object made = kairos_class("Mesh")(**values);
  if (!mesh.prim_ids.empty())
    made.attr("ids") =
        array_from(std::vector<uint32_t>(mesh.prim_ids), {static_cast<py::ssize_t>(mesh.prim_ids.size())});
  return made;
}

py::array_t<double> world_from_camera(const HeldShot& held, double time) {
  if (!(time >= 0 && time <= 1)) refuse("time", "is not from 0, when the shutter opens, to 1, when it closes");
  const auto axes = held.shot().world_from_camera(time);
  const Vec3d at = held.shot().camera_position(time);
  const std::array<Vec3d, 4> columns{axes[0], axes[1], axes[2], at};
  std::vector<double> out(16, 0);
  for (int r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c) out[4 * static_cast<size_t>(r) + c] = columns[c][r];
  out[15] = 1;
  return array_from(std::move(out), {4, 4});
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<HeldScene>(module, "Scene").def("contents", &contents_of).def("shot", &shot_of);
  module.def("load", &load);
  module.def("make_scene", &scene_from);
  py::class_<HeldShot, std::shared_ptr<HeldShot>>(module, "Shot")
      .def("mesh", &mesh_of)
      .def("mesh_count", [](const HeldShot& held) { return held.shot().meshes.size(); })
      .def("triangle_count",
           [](const HeldShot& held) {
             size_t count = 0;
             for (const Mesh& mesh : held.shot().meshes) count += mesh.triangle_count();
             return count;
           })
      .def("mesh_names",
           [](const HeldShot& held) {
             std::vector<std::string> names;
             for (const Mesh& mesh : held.shot().meshes) names.push_back(mesh.name);
             return names;
           })
      .def("materials",
           [](const HeldShot& held) {
             py::list out;
             for (const Material& material : held.shot().materials) out.append(material_to(material));
             return out;
           })
      .def("notes", [](const HeldShot& held) { return held.shot().notes; })
      .def("warnings", [](const HeldShot& held) { return held.shot().warnings; })
      .def("size",
           [](const HeldShot& held) {
             return py::make_tuple(held.shot().projection.width, held.shot().projection.height);
           })
      .def("shutter",
           [](const HeldShot& held) { return py::make_tuple(held.shot().shutter_open, held.shot().shutter_close); })
      .def("camera_moves", [](const HeldShot& held) { return held.shot().camera_moves; })
      .def("in_world", [](const HeldShot& held) { return held.options().space == ShotOptions::Space::world; })
      .def("world_from_camera", &world_from_camera);
}

}  // namespace kairos::python
