#include "scene_io/pbrt/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

void read_shutter(const Parameters& parameters, Camera& camera, Warnings& warnings) {
  double open = parameters.number("shutteropen", 0), close = parameters.number("shutterclose", 1);
  constexpr double kMaxTime = 1e9;
  if (std::abs(open) > kMaxTime || std::abs(close) > kMaxTime)
    fail(camera.place, fmt::format("shutter times must lie within {}", kMaxTime));
  if (open > close) {
    warnings.add(camera.place, "the shutter closes before it opens: both are exchanged");
    std::swap(open, close);
  }
  camera.shutter = {open, close};
}

double column_length(const Mat4& m, size_t c) { return length(Vec3d{m.m[c][0], m.m[c][1], m.m[c][2]}); }

/// Sides of the picture on a screen on which the shorter one reaches from -1 to 1.
std::array<double, 4> screen_window(const Camera& camera, double image_aspect) {
  if (camera.screen_window) return *camera.screen_window;
  const double aspect = camera.frame_aspect.value_or(image_aspect);
  const double x = std::max(aspect, 1.0), y = std::max(1 / aspect, 1.0);
  return {-x, x, -y, y};
}

}  // namespace

Camera read_camera(const std::string& kind, const Parameters& parameters, const TransformPair& camera_from_world,
                   std::array<double, 2> transform_times, Warnings& warnings) {
  Camera camera;
  camera.place = parameters.place();
  camera.camera_from_world = camera_from_world;
  camera.transform_times = transform_times;
  camera.orthographic = kind == "orthographic";
  if (kind != "perspective" && kind != "orthographic")
    warnings.add(camera.place, "a camera of kind '" + printable(kind) + "' is taken as 'perspective'");
  camera.fov = parameters.find("halffov") ? 2 * parameters.number("halffov", 45) : parameters.number("fov", 90);
  if (!(camera.fov > 0 && camera.fov < 180)) fail(camera.place, "'fov' must be between 0 and 180 degrees");
  if (parameters.find("frameaspectratio")) {
    camera.frame_aspect = parameters.number("frameaspectratio", 1);
    if (!(*camera.frame_aspect > 0)) fail(camera.place, "'frameaspectratio' must be greater than 0");
  }
  if (const Parameter* window = parameters.find("screenwindow")) {
    const std::vector<double>& n = window->numbers;
    if (n.size() != 4 || !(n[0] < n[1] && n[2] < n[3]) || !std::isfinite(n[1] - n[0]) || !std::isfinite(n[3] - n[2]))
      fail(camera.place, "'screenwindow' needs four numbers: x min, x max, y min, y max");
    camera.screen_window = {n[0], n[1], n[2], n[3]};
  }
  read_shutter(parameters, camera, warnings);
  parameters.find("focaldistance");
  if (parameters.number("lensradius", 0) != 0) warnings.add(camera.place, "depth of field is left out");
  parameters.warn_unused("camera '" + printable(kind) + "'", warnings);
  for (const Mat4* matrix : {&camera_from_world.start, &camera_from_world.end}) {
    const double det = determinant3(*matrix);
    if (!(std::abs(det) > 0) || !std::isfinite(1 / det))
      fail(camera.place, "the camera's transform cannot be inverted");
    const Mat4 world = inverse_affine(*matrix);
    const double x = column_length(world, 0), y = column_length(world, 1), z = column_length(world, 2);
    constexpr double kEven = 1e-3;
    if (std::max({x, y, z}) > (1 + kEven) * std::min({x, y, z}))
      warnings.add(camera.place, "the camera is scaled unevenly; the picture is as if it were not");
  }
  return camera;
}

