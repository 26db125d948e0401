// A scene as files describe it, and one opening of the shutter on it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <kairos/export.h>
#include <kairos/mesh.h>

namespace kairos {

/// What a picture shows beyond its edges.
enum class TextureWrap {
  repeat,
  clamp,   ///< its edge
  mirror,  ///< itself, every other time mirrored
};

/// A picture, and where it lies on a surface.
struct TextureRef {
  std::string picture;  ///< a path, or the name of one of Scene's embedded ones; empty for none
  uint32_t uv_set = 0;  ///< which of a mesh's sets of texture coordinates: 0 is Mesh::uvs
  std::array<Vec3f, 2> placement{Vec3f{1, 0, 0}, Vec3f{0, 1, 0}};  ///< rows: (u, v, 1) to the picture's u and v
  std::array<TextureWrap, 2> wrap{};                               ///< along u and v
  /// Where its texels are wider than pixels: in squares, or smooth between their centres. Not said: in squares where it
  /// has 16 texels at most (a few colours next to each other, not to be mixed), else smooth.
  std::optional<bool> nearest = false;

  friend bool operator==(const TextureRef&, const TextureRef&) = default;

  bool empty() const { return picture.empty(); }
  /// A mesh's texture coordinate as the picture's.
  Vec2f place(Vec2f uv) const {
    const auto& [u, v] = placement;
    return {u.x * uv.x + u.y * uv.y + u.z, v.x * uv.x + v.y * uv.y + v.z};
  }
};

struct Material {
  enum class AlphaMode { opaque, mask, blend };

