// Cameras of pbrt scene files: which part of the world comes into the picture.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "scene/scene.h"
#include "scene_io/pbrt/parameters.h"
#include "scene_io/pbrt/transform.h"

namespace kairos::pbrt {

struct Camera {
  Place place;
  bool orthographic = false;
  double fov = 90;                                     ///< degrees, of the picture's shorter side
  std::optional<double> frame_aspect;                  ///< width / height; else the film's
  std::optional<std::array<double, 4>> screen_window;  ///< x min, x max, y min, y max
  std::array<double, 2> shutter{0, 1};
  TransformPair camera_from_world;
  std::array<double, 2> transform_times{0, 1};

  /// pbrt's camera space is left-handed. Where the way there from the world does not mirror, the world is left-handed
  /// too, and ours must be its mirror image.
  bool world_is_left_handed() const { return determinant3(camera_from_world.start) > 0; }
};

/// Reads a Camera statement at the current transform. An unknown kind becomes perspective, with a warning. Throws
/// Error(bad_input) for numbers that make no sense.
Camera read_camera(const std::string& kind, const Parameters& parameters, const TransformPair& camera_from_world,
                   std::array<double, 2> transform_times, Warnings& warnings);

/// What a Film statement says. Its defaults are pbrt's.
struct Film {
  Place place;
  std::array<int, 2> size{1280, 720};  ///< width, height
  double scale = 1;                    ///< of every pixel
  bool is_exposed = false;             ///< pbrt-v4: brightness is in proportion to how long the shutter is open
  std::optional<double> exposure;      ///< how long, where the film itself says so
  double brightest = std::numeric_limits<double>::infinity();  ///< component of what a ray sees, once it is exposed
};

/// kind: "rgb", "gbuffer" or "spectral" for pbrt-v4, others for v3.
Film read_film(const std::string& kind, const Parameters& parameters, Warnings& warnings);

/// What pbrt multiplies pixels by.
float film_factor(const Film& film, std::array<double, 2> shutter, Warnings& warnings);

/// Ours, for a picture of that size, in the (perhaps mirrored) world.
SceneCamera make_camera(const Camera& camera, std::array<int, 2> image_size, Warnings& warnings);

}  // namespace kairos::pbrt
