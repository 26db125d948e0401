#include "scene/cut_shot.h"

#include <algorithm>

namespace kairos {

namespace {

/// The mesh's vertices at a shutter time; at a jump, after it.
std::vector<Vec3f> positions_at(const Mesh& mesh, double time) {
  const auto after = std::upper_bound(mesh.key_times.begin(), mesh.key_times.end(), time,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const size_t next = static_cast<size_t>(after - mesh.key_times.begin());
  if (next == mesh.key_times.size()) return mesh.positions.back();
  const std::vector<Vec3f>&from = mesh.positions[next - 1], &to = mesh.positions[next];
  const double begin = static_cast<double>(mesh.key_times[next - 1]), end = static_cast<double>(mesh.key_times[next]);
  const double place = (time - begin) / (end - begin);
  std::vector<Vec3f> positions(from.size());
  for (size_t v = 0; v < from.size(); ++v)
    positions[v] = to_float(to_double(from[v]) * (1 - place) + to_double(to[v]) * place);
  return positions;
}

}  // namespace

Shot cut_shot(const Shot& shot, double begin, double end) {
  Shot cut = shot;
  cut.lights.clear();
  cut.light_textures.clear();
  cut.moving_lights.clear();
  const auto scene_time = [&](double time) {
    return time >= 1 ? shot.shutter_close : shot.shutter_open + time * (shot.shutter_close - shot.shutter_open);
  };
  cut.shutter_open = scene_time(begin);
  cut.shutter_close = scene_time(end);
  const auto time_in_shot = [begin, end](double time) { return begin + time * (end - begin); };
  if (shot.world_from_camera)
    cut.world_from_camera = [of_shot = shot.world_from_camera, time_in_shot](double time) {
      return of_shot(time_in_shot(time));
    };
  if (shot.camera_position)
    cut.camera_position = [of_shot = shot.camera_position, time_in_shot](double time) {
      return of_shot(time_in_shot(time));
    };
  for (size_t i = 0; i < shot.meshes.size(); ++i) {
    const Mesh& whole = shot.meshes[i];
    Mesh& mesh = cut.meshes[i];
    mesh.normals.clear();
    mesh.tangents.clear();
    if (whole.is_static()) continue;
    mesh.key_times = {0};
    mesh.positions = {positions_at(whole, begin)};
    for (size_t key = 0; key < whole.key_count(); ++key) {
      const auto time = static_cast<double>(whole.key_times[key]);
      if (time <= begin || time >= end) continue;
      mesh.key_times.push_back(static_cast<float>((time - begin) / (end - begin)));
      mesh.positions.push_back(whole.positions[key]);
    }
    mesh.key_times.push_back(1);
    mesh.positions.push_back(positions_at(whole, end));
  }
  return cut;
}

}  // namespace kairos