  std::string name;
  Vec3f base_color{0.8f, 0.8f, 0.8f};  ///< linear Rec. 709
  Vec3f emission{0, 0, 0};             ///< linear, scene-referred
  float metallic = 0;
  float roughness = 1;
  float specular = 1;             ///< how much of what a boundary other than metal reflects is there
  Vec3f specular_color{1, 1, 1};  ///< of that, seen straight on; it is white where seen along the surface
  float clearcoat = 0;            ///< share of the surface that has a clear coat of refractive index 1.5
  float clearcoat_roughness = 0;
  float transmission = 0;
  float ior = 1.5f;
  bool thin_walled = false;  ///< what lets light through is a skin: it does not refract
  float alpha = 1;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  /// Otherwise sight and light meet only the front. A surface with transmission is the border of what it encloses, and
  /// is there from both sides all the same.
  bool double_sided = true;
  bool one_sided_emission = false;  ///< only the front shines
  bool lamp = false;  ///< is there to shine, as pbrt's area lights are: flat shading shows its light alone
  bool emits_where_cut_out = false;  ///< what alpha takes away lights others all the same, though nobody sees it
  bool unlit = false;                ///< its base colour is what is seen of it, in any light; it shines on nothing
  // Pictures that multiply the values above. Base colour and alpha are multiplied by Mesh::colors, too.
  TextureRef base_color_texture;  ///< its alpha multiplies `alpha`
  TextureRef emission_texture;
  TextureRef metallic_roughness_texture;  ///< roughness in green, metallic in blue, not sRGB
  TextureRef alpha_texture;               ///< its red multiplies `alpha`, in place of the base colour's
  /// Which way the surface faces: 2 rgb - 1 along u, up the picture and outwards, as glTF has it. Not sRGB. Only lit
  /// shading asks.
  TextureRef normal_texture;
  float normal_scale = 1;  ///< of its first two numbers
};

struct PointLight {
  Vec3f position, intensity;
};
struct SpotLight {
  Vec3f position, direction;  ///< direction: unit, in which the light travels
  Vec3f intensity;            ///< along it
  float cos_inner = 1;        ///< cosine of the angle up to which the intensity is full
  float cos_outer = 0;        ///< cosine of the angle from which there is none
};
struct DirectionalLight {
  Vec3f direction, irradiance;  ///< direction: in which the light travels
};
struct ConstantLight {
  Vec3f radiance;
};
/// A picture of all that is far away. Without one that can be read it is even.
struct EnvironmentLight {
  enum class Mapping {
    latitude_longitude,  ///< twice as wide as high: -z in the middle, +x to the right of it, +y at the upper edge
    equal_area,          ///< square: the octahedron of P. Clarberg 2008, as pbrt-v4 has it: +z in the middle, +x to the
                         ///< right of it, +y below; -z in the corners
  };
  std::string texture;      ///< a path, or the name of one of Scene's embedded pictures
  Vec3f radiance{1, 1, 1};  ///< what the picture is multiplied by
  Mapping mapping = Mapping::latitude_longitude;
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< of the picture; orthonormal
};
/// In world space. Linear Rec. 709.
using Light = std::variant<PointLight, SpotLight, DirectionalLight, ConstantLight, EnvironmentLight>;

/// Picks what a scene file offers several of.
struct LoadOptions {
  std::string animation;   ///< name or index of a glTF animation; empty: the first; "all"; "none": rest pose
  std::string gltf_scene;  ///< name or index of a glTF scene; empty: the default one
  bool strict = false;     ///< a bad triangle or an unsupported feature is an error, not a warning
  int threads = 0;         ///< 0: as many as the machine has; no effect on the scene
  /// The folder in which everything lies that the files may name; empty: that of each file given to load_scene.
  std::string root;
  /// Bytes that the scene may take, beside 1024 for each byte of its files: motion keys, instances, what is subdivided,
  /// unpacked, and pictures.
  uint64_t memory_budget = uint64_t{1} << 30;
};

/// A scene over all of its time: meshes with motion of any kind, cameras, materials. Made by load_scene; opaque here,
/// since what one traces is a Shot of it.
struct Scene;

/// Reads OBJ, PLY, glTF 2.0, GLB, pbrt (v3 and v4) and native JSON. Several OBJ or PLY files are motion keys of one
/// mesh, spread evenly over the time 0 to 1; several files of other kinds are put together. Throws Error(bad_input) or
/// Error(io).
KAIROS_API std::shared_ptr<const Scene> load_scene(const std::vector<std::string>& paths,
                                                   const LoadOptions& options = {});

/// m[column][row], as in glTF: a point p goes to m[0] p.x + m[1] p.y + m[2] p.z + m[3].
using Matrix = std::array<std::array<double, 4>, 4>;

/// What a camera's lens does. Camera space looks along -z, y up.
struct Lens {
  bool orthographic = false;
  double vfov = 0.7853981633974483;  ///< full vertical field of view without shift, radians (perspective)
  double view_height = 2;            ///< height of the view, world units (orthographic)
  double pixel_aspect = 1;           ///< what a pixel sees: its width over its height
  /// How far the middle of the picture lies to the right of the view axis, and above it: parts of the height of the
  /// view.
  std::array<double, 2> shift{0, 0};
  /// In place of all of these: from camera space to clip space as OpenGL has it, so that x / w and y / w go from -1 to
  /// 1 over the picture, whatever its size, from left to right and from bottom to top. Its last row is (0, 0, -1, 0),
  /// or (0, 0, 0, 1) for an orthographic one, up to a positive factor; the eye is at the origin and the view along -z.
  /// What becomes of z is of no concern.
  std::optional<Matrix> matrix;
};

/// Where film points go.
struct Projection : Lens {
  int width = 960, height = 540;  ///< pixels
};

/// What a scene holds, by name.
struct SceneContents {
  struct Mesh {
    std::string name;
    size_t triangles = 0, vertices = 0;
    uint32_t material = 0;  ///< index
  };
  struct Camera : Lens {
    std::string name;
  };
  std::vector<Mesh> meshes;
  std::vector<Camera> cameras;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<std::string> animations;  ///< those the files hold, played or not
  std::vector<std::string> pictures;    ///< that have no file of their own
  Vec3f background;
  std::optional<std::array<double, 2>> shutter;  ///< open, close in scene time, where the scene says so
  std::optional<std::array<int, 2>> image_size;  ///< width, height, where the scene says so
  double fps = 24;                               ///< frames per unit of scene time
  std::vector<std::string> warnings;             ///< one line each: what loading left out or took otherwise
};
KAIROS_API SceneContents contents(const Scene& scene);

/// What lights a shot. What emits, glows in any case.
enum class LightChoice {
  automatic,  ///< what the scene brings; where it brings no lights and anything reflects light, the studio
  file,       ///< what the scene brings
  studio,     ///< a soft environment and a key light (docs/light.md), in place of what the scene brings
  none,
};

/// A picture of all that is far away, by latitude and longitude, in place of a shot's environment.
struct EnvironmentPicture {
  std::string path;
  double rotation_degrees = 0;  ///< about y, counter-clockwise seen from above
  double strength = 1;          ///< what the picture is multiplied by; 0 or more
};

/// Which stretch of the scene's time the shutter is open for, and from where one looks.
struct ShotOptions {
  enum class Space {
    camera,  ///< meshes relative to the camera, so that a moving camera is motion of the meshes
    world,   ///< meshes in world space; the camera only judges what 0.1 pixel is
  };
  Space space = Space::camera;
  std::string camera;                ///< name or index; empty: the scene's first, or one that frames everything
  std::optional<double> frame, fps;  ///< shutter times below are (frame + open) / fps when any of these is given
  std::optional<std::array<double, 2>> shutter;  ///< open <= close, in frames; equal: a still frame
  int width = 0, height = 0;                     ///< 0: the scene's own, else 960x540
  bool textures = true;           ///< read all pictures; otherwise only those that say where surfaces are missing
  double motion_tolerance = 0.1;  ///< pixels: how far linear motion between keys may leave a vertex's true path
  bool strict = false;            ///< a bad triangle or picture is an error, not a note
  /// Meshes of one shape that are placed many times may share it: they are instances (see Mesh::object), which take
  /// less memory and time to build, while rays take a little longer. What is seen is the same up to rounding.
  enum class Instances {
    automatic,  ///< where copies would be more than two triangles for each pixel of the frame, or a million
    never,
    always,  ///< wherever a shape is placed twice
  };
  Instances instances = Instances::automatic;
  LightChoice lights = LightChoice::file;
  std::optional<EnvironmentPicture> environment;  ///< read when textures are
  int threads = 0;                                ///< 0: as many as the machine has; no effect on the shot
};

class Texture;

/// The pictures of one material; null where it has none, or none that can be read. Shared, immutable.
struct MaterialTextures {
  std::shared_ptr<const Texture> base_color, emission, metallic_roughness;
  std::shared_ptr<const Texture> alpha{}, normal{};
};

/// One opening of the shutter: every motion as linear motion between keys, in one space. What accelerators are built
/// from.
///
/// Invariants (validate_shot checks them): meshes are valid (see Mesh); mesh.material is below materials.size(), where
/// there are materials at all; textures, light_textures and moving_lights are empty or as many as there are materials
/// and lights; what materials, lights, the background and the projection say in numbers is finite, and the projection
/// shows something.
struct Shot {
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<MaterialTextures> textures;  ///< [material], or empty where there are none
  std::vector<Light> lights;
  std::vector<std::shared_ptr<const Texture>> light_textures;  ///< [light], or empty; null for lights without one
  /// [light], or empty: the light at a shutter time, of the same kind as in `lights`; null for lights that stand still.
  /// Called from many threads at once.
  std::vector<std::function<Light(double time)>> moving_lights;
  Vec3f background;
  /// What rays from the camera see beyond everything, in place of the background and of environments' pictures; what is
  /// mirrored or refracted sees those all the same.
  std::optional<Vec3f> backdrop;
  Vec3f seen_background() const { return limited(backdrop.value_or(background)); }  ///< by rays from the camera
  /// Above 0. What is brighter in some component is darkened as a whole, sample by sample, before it counts in a pixel:
  /// pbrt-v4's maxcomponentvalue. Light itself is not limited.
  float brightest = std::numeric_limits<float>::infinity();
  Vec3f limited(Vec3f colour) const {
    const float most = std::max({colour.x, colour.y, colour.z});
    return most > brightest ? colour * (brightest / most) : colour;
  }
  Projection projection;
  double shutter_open = 0, shutter_close = 1;  ///< scene time; equal for a still frame
  /// Rotation camera space -> world space (columns) at a shutter time, for normals; identity columns in world space.
  std::function<std::array<Vec3d, 3>(double time)> world_from_camera;
  std::function<Vec3d(double time)> camera_position;  ///< in world space; zero in world space
  bool camera_moves = false;
  std::vector<std::string>
      warnings;  ///< one line each: what loading the scene left out or took otherwise than the file says
  std::vector<std::string> notes;  ///< one line each, for the log: keys chosen, triangles dropped, textures left out
};

/// Throws Error(bad_input) that names the first broken invariant of a shot.
KAIROS_API void validate_shot(const Shot& shot);

/// Does any surface of the shot reflect light or let it through? Otherwise lights make no difference.
KAIROS_API bool reflects_light(const Shot& shot);

/// Throws Error(bad_usage) for a camera that does not exist or times that make no sense, Error(bad_input) for a camera
/// or a mesh that cannot be used.
KAIROS_API Shot make_shot(const Scene& scene, const ShotOptions& options = {});

}  // namespace kairos
