#include "scene_io/gltf/read_model.h"

#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/printable.h>

#include "scene_io/gltf/extensions.h"
#include "scene_io/gltf/text.h"

namespace kairos::gltf::file {

namespace {

using nlohmann::json;

/// glTF 1.0 is another format: objects by name where 2.0 has arrays.
void check_version(Members& root) {
  std::string version;
  root.object("asset", [&](Members& asset) {
    const json* said = asset.peek("version");
    version = said && said->is_number() ? fmt::format("{:.1f}", said->get<double>()) : asset.text("version");
    asset.pass_rest();  // who made it, and when
  });
  const json* scene = root.peek("scene");
  if (version.empty() && scene && scene->is_string()) version = "1.0";  // which some exporters did not write
  if (version.empty()) root.fail("asset.version is missing: this is no glTF");
  if (!version.starts_with('2'))
    root.fail("asset.version is '" + printable(version) + "': this is glTF " + printable(version) +
              ", and only 2.0 is supported; convert the file");
}

int components_of(const std::string& type, const Members& accessor) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  if (type != "MAT2" && type != "MAT3") accessor.fail("has the unknown type '" + printable(type) + "'");
  return 0;
}

Accessor read_accessor(Members& m) {
  Accessor accessor;
  for (const char* needed : {"componentType", "count", "type"}) m.need(needed);
  accessor.bufferView = m.index("bufferView");
  accessor.byteOffset = m.size("byteOffset");
  accessor.componentType = m.index("componentType");
  accessor.normalized = m.flag("normalized");
  accessor.count = m.size("count");
  accessor.components = components_of(m.text("type"), m);
  accessor.min = m.numbers("min");
  accessor.max = m.numbers("max");
  m.object("sparse", [&](Members& s) {
    Sparse& sparse = accessor.sparse.emplace();
    for (const char* needed : {"count", "indices", "values"}) s.need(needed);
    sparse.count = s.size("count");
    s.object("indices", [&](Members& part) {
      sparse.indices.bufferView = part.index("bufferView");
      sparse.indices.byteOffset = part.size("byteOffset");
      sparse.indices.componentType = part.index("componentType", 0);
    });
    s.object("values", [&](Members& part) {
      sparse.values.bufferView = part.index("bufferView");
      sparse.values.byteOffset = part.size("byteOffset");
    });
  });
  return accessor;
}

BufferView read_view(Members& m) {
  BufferView view;
  for (const char* needed : {"buffer", "byteLength"}) m.need(needed);
  view.buffer = m.index("buffer");
  view.byteOffset = m.size("byteOffset");
  view.byteLength = m.size("byteLength");
  view.byteStride = m.size("byteStride");
  m.pass("target");  // a hint for graphics cards
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    m.extension(name, [&](Members& e) {
      Compression& compression = view.compression.emplace();
      for (const char* needed : {"buffer", "byteLength", "byteStride", "count", "mode"}) e.need(needed);
      compression.buffer = e.index("buffer");
      compression.byteOffset = e.size("byteOffset");
      compression.byteLength = e.size("byteLength");
      compression.byteStride = e.size("byteStride");
      compression.count = e.size("count");
      compression.mode = e.text("mode");
      compression.filter = e.text("filter", "NONE");
    });
  return view;
}

Buffer read_buffer(Members& m) {
  Buffer buffer;
  m.need("byteLength");
  buffer.uri = m.text("uri");
  buffer.byteLength = m.size("byteLength");
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    m.extension(name, [&](Members& e) { e.pass("fallback"); });
  return buffer;
}

Image read_image(Members& m) {
  Image image;
  image.uri = m.text("uri");
  image.bufferView = m.index("bufferView");
  m.pass("mimeType");  // the picture itself says so
  return image;
}

Sampler read_sampler(Members& m) {
  Sampler sampler;
  sampler.wrapS = m.index("wrapS", sampler.wrapS);
  sampler.wrapT = m.index("wrapT", sampler.wrapT);
  m.pass("minFilter");  // rays average over a pixel's width
  constexpr int kNearest = 9728;
  if (const int filter = m.index("magFilter"); filter >= 0) sampler.nearest = filter == kNearest;
  return sampler;
}

Texture read_texture(Members& m) {
  Texture texture;
  texture.sampler = m.index("sampler");
  texture.source = m.index("source");
  // What an extension names is the same picture in another coding, for those who have no need of the plain one.
  const auto other = [&](const char* name, const char* encoding, bool is_read) {
    m.extension(name, [&](Members& e) {
      const int source = e.index("source");
      if (texture.source >= 0) return;
      if (is_read)
        texture.source = source;
      else
        texture.encoding = encoding;
    });
  };
  other("EXT_texture_webp", "WebP", true);
  other("KHR_texture_basisu", "KTX2", false);
  other("EXT_texture_avif", "AVIF", false);
  other("MSFT_texture_dds", "DDS", false);
  return texture;
}

Primitive read_primitive(Members& m) {
  Primitive primitive;
  m.need("attributes");
  primitive.attributes = m.named_indices("attributes");
  primitive.indices = m.index("indices");
  primitive.material = m.index("material");
  primitive.mode = m.index("mode", kTriangles);
  m.each("targets", [&](Members& target) { primitive.targets.push_back(target.all_indices()); });
  m.extension("KHR_draco_mesh_compression", [&](Members& e) {
    Draco& draco = primitive.draco.emplace();
    for (const char* needed : {"bufferView", "attributes"}) e.need(needed);
    draco.bufferView = e.index("bufferView");
    draco.attributes = e.named_indices("attributes");
  });
  m.extension("KHR_materials_variants", [&](Members& e) {
    e.lose("mappings", "variants of materials are left out: the file's first look is shown");
  });
  return primitive;
}

Mesh read_mesh(Members& m) {
  Mesh mesh;
  m.need("primitives");
  mesh.name = m.text("name");
  mesh.weights = m.numbers("weights");
  m.each("primitives", [&](Members& primitive) { mesh.primitives.push_back(read_primitive(primitive)); });
  return mesh;
}

Node read_node(Members& m) {
  Node node;
  node.name = m.text("name");
  node.mesh = m.index("mesh");
  node.skin = m.index("skin");
  node.camera = m.index("camera");
  node.children = m.indices("children");
  node.matrix = m.numbers("matrix");
  node.translation = m.numbers("translation");
  node.rotation = m.numbers("rotation");
  node.scale = m.numbers("scale");
  node.weights = m.numbers("weights");
  m.extension("KHR_lights_punctual", [&](Members& e) {
    e.need("light");
    node.light = e.index("light");
  });
  m.extension("KHR_node_visibility", [&](Members& e) { node.visible = e.flag("visible", true); });
  m.extension("EXT_mesh_gpu_instancing", [&](Members& e) {
    e.need("attributes");
    node.instances = e.named_indices("attributes");
  });
  return node;
}

Camera read_camera(Members& m) {
  Camera camera;
  m.need("type");
  camera.name = m.text("name");
  camera.type = m.text("type");
  if (camera.type == "perspective") m.need("perspective");
  if (camera.type == "orthographic") m.need("orthographic");
  // Rays see as near and as far as there is anything, and the picture's size says how wide.
  m.object("perspective", [&](Members& lens) {
    lens.need("yfov");
    camera.yfov = lens.number("yfov", 0);
    for (const char* passed : {"aspectRatio", "znear", "zfar"}) lens.pass(passed);
  });
  m.object("orthographic", [&](Members& lens) {
    lens.need("ymag");
    camera.ymag = lens.number("ymag", 0);
    for (const char* passed : {"xmag", "znear", "zfar"}) lens.pass(passed);
  });
  return camera;
}

Light read_light(Members& m) {
  Light light;
  m.need("type");
  light.name = m.text("name");
  light.type = m.text("type");
  light.color = m.as_many_numbers("color", {1, 1, 1});
  light.intensity = m.number("intensity", 1);
  m.lose("range", "a light's range is left out: it fades with the square of the distance alone");
  m.object("spot", [&](Members& spot) {
    light.innerConeAngle = spot.number("innerConeAngle", light.innerConeAngle);
    light.outerConeAngle = spot.number("outerConeAngle", light.outerConeAngle);
  });
  return light;
}

Channel read_channel(Members& m) {
  Channel channel;
  for (const char* needed : {"sampler", "target"}) m.need(needed);
  channel.sampler = m.index("sampler");
  m.object("target", [&](Members& target) {
    target.need("path");
    channel.target_node = target.index("node");
    channel.target_path = target.text("path");
    target.extension("KHR_animation_pointer", [&](Members& e) {
      e.need("pointer");
      channel.target_path = e.text("pointer");
    });
  });
  return channel;
}

Animation read_animation(Members& m) {
  Animation animation;
  animation.name = m.text("name");
  m.each("channels", [&](Members& channel) { animation.channels.push_back(read_channel(channel)); });
  m.each("samplers", [&](Members& s) {
    for (const char* needed : {"input", "output"}) s.need(needed);
    AnimationSampler& sampler = animation.samplers.emplace_back();
    sampler.input = s.index("input");
    sampler.output = s.index("output");
    sampler.interpolation = s.text("interpolation", sampler.interpolation);
  });
  return animation;
}

Skin read_skin(Members& m) {
  Skin skin;
  m.need("joints");
  skin.joints = m.indices("joints");
  skin.inverseBindMatrices = m.index("inverseBindMatrices");
  m.pass("skeleton");  // a hint
  return skin;
}

}  // namespace

