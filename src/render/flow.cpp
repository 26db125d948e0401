#include <atomic>
#include <cmath>
#include <limits>

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
  FlowTracer(const Shot& shot, const Tracer& tracer, bool backward)
      : shot_(shot),
        tracer_(tracer),
        rays_(shot.projection),
        plane_(shot.projection),
        from_(backward ? 1.0f : 0.0f),
        to_(1 - from_) {}

  PixelFlow at(double x, double y) {
    const Ray ray = rays_.at(x, y);
    const Segment* const seen = find(ray, from_);
    if (seen == nullptr) return background(ray);
    const Mesh& mesh = shot_.meshes[seen->mesh];
    const Segment surface = *seen;
    const auto before = triangle_at(mesh, surface.triangle, from_);
    const auto weights = barycentrics(before, ray);
    const Vec3d point = point_of(triangle_at(mesh, surface.triangle, to_), weights);
    PixelFlow flow;
    flow.depth = -point_of(before, weights).z;
    if (!(point.z < 0)) return flow;
    const Vec2d there = film(point);
    flow.by = way(film(point_of(before, weights)), there);  // rounding of the weights moves both
    flow.state = state_at(there, [&](const Segment* met) {
      return met != nullptr &&
             (same_triangle(*met, surface) || std::abs(distance(*met, to_) + point.z) <= kSameDistance * -point.z);
    });
    return flow;
  }

 private:
  static bool same_triangle(const Segment& a, const Segment& b) { return a.mesh == b.mesh && a.triangle == b.triangle; }
  static Vec2d way(const Vec2d& from, const Vec2d& to) { return {to.x - from.x, to.y - from.y}; }
  /// At an end of the shutter's time that the segment reaches.
  static double distance(const Segment& segment, float time) {
    return static_cast<double>(time == 0 ? segment.dist_begin : segment.dist_end);
  }

  Vec2d film(const Vec3d& point) const {
    return plane_.film(plane_.orthographic() ? Vec2d{point.x, point.y} : Vec2d{point.x / -point.z, point.y / -point.z});
  }

  /// What the ray meets when the shutter opens (0) or closes (1); null for nothing.
  const Segment* find(const Ray& ray, float time) {
    const auto segments = tracer_.trace(ray, Visibility::visible, workspace_);
    if (segments.empty()) return nullptr;
    const Segment& end = time == 0 ? segments.front() : segments.back();
    return (time == 0 ? end.begin : end.end) == time ? &end : nullptr;
  }

  template <class IsPoint>
  FlowState state_at(const Vec2d& there, const IsPoint& is_point) {
    if (!(there.x >= 0 && there.x < shot_.projection.width && there.y >= 0 && there.y < shot_.projection.height))
      return FlowState::outside;
    return is_point(find(rays_.at(there.x, there.y), to_)) ? FlowState::seen : FlowState::hidden;
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
    flow.state = state_at(there, [](const Segment* met) { return met == nullptr; });
    return flow;
  }

  const Shot& shot_;
  const Tracer& tracer_;
  Tracer::Workspace workspace_;
  CameraRays rays_;
  FilmPlane plane_;
  float from_, to_;
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
  const std::array<double, 2> times{shot.shutter_open, shot.shutter_close};
  image.attributes = {{"kairos:flow_from", times[options.backward ? 1 : 0]},
                      {"kairos:flow_to", times[options.backward ? 0 : 1]}};
  std::atomic<size_t> done{0};
  const auto work = [&] {
    ShotParts parts(shot);
    const Tracer& tracer = parts.tracer(options.instruction_set);
    parallel_for(height, 1, [&](size_t begin, size_t end) {
      FlowTracer pixels(shot, tracer, options.backward);
      for (size_t y = begin; y < end; ++y) {
        for (size_t x = 0; x < width; ++x) {
          const PixelFlow flow = pixels.at(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
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
