#include "time_io/shot_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include <kairos/error.h>

namespace kairos {

namespace {

/// Camera poses at even steps of the shutter's time: between them rotations and places go on straight lines, which for
/// a turn of 90 degrees leaves the true ones by less than 1e-5.
constexpr uint32_t kPoses = 513;

class ByteWriter {
 public:
  template <class Number>
  void put(Number number) {
    append(&number, sizeof number);
  }
  template <class Item>
  void put_all(const std::vector<Item>& items) {
    append(items.data(), items.size() * sizeof(Item));
  }
  std::vector<uint8_t> take() { return std::move(bytes_); }

 private:
  void append(const void* from, size_t size) {
    const auto* bytes = static_cast<const uint8_t*>(from);
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }
  std::vector<uint8_t> bytes_;
};

struct NoShot {};

class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  template <class Number>
  Number get() {
    Number number;
    copy(&number, sizeof number);
    return number;
  }
  template <class Item>
  std::vector<Item> get_all(uint64_t count) {
    if (count > bytes_.size() / sizeof(Item)) throw NoShot{};
    std::vector<Item> items(count);
    copy(items.data(), count * sizeof(Item));
    return items;
  }
  bool at_end() const { return bytes_.empty(); }
  size_t left() const { return bytes_.size(); }

 private:
  void copy(void* to, size_t size) {
    if (size > bytes_.size()) throw NoShot{};
    if (size > 0) std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  std::span<const uint8_t> bytes_;
};

static_assert(sizeof(Vec3f) == 12 && sizeof(Triangle) == 12);

struct Pose {
  std::array<std::array<double, 3>, 4> columns;  // the camera's axes in the world, and its place
};
static_assert(sizeof(Pose) == 96);

std::array<double, 3> numbers_of(const Vec3d& v) { return {v.x, v.y, v.z}; }
Vec3d vector_of(const std::array<double, 3>& n) { return {n[0], n[1], n[2]}; }

Pose pose_of(const Shot& shot, double time) {
  const auto axes = shot.world_from_camera ? shot.world_from_camera(time)
                                           : std::array<Vec3d, 3>{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  const Vec3d place = shot.camera_position ? shot.camera_position(time) : Vec3d{};
  return {{numbers_of(axes[0]), numbers_of(axes[1]), numbers_of(axes[2]), numbers_of(place)}};
}

/// Between two poses.
Pose pose_at(const std::vector<Pose>& poses, double time) {
  const double at = std::clamp(time, 0.0, 1.0) * static_cast<double>(poses.size() - 1);
  const auto before = std::min(static_cast<size_t>(at), poses.size() - 1),
             after = std::min(before + 1, poses.size() - 1);
  const double place = at - static_cast<double>(before);
  Pose pose{};
  for (size_t c = 0; c < 4; ++c)
    for (size_t i = 0; i < 3; ++i)
      pose.columns[c][i] = poses[before].columns[c][i] * (1 - place) + poses[after].columns[c][i] * place;
  return pose;
}

/// Unit vectors at right angles, next to those given.
std::array<Vec3d, 3> orthonormal(const Pose& pose) {
  const Vec3d x = normalize(vector_of(pose.columns[0]));
  const Vec3d y = vector_of(pose.columns[1]);
  const Vec3d z = normalize(cross(x, y));
  return {x, cross(z, x), z};
}

/// Blended surfaces hide nothing and do not move in flow.
bool is_blended(const Shot& shot, const Mesh& mesh) {
  return mesh.material < shot.materials.size() &&
         shot.materials[mesh.material].alpha_mode == Material::AlphaMode::blend;
}

void put_mesh(ByteWriter& out, const Shot& shot, const Mesh& placed) {
  const Mesh mesh = expanded(placed);
  const bool left_out = is_blended(shot, mesh) || mesh.triangles.empty();
  out.put(static_cast<uint32_t>(mesh.name.size()));
  out.put(static_cast<uint32_t>(left_out ? 0 : mesh.triangles.size()));
  out.put(static_cast<uint32_t>(left_out ? 0 : mesh.key_count()));
  out.put(static_cast<uint32_t>(left_out ? 0 : mesh.vertex_count()));
  out.put(static_cast<uint32_t>(mesh.one_sided));
  out.put_all(std::vector<char>(mesh.name.begin(), mesh.name.end()));
  if (left_out) return;
  out.put_all(mesh.triangles);
  if (!mesh.is_static()) out.put_all(mesh.key_times);
  for (const auto& key : mesh.positions) out.put_all(key);
}

Mesh get_mesh(ByteReader& in) {
  Mesh mesh;
  const auto name = in.get<uint32_t>(), triangles = in.get<uint32_t>(), keys = in.get<uint32_t>(),
             vertices = in.get<uint32_t>();
  mesh.one_sided = in.get<uint32_t>() != 0;
  const auto letters = in.get_all<char>(name);
  mesh.name.assign(letters.begin(), letters.end());
  mesh.triangles = in.get_all<Triangle>(triangles);
  if (keys > 1) mesh.key_times = in.get_all<float>(keys);
  if (keys > in.left()) throw NoShot{};  // each takes a byte at least
  for (uint32_t key = 0; key < keys; ++key) mesh.positions.push_back(in.get_all<Vec3f>(vertices));
  return mesh;
}

}  // namespace

std::vector<uint8_t> shot_bytes(const Shot& shot) {
  ByteWriter out;
  const Projection& p = shot.projection;
  out.put(static_cast<uint32_t>(p.width));
  out.put(static_cast<uint32_t>(p.height));
  out.put((p.orthographic ? 1u : 0u) | (p.matrix ? 2u : 0u) | (shot.camera_moves ? 4u : 0u));
  out.put(static_cast<uint32_t>(shot.meshes.size()));
  for (const double number : {p.vfov, p.view_height, p.pixel_aspect, p.shift[0], p.shift[1]}) out.put(number);
  for (const auto& column : p.matrix.value_or(Matrix{}))
    for (const double number : column) out.put(number);
  const uint32_t poses = shot.camera_moves ? kPoses : 1;
  out.put(poses);
  for (uint32_t i = 0; i < poses; ++i) out.put(pose_of(shot, poses > 1 ? i / static_cast<double>(poses - 1) : 0));
  for (const Mesh& mesh : shot.meshes) put_mesh(out, shot, mesh);
  return out.take();
}

Shot parse_shot(std::span<const uint8_t> bytes, double open, double close, const std::string& place) {
  try {
    ByteReader in(bytes);
    Shot shot;
    shot.shutter_open = open;
    shot.shutter_close = close;
    Projection& p = shot.projection;
    constexpr uint32_t kMostSide = 1 << 20;
    const auto width = in.get<uint32_t>(), height = in.get<uint32_t>(), flags = in.get<uint32_t>(),
               meshes = in.get<uint32_t>();
    if (width > kMostSide || height > kMostSide || meshes > bytes.size()) throw NoShot{};
    p.width = static_cast<int>(width);
    p.height = static_cast<int>(height);
    p.orthographic = (flags & 1u) != 0;
    shot.camera_moves = (flags & 4u) != 0;
    for (double* number : {&p.vfov, &p.view_height, &p.pixel_aspect, p.shift.data(), &p.shift[1]})
      *number = in.get<double>();
    Matrix matrix;
    for (auto& column : matrix)
      for (double& number : column) number = in.get<double>();
    if ((flags & 2u) != 0) p.matrix = matrix;
    const auto poses = std::make_shared<std::vector<Pose>>(in.get_all<Pose>(in.get<uint32_t>()));
    if (poses->empty()) throw NoShot{};
    for (const Pose& pose : *poses) {
      for (const auto& column : pose.columns)
        if (!std::all_of(column.begin(), column.end(), [](double number) { return std::isfinite(number); }))
          throw NoShot{};
      const auto axes = orthonormal(pose);
      if (!(dot(axes[0], axes[0]) > 0 && dot(axes[2], axes[2]) > 0)) throw NoShot{};
    }
    shot.world_from_camera = [poses](double time) { return orthonormal(pose_at(*poses, time)); };
    shot.camera_position = [poses](double time) { return vector_of(pose_at(*poses, time).columns[3]); };
    for (uint32_t mesh = 0; mesh < meshes; ++mesh) shot.meshes.push_back(get_mesh(in));
    if (!in.at_end()) throw NoShot{};
    validate_shot(shot);
    return shot;
  } catch (const NoShot&) {
    throw Error(ErrorCode::bad_input, place, "holds no geometry that can be used; render it again");
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_input, place, "holds no geometry that can be used: " + std::string(error.what()));
  }
}

}  // namespace kairos
