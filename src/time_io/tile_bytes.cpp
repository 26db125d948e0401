#include "time_io/tile_bytes.h"

#include <bit>
#include <cmath>
#include <cstring>

#include <zstd.h>

#include <kairos/error.h>

#include "film/half.h"

namespace kairos {

namespace {

constexpr int kLevel = 3;  // of zstd: higher ones take longer than they save

static_assert(std::endian::native == std::endian::little, "numbers of the file are written as they lie in memory");

/// A column is split by bytes: all lowest ones, then all second ones, and so on. Bytes of one significance are alike.
class ColumnWriter {
 public:
  explicit ColumnWriter(std::vector<uint8_t>& out) : out_(out) { out_.clear(); }

  template <class Number, class At>
  void column(size_t count, const At& at) {
    const size_t start = out_.size();
    out_.resize(start + count * sizeof(Number));
    for (size_t i = 0; i < count; ++i) {
      const Number number = at(i);
      uint8_t bytes[sizeof(Number)];
      std::memcpy(bytes, &number, sizeof bytes);
      for (size_t b = 0; b < sizeof bytes; ++b) out_[start + b * count + i] = bytes[b];
    }
  }

 private:
  std::vector<uint8_t>& out_;
};

class ColumnReader {
 public:
  explicit ColumnReader(std::span<const uint8_t> in) : in_(in) {}

  template <class Number, class Put>
  void column(size_t count, const Put& put) {
    for (size_t i = 0; i < count; ++i) {
      uint8_t bytes[sizeof(Number)];
      for (size_t b = 0; b < sizeof bytes; ++b) bytes[b] = in_[b * count + i];
      Number number;
      std::memcpy(&number, bytes, sizeof bytes);
      put(i, number);
    }
    in_ = in_.subspan(count * sizeof(Number));
  }

 private:
  std::span<const uint8_t> in_;
};

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
    for (size_t c = 0; c < 4; ++c)
      in.column<Number>(count, [&](size_t i, Number number) {
        (*ends)[i][c] = number;
        finite &= is_number(number);
      });
  }
  return finite;
}

}  // namespace

uint64_t raw_tile_bytes(uint64_t pixels, uint64_t pieces, TimePlane plane) {
  const uint64_t of_value = plane == TimePlane::colour ? 2 : 4;
  return 4 * pixels + pieces * (4 + 8 * of_value);
}

struct TilePacker::Contexts {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> packing{ZSTD_createCCtx(), ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> unpacking{ZSTD_createDCtx(), ZSTD_freeDCtx};
};

TilePacker::TilePacker() : contexts_(std::make_unique<Contexts>()) {
  if (contexts_->packing == nullptr || contexts_->unpacking == nullptr) throw std::bad_alloc();
}
TilePacker::~TilePacker() = default;

std::span<const uint8_t> TilePacker::pack(const TimeTile& tile) {
  ColumnWriter out(raw_);
  out.column<uint32_t>(tile.pixels(), [&](size_t i) { return tile.first[i + 1] - tile.first[i]; });
  out.column<uint32_t>(tile.pieces(), [&](size_t i) { return tile.begin[i]; });
  if (tile.exact())
    write_values(out, tile.floats);
  else
    write_values(out, tile.halves);
  packed_.resize(ZSTD_compressBound(raw_.size()));
  const size_t size =
      ZSTD_compressCCtx(contexts_->packing.get(), packed_.data(), packed_.size(), raw_.data(), raw_.size(), kLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // there is room enough, so no memory is all that it can lack
  return std::span(packed_).first(size);
}

TimeTile TilePacker::unpack(std::span<const uint8_t> packed, uint64_t pixels, uint64_t pieces, TimePlane plane,
                            const std::string& place) {
  const auto refuse = [&](const char* what) { throw Error(ErrorCode::bad_input, place, what); };
  raw_.resize(raw_tile_bytes(pixels, pieces, plane));
  const size_t size =
      ZSTD_decompressDCtx(contexts_->unpacking.get(), raw_.data(), raw_.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) != 0 || size != raw_.size()) refuse("does not unpack to what its header says");
  ColumnReader in(raw_);
  TimeTile tile;
  tile.first.assign(1, 0);
  uint64_t sum = 0;
  bool sound = true;
  in.column<uint32_t>(pixels, [&](size_t, uint32_t count) {
    sound &= count > 0;
    sum += count;
    tile.first.push_back(static_cast<uint32_t>(std::min(sum, pieces)));
  });
  if (!sound || sum != pieces) refuse("its pixels have not as many pieces as its header says");
  tile.begin.resize(pieces);
  in.column<uint32_t>(pieces, [&](size_t i, uint32_t begin) { tile.begin[i] = begin; });
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    sound &= tile.begin[tile.first[pixel]] == 0;
    for (size_t i = tile.first[pixel] + 1; i < tile.first[pixel + 1]; ++i) sound &= tile.begin[i] > tile.begin[i - 1];
  }
  if (!sound) refuse("its times do not ascend from 0");
  const bool finite =
      plane == TimePlane::colour ? read_values(in, pieces, tile.halves) : read_values(in, pieces, tile.floats);
  if (!finite) refuse("has values that are not finite");
  return tile;
}

}  // namespace kairos