Film read_film(const std::string& kind, const Parameters& parameters, Warnings& warnings) {
  constexpr int64_t kMaxSide = 65536;
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  Film film;
  film.place = parameters.place();
  const int64_t width = parameters.integer("xresolution", 1280), height = parameters.integer("yresolution", 720);
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    fail(parameters.place(), fmt::format("a picture of {}x{} is not between 1 and {}", width, height, kMaxSide));
  film.size = {static_cast<int>(width), static_cast<int>(height)};
  for (const char* crop : {"cropwindow", "pixelbounds"})
    if (parameters.find(crop)) warnings.add(parameters.place(), "the film's crop is left out: see --crop");
  if (const double most = parameters.number("maxcomponentvalue", kNoLimit); most > 0) film.brightest = most;
  if (parameters.find("maxsampleluminance"))
    warnings.add(parameters.place(), "'maxsampleluminance' is left out: nothing is made darker");
  for (const char* passed_over : {"filename", "diagonal", "savefp16"}) parameters.find(passed_over);
  film.is_exposed = kind == "rgb" || kind == "gbuffer" || kind == "spectral";
  film.scale = std::max(0.0, parameters.number("scale", 1));
  film.scale *= std::max(0.0, parameters.number("iso", 100)) / 100;
  if (parameters.find("exposuretime")) film.exposure = std::max(0.0, parameters.number("exposuretime", 1));
  if (const std::string sensor = parameters.string("sensor", "cie1931"); sensor != "cie1931")
    warnings.add(parameters.place(), "the sensor '" + printable(sensor) + "' is taken as 'cie1931'");
  parameters.warn_unused("film '" + printable(kind) + "'", warnings);
  return film;
}

float film_factor(const Film& film, std::array<double, 2> shutter, Warnings& warnings) {
  double factor = film.scale;
  if (film.is_exposed) factor *= film.exposure.value_or(shutter[1] - shutter[0]);
  constexpr double kMost = 1e18;  // far above any exposure, far below float's overflow
  if (factor > 0 && factor < kMost) return static_cast<float>(factor);
  warnings.add(film.place, "the film is never exposed, or beyond measure: it is taken as exposed for one second");
  return 1;
}

SceneCamera make_camera(const Camera& camera, std::array<int, 2> image_size, Warnings& warnings) {
  const double image_aspect = static_cast<double>(image_size[0]) / image_size[1];
  const auto [x_min, x_max, y_min, y_max] = screen_window(camera, image_aspect);
  const double width = x_max - x_min, height = y_max - y_min;
  constexpr double kOff = 1e-3;  // of the window's height: less than a pixel
  if (std::abs(x_min + x_max) > kOff * height || std::abs(y_min + y_max) > kOff * height)
    warnings.add(camera.place, "the screen window is not in the middle; the picture is as if it were");
  // A picture of whole pixels can be off by one of them.
  if (std::abs(width / height * image_size[1] - image_size[0]) > 1)
    warnings.add(camera.place, "the screen window's shape is not the picture's: its height counts");

  SceneCamera result;
  result.name = "camera";
  result.orthographic = camera.orthographic;
  const Mat4 start = inverse_affine(camera.camera_from_world.start), end = inverse_affine(camera.camera_from_world.end);
  if (camera.orthographic) {
    result.view_height = height * column_length(start, 1);
    if (!(result.view_height > 0) || !std::isfinite(result.view_height)) fail(camera.place, "the camera sees nothing");
  } else {
    result.vfov = 2 * std::atan(std::tan(camera.fov * std::numbers::pi / 360) * height / 2);
    constexpr double kLeast = 1e-9;
    if (!(result.vfov > kLeast && result.vfov < std::numbers::pi - kLeast))
      fail(camera.place, "the camera's field of view is empty, or half the world");
  }
  TransformPath path(AnimatedTransform(start, end, camera.transform_times));
  if (camera.world_is_left_handed()) path = TransformPath(AnimatedTransform(scaling({-1, 1, 1}))).then(path);
  result.motion = std::make_shared<CameraMotion>(path);
  return result;
}

}  // namespace kairos::pbrt
