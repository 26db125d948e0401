// What a glTF file says, as it says it: types are sound, and what its indices and counts say is not.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene_io/gltf/warnings.h"

namespace kairos::gltf::file {

// glTF's codes.
enum ComponentType : int {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126,
};
enum Mode : int { kPoints = 0, kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

/// Indices are -1 for none. Members are called what the format calls them, unless a comment says otherwise.
struct SparsePart {
  int bufferView = -1;
  uint64_t byteOffset = 0;
  int componentType = 0;  ///< of indices
};
struct Sparse {
  uint64_t count = 0;
  SparsePart indices, values;
};
struct Accessor {
  int bufferView = -1;
  uint64_t byteOffset = 0, count = 0;
  int componentType = 0;
  int components = 0;  ///< of its type; 0 for matrices of 2 x 2 and 3 x 3, which nothing uses
  bool normalized = false;
  std::vector<double> min, max;
  std::optional<Sparse> sparse;
};

/// EXT_meshopt_compression
struct Compression {
  int buffer = -1;
  uint64_t byteOffset = 0, byteLength = 0, byteStride = 0, count = 0;
  std::string mode, filter;
};

struct BufferView {
  int buffer = -1;
  uint64_t byteOffset = 0, byteLength = 0, byteStride = 0;
  std::optional<Compression> compression;
};

struct Buffer {
  std::string uri;
  uint64_t byteLength = 0;
};

struct Image {
  std::string uri;
  int bufferView = -1;
};

struct Sampler {
  int wrapS = 10497, wrapT = 10497;
  std::optional<bool> nearest;  ///< magFilter
};

struct Texture {
  int sampler = -1;
  int source = -1;       ///< else that of an extension whose pictures are read
  std::string encoding;  ///< that of a picture which only an extension names and which is not read, or empty
};

struct TextureTransform {
  std::vector<double> offset{0, 0}, scale{1, 1};
  double rotation = 0;
};
struct TextureInfo {
  int index = -1, texCoord = 0;
  double scale = 1;  ///< of normals
  std::optional<TextureTransform> transform;
};

struct SpecularGlossiness {
  std::vector<double> diffuseFactor{1, 1, 1, 1};
  double glossinessFactor = 1;
  TextureInfo diffuseTexture;
  bool has_texture = false;  ///< specularGlossinessTexture
};

struct Material {
  std::string name;
  std::vector<double> baseColorFactor{1, 1, 1, 1}, emissiveFactor{0, 0, 0}, specularColorFactor{1, 1, 1};
  double metallicFactor = 1, roughnessFactor = 1, alphaCutoff = 0.5, emissiveStrength = 1, ior = 1.5;
  double transmissionFactor = 0, thicknessFactor = 0, specularFactor = 1;
  double clearcoatFactor = 0, clearcoatRoughnessFactor = 0;
  TextureInfo baseColorTexture, metallicRoughnessTexture, normalTexture, emissiveTexture;
  std::string alphaMode = "OPAQUE";
  bool doubleSided = false, unlit = false;
  std::optional<SpecularGlossiness> glossy;
};

struct Draco {
  int bufferView = -1;
  std::map<std::string, int> attributes;
};

struct Primitive {
  std::map<std::string, int> attributes;
  int indices = -1, material = -1, mode = kTriangles;
  std::vector<std::map<std::string, int>> targets;
  std::optional<Draco> draco;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
  std::vector<double> weights;
};

struct Node {
  std::string name;
  int mesh = -1, skin = -1, camera = -1;
  int light = -1;  ///< KHR_lights_punctual
  bool visible = true;
  std::vector<int> children;
  std::vector<double> matrix, translation, rotation, scale, weights;
  std::optional<std::map<std::string, int>> instances;  ///< EXT_mesh_gpu_instancing: its attributes
};

struct Scene {
  std::string name;
  std::vector<int> nodes;
};

struct Skin {
  std::vector<int> joints;
  int inverseBindMatrices = -1;
};

struct Camera {
  std::string name, type;
  double yfov = 0, ymag = 0;
};

struct Light {
  std::string name, type;
  std::vector<double> color{1, 1, 1};
  double intensity = 1, innerConeAngle = 0, outerConeAngle = 0.7853981633974483;
};

struct Channel {
  int sampler = -1, target_node = -1;
  std::string target_path;  ///< of KHR_animation_pointer: the pointer
};
struct AnimationSampler {
  int input = -1, output = -1;
  std::string interpolation = "LINEAR";
};
struct Animation {
  std::string name;
  std::vector<Channel> channels;
  std::vector<AnimationSampler> samplers;
};

struct Model {
  std::vector<std::string> extensionsRequired;
  int scene = -1;
  std::vector<Scene> scenes;
  std::vector<Node> nodes;
  std::vector<Mesh> meshes;
  std::vector<Accessor> accessors;
  std::vector<BufferView> bufferViews;
  std::vector<Buffer> buffers;
  std::vector<Image> images;
  std::vector<Sampler> samplers;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Skin> skins;
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  std::vector<Animation> animations;
};

/// Takes all of it out of `root`, and names what is left in it in `warnings`. Throws Error(bad_input, "name: JSON
/// path") for what is missing or of a wrong kind, and for an extension that the file cannot do without and that is not
/// read.
Model read_model(nlohmann::json& root, const std::string& name, Warnings& warnings);

}  // namespace kairos::gltf::file
