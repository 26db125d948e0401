#include "time_io/record_bytes.h"

#include <cmath>

namespace kairos {

namespace {

constexpr uint64_t kHeadWords = 14, kRayWords = 8, kPartWords = 11, kKnotWords = 4;  // of 4 bytes

// column(elements, element -> number of 4 bytes), in the order in which they stand in the file.

template <class Column>
void visit_heads(Column&& column) {
  column([](auto& head) -> auto& { return head.window_begin; });
  column([](auto& head) -> auto& { return head.window_end; });
  column([](auto& head) -> auto& { return head.background.x; });
  column([](auto& head) -> auto& { return head.background.y; });
  column([](auto& head) -> auto& { return head.background.z; });
  column([](auto& head) -> auto& { return head.still_share; });
  column([](auto& head) -> auto& { return head.still_own; });
  column([](auto& head) -> auto& { return head.moves; });
  column([](auto& head) -> auto& { return head.plan.tc_rays; });
  column([](auto& head) -> auto& { return head.plan.discrete; });
}

template <class Column>
void visit_rays(Column&& column) {
  column([](auto& ray) -> auto& { return ray.film.x; });
  column([](auto& ray) -> auto& { return ray.film.y; });
  column([](auto& ray) -> auto& { return ray.weight; });
  column([](auto& ray) -> auto& { return ray.time; });
  column([](auto& ray) -> auto& { return ray.density; });
  column([](auto& ray) -> auto& { return ray.first_part; });
  column([](auto& ray) -> auto& { return ray.parts; });
  column([](auto& ray) -> auto& { return ray.visibility_segments; });
}

template <class Column>
void visit_parts(Column&& column) {
  column([](auto& part) -> auto& { return part.where.begin; });
  column([](auto& part) -> auto& { return part.where.end; });
  column([](auto& part) -> auto& { return part.where.dist_begin; });
  column([](auto& part) -> auto& { return part.where.dist_end; });
  column([](auto& part) -> auto& { return part.where.mesh; });
  column([](auto& part) -> auto& { return part.where.triangle; });
  column([](auto& part) -> auto& { return part.first_knot; });
  column([](auto& part) -> auto& { return part.knots; });
  column([](auto& part) -> auto& { return part.layer; });
  column([](auto& part) -> auto& { return part.opacity; });
}

template <class Column>
void visit_knots(Column&& column) {
  column([](auto& knot) -> auto& { return knot.time; });
  column([](auto& knot) -> auto& { return knot.colour.x; });
  column([](auto& knot) -> auto& { return knot.colour.y; });
  column([](auto& knot) -> auto& { return knot.colour.z; });
}

template <class Element>
auto writer_of(ColumnWriter& out, const std::vector<Element>& elements) {
  return [&](const auto& field) {
    using Number = std::decay_t<decltype(field(elements[0]))>;
    out.column<Number>(elements.size(), [&](size_t i) { return field(elements[i]); });
  };
}

template <class Element>
auto reader_of(ColumnReader& in, std::vector<Element>& elements) {
  return [&](const auto& field) {
    using Number = std::decay_t<decltype(field(elements[0]))>;
    in.column<Number>(elements.size(), [&](size_t i, Number number) { field(elements[i]) = number; });
  };
}

void write_counts(ColumnWriter& out, const std::vector<uint32_t>& first) {
  out.column<uint32_t>(first.size() - 1, [&](size_t i) { return first[i + 1] - first[i]; });
}

bool is_time(float time) { return time >= 0 && time <= 1; }
bool is_finite(const Vec3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Could the ray's parts have been handed over? In order of time, disjoint but for layers, of knots that are there.
bool is_sound(const PixelRecord& record, const PixelRay& ray, size_t meshes) {
  if (ray.first_part > record.parts.size() || ray.parts > record.parts.size() - ray.first_part) return false;
  if (!std::isfinite(ray.film.x) || !std::isfinite(ray.film.y) || !std::isfinite(ray.weight) || !(ray.density > 0) ||
      !std::isfinite(ray.density) || !(ray.is_over_time() || is_time(ray.time)))
    return false;
  const SeenPart* before = nullptr;
  for (const SeenPart& part : record.parts_of(ray)) {
    const Segment& where = part.where;
    if (!is_time(where.begin) || !is_time(where.end) || !(where.begin <= where.end)) return false;
    if (std::isnan(where.dist_begin) || std::isnan(where.dist_end)) return false;
    if (where.mesh != kNoMesh && meshes > 0 && where.mesh >= meshes) return false;
    if (!(part.opacity >= 0 && part.opacity <= 1)) return false;
    const bool follows = before != nullptr && part.layer == before->layer + 1 && where.begin == before->where.begin &&
                         where.end == before->where.end;
    if (part.layer > 0 && !follows) return false;
    if (part.layer == 0 && before != nullptr && !(where.begin >= before->where.end)) return false;
    if (part.knots == 0 || part.first_knot > record.knots.size() || part.knots > record.knots.size() - part.first_knot)
      return false;
    float last = 0;
    for (const Knot& knot : record.knots_of(part)) {
      if (!is_time(knot.time) || !(knot.time >= last) || !is_finite(knot.colour)) return false;
      last = knot.time;
    }
    before = &part;
  }
  return true;
}

bool is_sound(const PixelRecord& record, size_t meshes) {
  if (!is_time(record.window.begin) || !is_time(record.window.end) || !is_finite(record.background) ||
      !std::isfinite(record.still.share) || record.still.own > record.still.rays.size())
    return false;
  for (const auto& rays : {record.rays, record.still.rays})
    for (const PixelRay& ray : rays)
      if (!is_sound(record, ray, meshes)) return false;
  return true;
}

}  // namespace

uint64_t raw_record_bytes(const TileCounts& counts) {
  return 4 * (kHeadWords * counts.pixels + kRayWords * counts.objects + kPartWords * counts.depth_pieces +
              kKnotWords * counts.pieces);
}

void write_records(ColumnWriter& out, const RecordTile& tile) {
  for (const auto* first : {&tile.first_ray, &tile.first_still, &tile.first_part, &tile.first_knot})
    write_counts(out, *first);
  visit_heads(writer_of(out, tile.heads));
  visit_rays(writer_of(out, tile.rays));
  visit_rays(writer_of(out, tile.still_rays));
  visit_parts(writer_of(out, tile.parts));
  out.column<uint32_t>(tile.parts.size(), [&](size_t i) { return tile.parts[i].where.front ? 1u : 0u; });
  visit_knots(writer_of(out, tile.knots));
}

RecordTile read_records(ColumnReader& in, const TileCounts& counts, size_t meshes) {
  RecordTile tile;
  // Rays and those of the still term are counted together.
  std::vector<uint32_t> rays(counts.pixels), still(counts.pixels);
  in.column<uint32_t>(counts.pixels, [&](size_t i, uint32_t count) { rays[i] = count; });
  in.column<uint32_t>(counts.pixels, [&](size_t i, uint32_t count) { still[i] = count; });
  const auto sum_up = [](const std::vector<uint32_t>& of_pixels, uint64_t most, std::vector<uint32_t>& first) {
    uint64_t so_far = 0;
    first = {0};
    for (const uint32_t count : of_pixels) {
      so_far += count;
      if (so_far > most) throw NoTile{"does not hold as much as its header says"};
      first.push_back(static_cast<uint32_t>(so_far));
    }
    return so_far;
  };
  const uint64_t over_time = sum_up(rays, counts.objects, tile.first_ray),
                 of_still = sum_up(still, counts.objects, tile.first_still);
  if (over_time + of_still != counts.objects) throw NoTile{"does not hold as much as its header says"};
  tile.first_part = read_counts(in, counts.pixels, counts.depth_pieces, 0);
  tile.first_knot = read_counts(in, counts.pixels, counts.pieces, 0);
  tile.heads.resize(counts.pixels);
  tile.rays.resize(over_time);
  tile.still_rays.resize(of_still);
  tile.parts.resize(counts.depth_pieces);
  tile.knots.resize(counts.pieces);
  visit_heads(reader_of(in, tile.heads));
  visit_rays(reader_of(in, tile.rays));
  visit_rays(reader_of(in, tile.still_rays));
  visit_parts(reader_of(in, tile.parts));
  in.column<uint32_t>(tile.parts.size(), [&](size_t i, uint32_t front) { tile.parts[i].where.front = front != 0; });
  visit_knots(reader_of(in, tile.knots));
  for (size_t pixel = 0; pixel < tile.pixels(); ++pixel)
    if (!is_sound(tile.record(pixel, 0, 0), meshes)) throw NoTile{"has rays that see what no ray sees"};
  return tile;
}

}  // namespace kairos
