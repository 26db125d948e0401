#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include <kairos/error.h>
#include <kairos/flow.h>

#include "base/parallel.h"
#include "camera/camera_rays.h"
#include "camera/film_plane.h"
#include "integrators/shot_parts.h"
#include "shading/surface.h"

namespace kairos {

namespace {

/// A ray to a point meets it at its own distance, but for so much of it: what floats of rays, of distances and of
/// vertices make of a distance, with room.
constexpr double kSameDistance = 2e-5;

struct PixelFlow {
  Vec2d by;
  FlowState state = FlowState::unknown;
  double depth = std::numeric_limits<double>::infinity();
};

/// One thread's view of the shot.
class FlowTracer {
 public:
  FlowTracer(const Shot& shot, const Tracer& tracer)
      : shot_(shot), tracer_(tracer), rays_(shot.projection), plane_(shot.projection) {}

  /// Of a point of the film, between two shutter times.
  PixelFlow at(double x, double y, const std::array<double, 2>& times) {
    from_ = static_cast<float>(times[0]);
    to_ = static_cast<float>(times[1]);
    const Ray ray = rays_.at(x, y);
    const std::optional<Segment> surface = find(ray, from_);
    if (!surface) return background(ray);
    const Mesh& mesh = shot_.meshes[surface->mesh];
    const auto before = triangle_at(mesh, surface->triangle, from_);
    const auto weights = barycentrics(before, ray);
    const Vec3d point = point_of(triangle_at(mesh, surface->triangle, to_), weights);
    PixelFlow flow;
    flow.depth = -point_of(before, weights).z;
    if (!(point.z < 0)) return flow;
    const Vec2d there = film(point);
    flow.by = way(film(point_of(before, weights)), there);  // rounding of the weights moves both
    flow.state = state_at(there, [&](const std::optional<Segment>& met, const Ray& to_point) {
      return met && (same_triangle(*met, *surface) ||
                     std::abs(distance(*met, to_point, to_) + point.z) <= kSameDistance * -point.z);
    });
    return flow;
  }

 private:
  static bool same_triangle(const Segment& a, const Segment& b) { return a.mesh == b.mesh && a.triangle == b.triangle; }
  static Vec2d way(const Vec2d& from, const Vec2d& to) { return {to.x - from.x, to.y - from.y}; }
  /// At a shutter time of the segment.
  double distance(const Segment& segment, const Ray& ray, float time) const {
    if (time == segment.begin) return static_cast<double>(segment.dist_begin);
    if (time == segment.end) return static_cast<double>(segment.dist_end);
    const auto triangle = triangle_at(shot_.meshes[segment.mesh], segment.triangle, time);
    return -point_of(triangle, barycentrics(triangle, ray)).z;
  }

  Vec2d film(const Vec3d& point) const {
    return plane_.film(plane_.orthographic() ? Vec2d{point.x, point.y} : Vec2d{point.x / -point.z, point.y / -point.z});
  }

  /// What the ray meets at a shutter time; where one segment follows on another, the later one.
  std::optional<Segment> find(const Ray& ray, float time) {
    const auto segments = tracer_.trace(ray, Visibility::visible, workspace_);
    const auto after =
        std::find_if(segments.rbegin(), segments.rend(), [&](const Segment& segment) { return segment.begin <= time; });
    if (after == segments.rend() || after->end < time || (after->end == time && time < 1)) return std::nullopt;
    return *after;
  }

  template <class IsPoint>
  FlowState state_at(const Vec2d& there, const IsPoint& is_point) {
    if (!(there.x >= 0 && there.x < shot_.projection.width && there.y >= 0 && there.y < shot_.projection.height))
      return FlowState::outside;
    const Ray ray = rays_.at(there.x, there.y);
    return is_point(find(ray, to_), ray) ? FlowState::seen : FlowState::hidden;
  }

  /// What is infinitely far away moves as the camera turns.
  PixelFlow background(const Ray& ray) {
    PixelFlow flow;
    if (plane_.orthographic()) return flow;
    Vec3d direction = to_double(ray.direction);
    if (shot_.world_from_camera) {
      const auto before = shot_.world_from_camera(static_cast<double>(from_));
      const auto after = shot_.world_from_camera(static_cast<double>(to_));
      const Vec3d world = before[0] * direction.x + before[1] * direction.y + before[2] * direction.z;
      direction = {dot(after[0], world), dot(after[1], world), dot(after[2], world)};
    }
    if (!(direction.z < 0)) return flow;
    const Vec2d there = film(direction);
    flow.by = way(film(to_double(ray.direction)), there);
    flow.state = state_at(there, [](const std::optional<Segment>& met, const Ray&) { return !met; });
    return flow;
  }

  const Shot& shot_;
  const Tracer& tracer_;
  Tracer::Workspace workspace_;
  CameraRays rays_;
  FilmPlane plane_;
  float from_ = 0, to_ = 1;  // of the pixel
};

}  // namespace

Image flow(const Shot& shot, const FlowOptions& options) {
  validate_shot(shot);
  if (!(shot.shutter_close > shot.shutter_open))
    throw Error(ErrorCode::bad_usage, "", "flow is from one instant to another: the shutter must be open for a while");
  Image image;
  image.width = image.frame_width = shot.projection.width;
  image.height = image.frame_height = shot.projection.height;
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  for (const auto& [name, storage] : {std::pair("flow.u", Channel::Storage::exact),
                                      {"flow.v", Channel::Storage::exact},
                                      {"flow.state", Channel::Storage::integer},
                                      {"depth.Z", Channel::Storage::exact}})
    image.channels.push_back({name, storage, std::vector<float>(width * height)});
  const double open = shot.shutter_open, close = shot.shutter_close;
  const std::array<double, 2> all = options.backward ? std::array<double, 2>{1, 0} : std::array<double, 2>{0, 1};
  if (!options.times)
    image.attributes = {{"kairos:flow_from", options.backward ? close : open},
                        {"kairos:flow_to", options.backward ? open : close}};
  std::atomic<size_t> done{0};
  const auto work = [&] {
    ShotParts parts(shot);
    const Tracer& tracer = parts.tracer(options.instruction_set);
    parallel_for(height, 1, [&](size_t begin, size_t end) {
      FlowTracer pixels(shot, tracer);
      for (size_t y = begin; y < end; ++y) {
        for (size_t x = 0; x < width; ++x) {
          const auto times = options.times ? options.times(static_cast<int>(x), static_cast<int>(y)) : all;
          const PixelFlow flow = pixels.at(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, times);
          const std::array<double, 4> values{flow.by.x, flow.by.y, static_cast<double>(flow.state), flow.depth};
          for (size_t c = 0; c < values.size(); ++c)
            image.channels[c].values[y * width + x] = static_cast<float>(values[c]);
        }
        done.fetch_add(1, std::memory_order_relaxed);
      }
    });
  };
  if (options.progress)
    with_threads(options.threads, work,
                 [&] { return options.progress(static_cast<double>(done) / static_cast<double>(height)); });
  else
    with_threads(options.threads, work);
  return image;
}

}  // namespace kairos
