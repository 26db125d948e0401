#include "accel/sort_by_motion.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"

namespace kairos {

namespace {

constexpr uint32_t kTrianglesOfPiece = 16384;  // of a parallel loop

bool is_still(const Mesh& mesh, const Triangle& triangle) {
  for (size_t key = 1; key < mesh.key_count(); ++key)
    for (uint32_t v : triangle)
      if (mesh.positions[key][v] != mesh.positions[0][v]) return false;
  return true;
}

}  // namespace

Sorted sort_by_motion(std::span<const Mesh> meshes, bool moving_meshes_only) {
  struct Piece {
    uint32_t mesh, begin, end;
    uint32_t still_count, still_offset, moving_offset;

    uint32_t moving_count() const { return end - begin - still_count; }
  };
  std::vector<Piece> pieces;
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    if (mesh.object || (moving_meshes_only && mesh.is_static())) continue;
    const uint32_t count = static_cast<uint32_t>(mesh.triangles.size());
    for (uint64_t begin = 0; begin < count; begin += kTrianglesOfPiece)
      pieces.push_back({m, static_cast<uint32_t>(begin),
                        static_cast<uint32_t>(std::min<uint64_t>(count, begin + kTrianglesOfPiece)), 0, 0, 0});
  }
  const auto each_piece = [&](const auto& body) {
    parallel_for(pieces.size(), 1, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) body(pieces[p], meshes[pieces[p].mesh]);
    });
  };
  each_piece([](Piece& piece, const Mesh& mesh) {
    if (mesh.is_static()) {
      piece.still_count = piece.end - piece.begin;
      return;
    }
    for (uint32_t f = piece.begin; f < piece.end; ++f) piece.still_count += is_still(mesh, mesh.triangles[f]) ? 1 : 0;
  });
  uint32_t still_count = 0, moving_count = 0;
  for (Piece& piece : pieces) {
    piece.still_offset = still_count;
    piece.moving_offset = moving_count;
    still_count += piece.still_count;
    moving_count += piece.moving_count();
  }
  Sorted sorted;
  sorted.still.resize(still_count);
  sorted.moving.resize(moving_count);
  each_piece([&](const Piece& piece, const Mesh& mesh) {
    TriangleId* still = sorted.still.data() + piece.still_offset;
    TriangleId* moving = sorted.moving.data() + piece.moving_offset;
    for (uint32_t f = piece.begin; f < piece.end; ++f)
      (mesh.is_static() || is_still(mesh, mesh.triangles[f]) ? *still++ : *moving++) = {piece.mesh, f};
  });
  return sorted;
}

}  // namespace kairos
