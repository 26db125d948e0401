#include "scene/make_shot_notes.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "scene/motion_keys.h"

namespace kairos {

namespace {

std::string keys_note(std::span<const Mesh> meshes) {
  std::map<size_t, size_t> meshes_with;  // keys -> meshes
  const Mesh* most = nullptr;
  for (const Mesh& mesh : meshes) {
    if (mesh.is_static()) continue;
    ++meshes_with[mesh.key_count()];
    if (!most || mesh.key_count() > most->key_count()) most = &mesh;
  }
  size_t moving = 0;
  std::string list;
  for (const auto& [keys, count] : meshes_with) {
    moving += count;
    list += fmt::format("{}{} with {} keys", list.empty() ? "" : ", ", count, keys);
  }
  std::string note = fmt::format("{} of {} meshes move", moving, meshes.size());
  if (most) note += fmt::format(": {} (most: '{}')", list, most->name);
  return note;
}

}  // namespace

std::vector<std::string> shot_notes(std::span<const Mesh> meshes, std::span<const MeshReport> reports) {
  std::vector<std::string> notes{keys_note(meshes)};

  size_t instances = 0;
  std::set<const Mesh*> objects;
  for (const Mesh& mesh : meshes) {
    if (!mesh.object) continue;
    ++instances;
    objects.insert(mesh.object.get());
  }
  if (instances > 0)
    notes.push_back(
        fmt::format("{} meshes are instances of {} objects, which are kept once", instances, objects.size()));

  size_t limited = 0, worst = 0;
  DroppedTriangles dropped;
  size_t first_dropped = reports.size();
  for (size_t i = 0; i < reports.size(); ++i) {
    if (reports[i].excess > 0) ++limited;
    if (reports[i].excess > reports[worst].excess) worst = i;
    dropped.not_finite += reports[i].dropped.not_finite;
    dropped.zero_area += reports[i].dropped.zero_area;
    if (reports[i].dropped.total() > 0) first_dropped = std::min(first_dropped, i);
  }
  if (limited > 0)
    notes.push_back(
        fmt::format("{} meshes have as many motion keys as they may (up to {} spans) and still leave their "
                    "paths; worst: '{}', by {:.3g} pixels",
                    limited, kMaxKeySpans, meshes[worst].name, reports[worst].excess));
  if (dropped.total() > 0)
    notes.push_back(fmt::format("dropped {} bad triangles ({} not finite, {} of zero area), first in mesh '{}'",
                                dropped.total(), dropped.not_finite, dropped.zero_area, meshes[first_dropped].name));
  return notes;
}

}  // namespace kairos
