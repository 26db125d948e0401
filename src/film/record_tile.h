// All that the rays of a square of pixels see: records, as they were handed over.
#pragma once

#include <cstdint>
#include <vector>

#include <kairos/record.h>

namespace kairos {

/// What a record says beside its rays, parts and knots.
struct RecordHead {
  float window_begin = 0, window_end = 1;
  Vec3f background;
  float still_share = 0;
  uint32_t still_own = 0, moves = 1;
  PixelPlan plan;
};

/// Records, one after the other; without normals and albedo where these are not asked for.
struct RecordTile {
  std::vector<RecordHead> heads;                                         ///< [pixel]
  std::vector<uint32_t> first_ray, first_still, first_part, first_knot;  ///< [pixel], and the end of the last one
  std::vector<PixelRay> rays, still_rays;  ///< whose parts are counted from the pixel's first one
  std::vector<SeenPart> parts;             ///< whose knots are counted from the pixel's first one
  std::vector<Knot> knots;
  std::vector<KnotSurface> surfaces;  ///< [knot]; empty where records have none

  size_t pixels() const { return heads.size(); }

  void clear();
  /// keep_surfaces: the same for all records of the tile, which have them then.
  void add(const PixelRecord& record, bool keep_surfaces = false);
  /// Of a pixel of the frame. Valid as long as the tile is not changed.
  PixelRecord record(size_t pixel, int x, int y) const;
};

}  // namespace kairos
