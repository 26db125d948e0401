// Columns of numbers, as bytes of a file that pack well.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace kairos {

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

  /// Several columns, of which the numbers of an element are put together: put(i, numbers). see(numbers): of a column,
  /// several at a time. Compilers make fast code of short loops over many numbers.
  template <class Number, size_t kColumns, class See, class Put>
  void columns(size_t count, const See& see, const Put& put) {
    using Bits = std::conditional_t<sizeof(Number) == 2, uint16_t, uint32_t>;
    static_assert(sizeof(Number) == sizeof(Bits));
    constexpr size_t kBlock = 256;
    std::array<std::array<Number, kBlock>, kColumns> block;
    for (size_t first = 0; first < count; first += kBlock) {
      const size_t size = std::min(kBlock, count - first);
      for (size_t c = 0; c < kColumns; ++c) {
        const uint8_t* const bytes = in_.data() + c * sizeof(Number) * count + first;
        for (size_t i = 0; i < size; ++i) {
          Bits bits = bytes[i];
          for (size_t b = 1; b < sizeof(Number); ++b)
            bits = static_cast<Bits>(bits | static_cast<Bits>(bytes[b * count + i]) << (8 * b));
          block[c][i] = std::bit_cast<Number>(bits);
        }
        see(std::span<const Number>(block[c]).first(size));
      }
      for (size_t i = 0; i < size; ++i) {
        std::array<Number, kColumns> numbers;
        for (size_t c = 0; c < kColumns; ++c) numbers[c] = block[c][i];
        put(first + i, numbers);
      }
    }
    in_ = in_.subspan(count * kColumns * sizeof(Number));
  }

 private:
  std::span<const uint8_t> in_;
};

/// Why bytes are no tile.
struct NoTile {
  const char* why;
};

/// `first` of so many things that are `sum` in all, each of which has `least` at least.
inline std::vector<uint32_t> read_counts(ColumnReader& in, uint64_t things, uint64_t sum, uint32_t least) {
  std::vector<uint32_t> first{0};
  first.reserve(things + 1);
  uint64_t so_far = 0;
  bool sound = true;
  in.column<uint32_t>(things, [&](size_t, uint32_t count) {
    sound &= count >= least;
    so_far += count;
    first.push_back(static_cast<uint32_t>(std::min(so_far, sum)));
  });
  if (!sound || so_far != sum) throw NoTile{"does not hold as much as its header says"};
  return first;
}

}  // namespace kairos
