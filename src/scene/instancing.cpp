#include "scene/instancing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "scene/instances.h"
#include "scene/motion_keys.h"

namespace kairos {

namespace {

// What bench/instances.py gives from docs/results/instances.csv; a test compares them.
/// Objects of fewer triangles are copied: sharing them saves little of what it takes to load and build them.
constexpr size_t kLeastTriangles = 64;
/// So are all where their copies are at most so many triangles together for each pixel of the frame: rays through a
/// single tree are cheaper, and more pixels have more rays that pay for the copies.
constexpr uint64_t kCopiedPerPixel = 2;
/// But not more than these, which take a quarter of a gigabyte: discrete rays go through shared shapes faster (the
/// garden at 960x960: 0.49 us instead of 0.71).
constexpr uint64_t kMostCopied = uint64_t{1} << 20;
/// Of the volume that the three axes of a placed object span over that of their lengths' product, and of the shortest
/// axis over the longest: below that it counts as flat.
constexpr double kLeastVolume = 1e-3;

/// What meshes must share to be instances of one object.
using ShapeKey = std::array<const void*, 8>;

ShapeKey key_of(const SceneMesh& mesh, const VertexShape& shape) {
  return {shape.positions.data(), shape.normals.data(),     shape.tangents.data(),  mesh.triangles.identity(),
          mesh.uvs.identity(),    mesh.more_uvs.identity(), mesh.colors.identity(), mesh.prim_ids.identity()};
}

Vec3d middle_of(std::span<const Vec3f> positions) {
  Vec3d low{INFINITY, INFINITY, INFINITY}, high = -low;
  for (const Vec3f& p : positions) {
    if (!is_finite(p)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], static_cast<double>(p[axis]));
      high[axis] = std::max(high[axis], static_cast<double>(p[axis]));
    }
  }
  return low.x <= high.x ? (low + high) * 0.5 : Vec3d{};
}

void fill(const SceneMesh& first, const VertexShape& shape, SharedObject& object) {
  auto mesh = std::make_shared<Mesh>();
  mesh->name = first.name;
  mesh->triangles = first.triangles;
  mesh->uvs = first.uvs;
  mesh->more_uvs = first.more_uvs;
  mesh->colors = first.colors;
  mesh->prim_ids = first.prim_ids;
  object.middle = middle_of(shape.positions);
  std::vector<Vec3f>& positions = mesh->positions.emplace_back();
  positions.reserve(shape.positions.size());
  for (const Vec3f& p : shape.positions) positions.push_back(to_float(to_double(p) - object.middle));
  if (!shape.normals.empty()) mesh->normals.emplace_back(shape.normals.begin(), shape.normals.end());
  if (!shape.tangents.empty()) mesh->tangents.emplace_back(shape.tangents.begin(), shape.tangents.end());
  object.dropped = clean_triangles(*mesh);
  object.corners = box_corners(*mesh);
  object.mesh = std::move(mesh);
}

/// The corners of an object's box in place of its vertices. How far a point leaves the straight line between two keys
/// is a convex function of its place in the object, largest in a corner.
class CornerMotion final : public VertexMotion {
 public:
  CornerMotion(const VertexMotion& motion, const SharedObject& object) : motion_(motion) {
    for (size_t c = 0; c < corners_.size(); ++c) corners_[c] = to_double(object.corners[c]) + object.middle;
  }
  size_t vertex_count() const override { return corners_.size(); }
  bool has_normals() const override { return false; }
  bool is_static(double open, double close) const override { return motion_.is_static(open, close); }
  bool is_linear_between_kinks() const override { return motion_.is_linear_between_kinks(); }
  std::vector<double> kinks(double open, double close) const override { return motion_.kinks(open, close); }
  void positions(double time, Side side, std::span<Vec3d> out) const override {
    const Mat4 matrix = motion_.placement(time, side);
    for (size_t c = 0; c < corners_.size(); ++c) out[c] = transform_point(matrix, corners_[c]);
  }
  void normals(double, Side, std::span<Vec3f>) const override {}

 private:
  const VertexMotion& motion_;
  std::array<Vec3d, 8> corners_;
};

Vec3d column(const Mat4& matrix, size_t index) { return {matrix.m[index][0], matrix.m[index][1], matrix.m[index][2]}; }

bool is_flat(const Mat4& matrix) {
  const std::array<double, 3> lengths{length(column(matrix, 0)), length(column(matrix, 1)), length(column(matrix, 2))};
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  const double volume = std::abs(determinant3(matrix));
  return !(*shortest >= kLeastVolume * *longest && volume >= kLeastVolume * lengths[0] * lengths[1] * lengths[2] &&
           volume > 0 && std::isfinite(volume));
}

