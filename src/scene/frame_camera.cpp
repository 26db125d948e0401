#include "scene/frame_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "camera/film_plane.h"

namespace kairos {

namespace {

constexpr Vec3d kTowardsEye{0.55, 0.4, 1};
constexpr double kMargin = 0.05;  // of the picture, on each side
// Curved motion is looked at this often over the shutter, and at least kLeastSamples times between kinks: a full turn
// then leaves the hull of the samples by less than the margin.
constexpr int kSamples = 48, kLeastSamples = 4;

class StillCamera : public TransformMotion {
 public:
  explicit StillCamera(const Mat4& world_from_camera) : world_from_camera_(world_from_camera) {}
  bool is_static(double, double) const override { return true; }
  std::vector<double> kinks(double, double) const override { return {}; }
  Mat4 at(double, Side) const override { return world_from_camera_; }

 private:
  Mat4 world_from_camera_;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far points reach in the directions that bound a perspective view (camera's axes, origin at the world's).
struct Reach {
  double right = -kInfinity, left = -kInfinity, top = -kInfinity, bottom = -kInfinity;
  double front = -kInfinity, back = -kInfinity;  // towards and away from the eye

  void add(Vec3d p, double tan_x, double tan_y) {
    if (!is_finite(p)) return;
    right = std::max(right, p.x + tan_x * p.z);
    left = std::max(left, -p.x + tan_x * p.z);
    top = std::max(top, p.y + tan_y * p.z);
    bottom = std::max(bottom, -p.y + tan_y * p.z);
    front = std::max(front, p.z);
    back = std::max(back, -p.z);
  }
  void add(const Reach& other) {
    right = std::max(right, other.right);
    left = std::max(left, other.left);
    top = std::max(top, other.top);
    bottom = std::max(bottom, other.bottom);
    front = std::max(front, other.front);
    back = std::max(back, other.back);
  }
  bool empty() const { return front == -kInfinity; }
};

Reach reach_of(const SceneMesh& mesh, const ShutterWindow& window, const Mat4& axes, double tan_x, double tan_y) {
  const VertexMotion& motion = *mesh.motion;
  std::vector<Vec3d> positions(motion.vertex_count());
  std::vector<uint8_t> used(positions.size());
  for (const Triangle& triangle : mesh.triangles)
    for (uint32_t v : triangle)
      if (v < used.size()) used[v] = 1;

  Reach reach;
  const auto look = [&](double scene_time, Side side) {
    motion.positions(scene_time, side, positions);
    for (size_t v = 0; v < positions.size(); ++v)
      if (used[v]) reach.add(transform_vector(axes, positions[v]), tan_x, tan_y);
  };
  look(window.open, Side::after);
  if (window.holds_still(motion)) return reach;
  for (const Stretch& s : divide_at_kinks(window, motion.kinks(window.open, window.close))) {
    const int samples =
        motion.is_linear_between_kinks()
            ? 1
            : std::max(kLeastSamples, static_cast<int>(std::ceil(kSamples * (s.time_end - s.time_begin))));
    look(s.begin, Side::after);
    for (int i = 1; i <= samples; ++i) {
      const double weight = static_cast<double>(i) / samples;
      look(s.begin * (1 - weight) + s.end * weight, Side::before);
    }
  }
  return reach;
}

}  // namespace

SceneCamera frame_scene(const Scene& scene, const Projection& projection, const ShutterWindow& window) {
  SceneCamera camera;
  camera.name = "framing";
  Projection framing = projection;
  static_cast<Lens&>(framing) = camera;
  const Vec2d corner = FilmPlane(framing).at(framing.width, 0);
  const double tan_x = corner.x * (1 - 2 * kMargin), tan_y = corner.y * (1 - 2 * kMargin);
  Mat4 world_from_camera = look_at(normalize(kTowardsEye), {}, {0, 1, 0});
  world_from_camera.m[3] = {0, 0, 0, 1};
  const Mat4 axes = inverse_affine(world_from_camera);

  std::vector<Reach> reaches(scene.meshes.size());
  parallel_for(reaches.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) reaches[i] = reach_of(scene.meshes[i], window, axes, tan_x, tan_y);
  });
  Reach all;
  for (const Reach& r : reaches) all.add(r);
  if (all.empty()) all.add(Vec3d{}, tan_x, tan_y);

  // Every point is on screen where the eye satisfies tan_x eye.z + eye.x >= right, tan_x eye.z - eye.x >= left and so
  // on; this is the nearest such eye. It keeps a tenth of the scene's size away from what is nearest (a flat scene seen
  // edge-on), and one metre from a single point.
  const double nearest = std::max((all.right + all.left) / (2 * tan_x), (all.top + all.bottom) / (2 * tan_y));
  const double farthest = -all.back, size = std::max(all.front - farthest, nearest - farthest);
  constexpr double kClearance = 0.1, kPoint = 1e-9;
  const double clearance = size > kPoint * (1 + std::abs(farthest)) ? kClearance * size : 1;
  const Vec3d eye{(all.right - all.left) / 2, (all.top - all.bottom) / 2, std::max(nearest, all.front + clearance)};
  const Vec3d eye_in_world = transform_vector(world_from_camera, eye);
  world_from_camera.m[3] = {eye_in_world.x, eye_in_world.y, eye_in_world.z, 1};
  camera.motion = std::make_shared<StillCamera>(world_from_camera);
  return camera;
}

}  // namespace kairos
