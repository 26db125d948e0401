// What Python describes of a scene, as the library has it.
#include "description.h"

#include "fields.h"

namespace kairos::python {

namespace {

/// [key][row] of an array (K, N, sides).
template <class Row>
std::vector<std::vector<Row>> keys_of(const std::string& name, py::handle value, py::ssize_t sides) {
  std::vector<std::vector<Row>> keys;
  if (value.is_none()) return keys;
  const auto array = array_of<float>(name, value, {-1, -1, sides});
  for (py::ssize_t k = 0; k < array.shape(0); ++k)
    keys.push_back(rows_of<Row>(array.data() + k * array.shape(1) * sides, static_cast<size_t>(array.shape(1))));
  return keys;
}
template <class Row>
std::vector<Row> rows(const std::string& name, py::handle value, py::ssize_t sides) {
  if (value.is_none()) return {};
  const auto array = array_of<float>(name, value, {-1, sides});
  return rows_of<Row>(array.data(), static_cast<size_t>(array.shape(0)));
}
template <class T>
std::vector<T> numbers(const std::string& name, py::handle value) {
  if (value.is_none()) return {};
  const auto array = array_of<T>(name, value, {-1});
  return {array.data(), array.data() + array.size()};
}
std::vector<Triangle> triangles_of(const std::string& name, py::handle value) {
  const auto array = array_of<uint32_t>(name, value, {-1, 3});
  return rows_of<Triangle>(array.data(), static_cast<size_t>(array.shape(0)));
}

MeshDescription mesh_from(py::handle mesh) {
  MeshDescription out;
  read("name", mesh.attr("name"), out.name);
  const std::string place = "mesh '" + out.name + "', ";
  out.triangles = triangles_of(place + "triangles", mesh.attr("triangles"));
  out.times = numbers<double>(place + "key_times", mesh.attr("key_times"));
  out.positions = keys_of<Vec3f>(place + "positions", mesh.attr("positions"), 3);
  out.normals = keys_of<Vec3f>(place + "normals", mesh.attr("normals"), 3);
  out.uvs = rows<Vec2f>(place + "uvs", mesh.attr("uvs"), 2);
  out.colors = rows<Vec4f>(place + "colors", mesh.attr("colors"), 4);
  read(place + "material", mesh.attr("material"), out.material);
  return out;
}

/// [key] of (K, 4, 4), or one of (4, 4).
std::vector<Matrix> matrices_of(const std::string& name, py::handle value) {
  const auto array = array_of<double>(name, value, {-1, 4, 4});
  std::vector<Matrix> out(static_cast<size_t>(array.shape(0)));
  for (size_t k = 0; k < out.size(); ++k)
    for (size_t r = 0; r < 4; ++r)
      for (size_t c = 0; c < 4; ++c) out[k][c][r] = array.data()[16 * k + 4 * r + c];
  return out;
}

std::vector<double> times_of(const std::string& name, py::handle value, size_t keys) {
  std::vector<double> times = numbers<double>(name, value);
  if (times.empty()) times.assign(1, 0);
  if (times.size() != keys)
    refuse(name, "has " + std::to_string(times.size()) + " times for " + std::to_string(keys) + " keys");
  return times;
}

InstanceDescription instance_from(py::handle instance) {
  InstanceDescription out;
  read("Instance, mesh", instance.attr("mesh"), out.mesh);
  read("Instance, name", instance.attr("name"), out.name);
  read("Instance, material", instance.attr("material"), out.material);
  if (instance.attr("to_world").is_none()) return out;
  const auto matrices = matrices_of("Instance, to_world", instance.attr("to_world"));
  const auto times = times_of("Instance, key_times", instance.attr("key_times"), matrices.size());
  for (size_t k = 0; k < matrices.size(); ++k) out.placement.push_back({times[k], matrices[k]});
  return out;
}

CameraDescription camera_from(py::handle camera) {
  CameraDescription out;
  read("Camera, name", camera.attr("name"), out.name);
  const std::string place = "camera '" + out.name + "', ";
  constexpr double kRadians = 3.14159265358979323846 / 180;
  double vfov_degrees = 0;
  read(place + "vfov_degrees", camera.attr("vfov_degrees"), vfov_degrees);
  out.vfov = vfov_degrees * kRadians;
  std::optional<double> view_height;
  read(place + "view_height", camera.attr("view_height"), view_height);
  out.orthographic = view_height.has_value();
  out.view_height = view_height.value_or(out.view_height);
  read(place + "pixel_aspect", camera.attr("pixel_aspect"), out.pixel_aspect);
  read(place + "shift", camera.attr("shift"), out.shift);
  read(place + "projection", camera.attr("projection"), out.matrix);
  const auto matrices = matrices_of(place + "to_world", camera.attr("to_world"));
  const auto times = times_of(place + "key_times", camera.attr("key_times"), matrices.size());
  for (size_t k = 0; k < matrices.size(); ++k) out.keys.push_back(camera_key(times[k], matrices[k]));
  return out;
}

Light light_from(py::handle light) {
  const auto kind = cast<std::string>("light", py::type::handle_of(light).attr("__name__"), "text");
  Reader reader(kind, py::dict(light.attr("__dict__")));
  if (kind == "PointLight") {
    PointLight out{};
    reader("position", out.position);
    reader("intensity", out.intensity);
    return out;
  }
  if (kind == "SpotLight") {
    SpotLight out{};
    reader("position", out.position);
    reader("direction", out.direction);
    reader("intensity", out.intensity);
    reader("cos_inner", out.cos_inner);
    reader("cos_outer", out.cos_outer);
    return out;
  }
  if (kind == "DirectionalLight") {
    DirectionalLight out{};
    reader("direction", out.direction);
    reader("irradiance", out.irradiance);
    return out;
  }
  if (kind == "ConstantLight") {
    ConstantLight out{};
    reader("radiance", out.radiance);
    return out;
  }
  if (kind == "EnvironmentLight") {
    EnvironmentLight out;
    reader("picture", out.texture);
    reader("radiance", out.radiance);
    return out;
  }
  refuse("light", "a " + kind + " is none of Kairos' lights");
}

/// Of an array (H, W, 4) of uint8 or uint16 (sRGB codes) or of float32 (linear).
Pixels pixels_from(const std::string& name, py::handle value) {
  Pixels out;
  const auto take = [&](auto& into, auto array) {
    out.height = static_cast<int>(array.shape(0));
    out.width = static_cast<int>(array.shape(1));
    into.assign(array.data(), array.data() + array.size());
  };
  if (py::isinstance<py::array_t<uint8_t>>(value))
    take(out.codes, array_of<uint8_t>(name, value, {-1, -1, 4}));
  else if (py::isinstance<py::array_t<uint16_t>>(value))
    take(out.wide_codes, array_of<uint16_t>(name, value, {-1, -1, 4}));
  else
    take(out.values, array_of<float>(name, value, {-1, -1, 4}));
  return out;
}

}  // namespace

SceneDescription description_from(const py::dict& values) {
  SceneDescription scene;
  for (const py::handle mesh : values["meshes"]) scene.meshes.push_back(mesh_from(mesh));
  for (const py::handle instance : values["instances"]) scene.instances.push_back(instance_from(instance));
  for (const py::handle material : values["materials"]) {
    Reader reader("Material", py::dict(material.attr("__dict__")));
    material_fields(reader, scene.materials.emplace_back());
    reader.finish();
  }
  for (const auto& [name, pixels] : py::dict(values["pictures"])) {
    const auto text = cast<std::string>("pictures", name, "text");
    scene.pictures[text] = pixels_from("picture '" + text + "'", pixels);
  }
  for (const py::handle camera : values["cameras"]) scene.cameras.push_back(camera_from(camera));
  for (const py::handle light : values["lights"]) scene.lights.push_back(light_from(light));
  Reader reader("make_scene", values);
  reader("background", scene.background);
  reader("shutter", scene.shutter);
  reader("size", scene.image_size);
  reader("fps", scene.fps);
  return scene;
}

}  // namespace kairos::python
