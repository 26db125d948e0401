#include "film/object_coder.h"

#include <algorithm>

namespace kairos {

void ObjectCoder::add(const PixelRecord& record, ObjectTile& out) {
  if (out.first.empty()) out.first.push_back(0);
  if (out.signals.first.empty()) out.signals.first.push_back(0);
  if (out.depth.first.empty()) out.depth.first.push_back(0);
  find_meshes(record);
  for (const uint32_t mesh : meshes_) {
    out.mesh.push_back(mesh);
    const auto signal = signal_.make_of_mesh(record, mesh);
    coder_.add(signal, signal_.shift(), out.signals);
    add_depth(record, mesh, out.depth);
  }
  out.first.push_back(static_cast<uint32_t>(out.mesh.size()));
}

/// Those that a ray of the pixel sees. What the still term's further rays alone see is too little to have a name.
void ObjectCoder::find_meshes(const PixelRecord& record) {
  meshes_.clear();
  for (const PixelRay& ray : record.rays)
    for (const SeenPart& part : record.parts_of(ray))
      if (part.where.mesh != kNoMesh && (meshes_.empty() || meshes_.back() != part.where.mesh))
        meshes_.push_back(part.where.mesh);
  std::sort(meshes_.begin(), meshes_.end());
  meshes_.erase(std::unique(meshes_.begin(), meshes_.end()), meshes_.end());
}

void ObjectCoder::add_depth(const PixelRecord& record, uint32_t mesh, DepthPieces& out) {
  depth_.clear();
  for (const PixelRay& ray : record.rays)
    for (const SeenPart& part : record.parts_of(ray)) {
      if (part.where.mesh != mesh) continue;
      const Segment& seen = part.where;
      if (ray.is_over_time())
        depth_.add(seen.begin, seen.end, seen.dist_begin, seen.dist_end);
      else
        depth_.add(0, 1, seen.dist_begin, seen.dist_begin);
    }
  depth_.append_to(out);
}

}  // namespace kairos
