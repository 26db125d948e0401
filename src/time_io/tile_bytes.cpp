#include "time_io/tile_bytes.h"

#include <cmath>
#include <limits>

#include <zstd.h>

#include <kairos/error.h>

#include "film/half.h"
#include "time_io/columns.h"
#include "time_io/record_bytes.h"

namespace kairos {

namespace {

constexpr int kLevel = 3;  // of zstd: higher ones take longer than they save

template <class Number>
void write_values(ColumnWriter& out, const PieceValues<Number>& values) {
  for (const auto* ends : {&values.left, &values.step})
    for (size_t c = 0; c < 4; ++c) out.column<Number>(ends->size(), [&](size_t i) { return (*ends)[i][c]; });
}

bool is_number(uint16_t half) { return is_finite_half(half); }
bool is_number(float value) { return std::isfinite(value); }

/// Returns whether all of them are finite.
template <class Number>
bool read_values(ColumnReader& in, size_t count, PieceValues<Number>& values) {
  bool finite = true;
  for (auto* ends : {&values.left, &values.step}) {
    ends->resize(count);
    in.columns<Number, 4>(
        count,
        [&](std::span<const Number> numbers) {
          unsigned bad = 0;
          for (const Number number : numbers) bad |= is_number(number) ? 0u : 1u;
          finite &= bad == 0;
        },
        [&](size_t i, const Four<Number>& four) { (*ends)[i] = four; });
  }
  return finite;
}

/// How many pieces each function has, and when they begin.
void write_times(ColumnWriter& out, const std::vector<uint32_t>& first, const std::vector<uint32_t>& begin) {
  out.column<uint32_t>(first.size() - 1, [&](size_t i) { return first[i + 1] - first[i]; });
  out.column<uint32_t>(begin.size(), [&](size_t i) { return begin[i]; });
}

void write_signals(ColumnWriter& out, const TimeTile& tile) {
  write_times(out, tile.first, tile.begin);
  if (tile.exact())
    write_values(out, tile.floats);
  else
    write_values(out, tile.halves);
}

void read_times(ColumnReader& in, uint64_t functions, uint64_t pieces, std::vector<uint32_t>& first,
                std::vector<uint32_t>& begin) {
  first = read_counts(in, functions, pieces, 1);
  begin.resize(pieces);
  in.column<uint32_t>(pieces, [&](size_t i, uint32_t tick) { begin[i] = tick; });
  bool sound = true;
  for (size_t function = 0; function < functions; ++function) {
    sound &= begin[first[function]] == 0;
    for (size_t i = first[function] + 1; i < first[function + 1]; ++i) sound &= begin[i] > begin[i - 1];
  }
  if (!sound) throw NoTile{"its times do not ascend from 0"};
}

TimeTile read_signals(ColumnReader& in, uint64_t signals, uint64_t pieces, bool exact) {
  TimeTile tile;
  read_times(in, signals, pieces, tile.first, tile.begin);
  const bool finite = exact ? read_values(in, pieces, tile.floats) : read_values(in, pieces, tile.halves);
  if (!finite) throw NoTile{"has values that are not finite"};
  return tile;
}

/// Which meshes each pixel has.
void read_meshes(ColumnReader& in, const TileCounts& counts, size_t meshes, ObjectTile& tile) {
  tile.first = read_counts(in, counts.pixels, counts.objects, 0);
  tile.mesh.resize(counts.objects);
  bool sound = true;
  in.column<uint32_t>(counts.objects, [&](size_t i, uint32_t mesh) {
    tile.mesh[i] = mesh;
    sound &= mesh < meshes;
  });
  for (size_t pixel = 0; pixel < counts.pixels; ++pixel)
    for (size_t i = tile.first[pixel] + 1; i < tile.first[pixel + 1]; ++i) sound &= tile.mesh[i] > tile.mesh[i - 1];
  if (!sound) throw NoTile{"names meshes that its file does not know"};
}

void read_depths(ColumnReader& in, const TileCounts& counts, DepthPieces& depth) {
  read_times(in, counts.objects, counts.depth_pieces, depth.first, depth.begin);
  for (auto* ends : {&depth.left, &depth.right}) {
    ends->resize(counts.depth_pieces);
    in.column<float>(counts.depth_pieces, [&](size_t i, float value) { (*ends)[i] = value; });
  }
  constexpr float kNothing = std::numeric_limits<float>::infinity();
  for (size_t i = 0; i < counts.depth_pieces; ++i) {
    const float left = depth.left[i], right = depth.right[i];
    if (!(std::isfinite(left) && std::isfinite(right)) && !(left == kNothing && right == kNothing))
      throw NoTile{"has distances that are none"};
  }
}

}  // namespace

uint64_t raw_tile_bytes(const TileCounts& counts, TimePlane plane) {
  if (plane == TimePlane::geometry) return counts.pieces;
  if (plane == TimePlane::rays) return raw_record_bytes(counts);
  const uint64_t of_value = is_exact(plane) ? 4 : 2;
  const uint64_t of_pieces = counts.pieces * (4 + 8 * of_value);
  if (!holds_objects(plane)) return 4 * counts.pixels + of_pieces;
  return 4 * counts.pixels + 12 * counts.objects + of_pieces + 12 * counts.depth_pieces;
}

struct TilePacker::Contexts {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> packing{ZSTD_createCCtx(), ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> unpacking{ZSTD_createDCtx(), ZSTD_freeDCtx};
};

TilePacker::TilePacker() : contexts_(std::make_unique<Contexts>()) {
  if (contexts_->packing == nullptr || contexts_->unpacking == nullptr) throw std::bad_alloc();
}
TilePacker::~TilePacker() = default;

std::span<const uint8_t> TilePacker::pack_raw() {
  packed_.resize(ZSTD_compressBound(raw_.size()));
  const size_t size =
      ZSTD_compressCCtx(contexts_->packing.get(), packed_.data(), packed_.size(), raw_.data(), raw_.size(), kLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // there is room enough, so no memory is all that it can lack
  return std::span(packed_).first(size);
}

std::span<const uint8_t> TilePacker::pack(const TimeTile& tile) {
  ColumnWriter out(raw_);
  write_signals(out, tile);
  return pack_raw();
}

std::span<const uint8_t> TilePacker::pack(const ObjectTile& tile) {
  ColumnWriter out(raw_);
  out.column<uint32_t>(tile.pixels(), [&](size_t i) { return tile.first[i + 1] - tile.first[i]; });
  out.column<uint32_t>(tile.mesh.size(), [&](size_t i) { return tile.mesh[i]; });
  write_signals(out, tile.signals);
  write_times(out, tile.depth.first, tile.depth.begin);
  for (const auto* ends : {&tile.depth.left, &tile.depth.right})
    out.column<float>(ends->size(), [&](size_t i) { return (*ends)[i]; });
  return pack_raw();
}

std::span<const uint8_t> TilePacker::pack(const RecordTile& tile) {
  ColumnWriter out(raw_);
  write_records(out, tile);
  return pack_raw();
}

std::span<const uint8_t> TilePacker::pack(std::span<const uint8_t> slice) {
  raw_.assign(slice.begin(), slice.end());
  return pack_raw();
}

std::span<const uint8_t> TilePacker::unpack_slice(std::span<const uint8_t> packed, uint64_t size,
                                                  const std::string& place) {
  unpack_raw(packed, size, place);
  return raw_;
}

void TilePacker::unpack_raw(std::span<const uint8_t> packed, uint64_t size, const std::string& place) {
  raw_.resize(size);
  const size_t got =
      ZSTD_decompressDCtx(contexts_->unpacking.get(), raw_.data(), raw_.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) != 0 || got != raw_.size())
    throw Error(ErrorCode::bad_input, place, "does not unpack to what its header says");
}

TimeTile TilePacker::unpack(std::span<const uint8_t> packed, const TileCounts& counts, TimePlane plane,
                            const std::string& place) {
  unpack_raw(packed, raw_tile_bytes(counts, plane), place);
  ColumnReader in(raw_);
  try {
    return read_signals(in, counts.pixels, counts.pieces, is_exact(plane));
  } catch (const NoTile& fault) {
    throw Error(ErrorCode::bad_input, place, fault.why);
  }
}

RecordTile TilePacker::unpack_records(std::span<const uint8_t> packed, const TileCounts& counts, size_t meshes,
                                      const std::string& place) {
  unpack_raw(packed, raw_tile_bytes(counts, TimePlane::rays), place);
  ColumnReader in(raw_);
  try {
    return read_records(in, counts, meshes);
  } catch (const NoTile& fault) {
    throw Error(ErrorCode::bad_input, place, fault.why);
  }
}

ObjectTile TilePacker::unpack_objects(std::span<const uint8_t> packed, const TileCounts& counts, TimePlane plane,
                                      size_t meshes, const std::string& place) {
  unpack_raw(packed, raw_tile_bytes(counts, plane), place);
  ColumnReader in(raw_);
  try {
    ObjectTile tile;
    read_meshes(in, counts, meshes, tile);
    tile.signals = read_signals(in, counts.objects, counts.pieces, is_exact(plane));
    read_depths(in, counts, tile.depth);
    return tile;
  } catch (const NoTile& fault) {
    throw Error(ErrorCode::bad_input, place, fault.why);
  }
}

}  // namespace kairos