AffineMap affine_map_of(const Mat4& matrix) {
  AffineMap map;
  const auto entry = [&](size_t c, size_t r) { return static_cast<float>(matrix.m[c][r]); };
  for (size_t r = 0; r < 3; ++r) map.rows[r] = {entry(0, r), entry(1, r), entry(2, r), entry(3, r)};
  return map;
}

DirectionMap directions_of(const Mat4& world_from_object, bool turned) {
  const auto rows = [](const Mat4& matrix, double sign) {
    // Only directions matter: of a length near 1, whatever the object's size.
    const double largest = std::max({length(column(matrix, 0)), length(column(matrix, 1)), length(column(matrix, 2))});
    const double scale = largest > 0 && std::isfinite(largest) ? sign / largest : sign;
    std::array<Vec3f, 3> result;
    for (size_t r = 0; r < 3; ++r) result[r] = to_float(Vec3d{matrix.m[0][r], matrix.m[1][r], matrix.m[2][r]} * scale);
    return result;
  };
  const double sign = turned ? -1 : 1;
  return {rows(normal_matrix(world_from_object), sign), rows(world_from_object, 1), static_cast<float>(sign)};
}

}  // namespace

std::vector<SharedObject> find_shared_objects(const Scene& scene, ShotOptions::Instances choice, uint64_t pixels) {
  std::vector<SharedObject> objects;
  if (choice == ShotOptions::Instances::never) return objects;
  std::map<ShapeKey, size_t> known;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const SceneMesh& mesh = scene.meshes[m];
    const auto shape = mesh.motion->shape();
    if (!shape || mesh.triangles.empty()) continue;
    const auto [place, is_new] = known.emplace(key_of(mesh, *shape), objects.size());
    if (is_new) objects.emplace_back();
    objects[place->second].meshes.push_back(m);
  }
  const auto triangles_of = [&](const SharedObject& object) -> uint64_t {
    return scene.meshes[object.meshes.front()].triangles.size();
  };
  std::erase_if(objects, [&](const SharedObject& object) {
    return object.meshes.size() < 2 ||
           (choice == ShotOptions::Instances::automatic && triangles_of(object) < kLeastTriangles);
  });
  uint64_t copied = 0;
  for (const SharedObject& object : objects) copied += object.meshes.size() * triangles_of(object);
  if (choice == ShotOptions::Instances::automatic && copied <= std::min(kMostCopied, kCopiedPerPixel * pixels))
    objects.clear();
  parallel_for(objects.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const SceneMesh& first = scene.meshes[objects[i].meshes.front()];
      fill(first, *first.motion->shape(), objects[i]);
    }
  });
  return objects;
}

std::optional<Mesh> make_instance(const SceneMesh& source, const SharedObject& object, const View& view,
                                  double tolerance, uint64_t keys_at_most, double& excess) {
  const VertexMotion& motion = *source.motion;
  const ShutterWindow& window = view.window();
  const MotionKeys keys =
      choose_motion_keys(CornerMotion(motion, object), view, tolerance, "mesh '" + source.name + "'", keys_at_most);
  excess = keys.excess;
  const bool rests = window.holds_still(motion);
  const auto world_from_object = [&](double time, Side side) {
    return rests ? motion.placement(window.open, Side::after) : motion.placement(time, side);
  };
  Mesh mesh;
  mesh.name = source.name;
  mesh.material = source.material;
  mesh.object = object.mesh;
  const size_t key_count = keys.positions.size();
  Mat4 before;
  for (size_t k = 0; k < key_count; ++k) {
    const Mat4 matrix = view.space_from_world(keys.scene_times[k], keys.sides[k]) *
                        world_from_object(keys.scene_times[k], keys.sides[k]) * translation(object.middle);
    Mat4 between = matrix;  // halfway from the last key
    for (size_t c = 0; k > 0 && c < 4; ++c)
      for (size_t r = 0; r < 4; ++r) between.m[c][r] = 0.5 * (before.m[c][r] + matrix.m[c][r]);
    if (is_flat(matrix) || is_flat(between) || determinant3(matrix) * determinant3(between) < 0) return std::nullopt;
    mesh.placements.push_back(affine_map_of(matrix));
    before = matrix;
  }
  if (key_count > 1) mesh.key_times = keys.times;
  if (object.mesh->normals.empty() && object.mesh->tangents.empty()) return mesh;
  const auto add_directions = [&](double time, Side side) {
    mesh.directions.push_back(directions_of(world_from_object(time, side), motion.turns_normals()));
  };
  // What keeps still in the camera's eye may turn in the world all the same; one set has to do, the middle's.
  if (rests)
    add_directions(window.open, Side::after);
  else if (key_count == 1)
    add_directions(window.scene_time(0.5), Side::after);
  else
    for (size_t k = 0; k < key_count; ++k) add_directions(keys.scene_times[k], keys.sides[k]);
  return mesh;
}

}  // namespace kairos
