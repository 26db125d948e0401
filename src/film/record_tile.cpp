#include "film/record_tile.h"

namespace kairos {

namespace {

template <class T>
void append_all(std::vector<T>& to, std::vector<uint32_t>& first, std::span<const T> from) {
  to.insert(to.end(), from.begin(), from.end());
  first.push_back(static_cast<uint32_t>(to.size()));
}

template <class T>
std::span<const T> of_pixel(const std::vector<T>& all, const std::vector<uint32_t>& first, size_t pixel) {
  return std::span(all).subspan(first[pixel], first[pixel + 1] - first[pixel]);
}

}  // namespace

void RecordTile::clear() {
  heads.clear();
  rays.clear();
  still_rays.clear();
  parts.clear();
  knots.clear();
  surfaces.clear();
  for (auto* first : {&first_ray, &first_still, &first_part, &first_knot}) first->assign(1, 0);
}

void RecordTile::add(const PixelRecord& record, bool keep_surfaces) {
  heads.push_back({record.window.begin, record.window.end, record.background, record.still.share, record.still.own,
                   record.moves ? 1u : 0u, record.plan});
  append_all(rays, first_ray, record.rays);
  append_all(still_rays, first_still, record.still.rays);
  append_all(parts, first_part, record.parts);
  append_all(knots, first_knot, record.knots);
  if (keep_surfaces) surfaces.insert(surfaces.end(), record.surfaces.begin(), record.surfaces.end());
}

PixelRecord RecordTile::record(size_t pixel, int x, int y) const {
  const RecordHead& head = heads[pixel];
  PixelRecord record;
  record.x = x;
  record.y = y;
  record.moves = head.moves != 0;
  record.plan = head.plan;
  record.window = {head.window_begin, head.window_end};
  record.background = head.background;
  record.rays = of_pixel(rays, first_ray, pixel);
  record.parts = of_pixel(parts, first_part, pixel);
  record.knots = of_pixel(knots, first_knot, pixel);
  if (!surfaces.empty()) record.surfaces = of_pixel(surfaces, first_knot, pixel);
  record.still = {of_pixel(still_rays, first_still, pixel), head.still_own, head.still_share};
  return record;
}

}  // namespace kairos