Model read_model(json& json, const std::string& name, Warnings& warnings) {
  Members root(json, name, warnings);
  check_version(root);
  Model model;
  model.extensionsRequired = root.texts("extensionsRequired");
  check_extensions(model.extensionsRequired, root.texts("extensionsUsed"), name, warnings);
  model.scene = root.index("scene");
  root.each("scenes", [&](Members& m) {
    Scene& scene = model.scenes.emplace_back();
    scene.name = m.text("name");
    scene.nodes = m.indices("nodes");
  });
  root.each("nodes", [&](Members& m) { model.nodes.push_back(read_node(m)); });
  root.each("meshes", [&](Members& m) { model.meshes.push_back(read_mesh(m)); });
  root.each("accessors", [&](Members& m) { model.accessors.push_back(read_accessor(m)); });
  root.each("bufferViews", [&](Members& m) { model.bufferViews.push_back(read_view(m)); });
  root.each("buffers", [&](Members& m) { model.buffers.push_back(read_buffer(m)); });
  root.each("images", [&](Members& m) { model.images.push_back(read_image(m)); });
  root.each("samplers", [&](Members& m) { model.samplers.push_back(read_sampler(m)); });
  root.each("textures", [&](Members& m) { model.textures.push_back(read_texture(m)); });
  root.each("materials", [&](Members& m) { model.materials.push_back(read_material(m, warnings)); });
  root.each("skins", [&](Members& m) { model.skins.push_back(read_skin(m)); });
  root.each("cameras", [&](Members& m) { model.cameras.push_back(read_camera(m)); });
  root.extension("KHR_lights_punctual",
                 [&](Members& e) { e.each("lights", [&](Members& m) { model.lights.push_back(read_light(m)); }); });
  root.extension("KHR_materials_variants", [&](Members& e) { e.pass("variants"); });  // said where they are used
  root.extension("KHR_xmp_json_ld", [](Members& e) { e.pass_rest(); });               // notes
  root.each("animations", [&](Members& m) { model.animations.push_back(read_animation(m)); });
  root.report_rest();
  return model;
}

}  // namespace kairos::gltf::file
