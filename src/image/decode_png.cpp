// PNG, by libpng. Palettes and shades of grey become RGBA; 16 bits stay 16 bits.
#include <bit>
#include <csetjmp>
#include <cstring>
#include <new>

#include <png.h>

#include <kairos/error.h>

#include "image/picture_formats.h"

namespace kairos {

namespace {

/// The library's state. What fails inside of it jumps out: between a setjmp and the call that jumps, nothing that has a
/// destructor may come into being.
class PngReader {
 public:
  PngReader(std::span<const uint8_t> bytes, const std::string& place) : rest_(bytes), place_(place) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, png_const_charp) {});
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, this, on_read);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  PictureCost read_header() {
    if (!try_read_header()) fail_damaged(place_, message_);
    const auto width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    is_wide_ = png_get_bit_depth(png_, info_) == 16;
    // Surfaces look colours of 16 bits up as floats.
    const uint64_t size = is_wide_ ? sizeof(uint16_t) + sizeof(float) : sizeof(uint8_t);
    const PictureCost cost = plain_cost(width, height, kPictureChannels * size, place_);
    // Deflate makes no more than 1032 bytes of one.
    constexpr uint64_t kMostUnpacked = 1032;
    if (png_get_rowbytes(png_, info_) * height / kMostUnpacked > rest_.size())
      fail_damaged(place_, "too short for its size");
    return cost;
  }

  Pixels decode() {
    const PictureCost cost = read_header();
    Pixels pixels{cost.width, cost.height, {}, {}};
    const size_t row_values = static_cast<size_t>(cost.width) * kPictureChannels;
    const auto height = static_cast<size_t>(cost.height);
    uint8_t* first = nullptr;
    if (is_wide_) {
      pixels.wide_codes.resize(row_values * height);
      first = reinterpret_cast<uint8_t*>(pixels.wide_codes.data());
    } else {
      pixels.codes.resize(row_values * height);
      first = pixels.codes.data();
    }
    const size_t row_bytes = row_values * (is_wide_ ? sizeof(uint16_t) : sizeof(uint8_t));
    std::vector<uint8_t*> rows(height);
    for (size_t y = 0; y < height; ++y) rows[y] = first + y * row_bytes;
    if (!try_read_rows(rows.data(), row_bytes)) fail_damaged(place_, message_);
    return pixels;
  }

 private:
  static void on_error(png_structp png, png_const_charp message) {
    auto* const reader = static_cast<PngReader*>(png_get_error_ptr(png));
    std::strncpy(reader->message_, message, sizeof(reader->message_) - 1);
    png_longjmp(png, 1);
  }

  static void on_read(png_structp png, png_bytep out, size_t count) {
    auto* const reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader->rest_.size()) png_error(png, "cut short");
    std::memcpy(out, reader->rest_.data(), count);
    reader->rest_ = reader->rest_.subspan(count);
  }

  bool try_read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    constexpr png_uint_32 kMostSide = 1 << 30;  // plain_cost says what is too much
    png_set_user_limits(png_, kMostSide, kMostSide);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);  // colour profiles, texts, times
    png_read_info(png_, info_);
    return true;
  }

  bool try_read_rows(uint8_t** rows, size_t row_bytes) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    constexpr png_uint_32 kOpaque = 0xffff;  // of which 8-bit pictures take the lower half
    png_set_expand(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, kOpaque, PNG_FILLER_AFTER);
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != row_bytes) png_error(png_, "rows of another length than its header says");
    png_read_image(png_, rows);
    return true;
  }

  std::span<const uint8_t> rest_;
  const std::string& place_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  bool is_wide_ = false;
  char message_[96] = {};
};

bool is_png(std::span<const uint8_t> bytes) {
  constexpr size_t kSignature = 8;
  return bytes.size() >= kSignature && png_sig_cmp(bytes.data(), 0, kSignature) == 0;
}

PictureCost png_cost(std::span<const uint8_t> bytes, const std::string& place) {
  return PngReader(bytes, place).read_header();
}

Pixels decode_png(std::span<const uint8_t> bytes, const std::string& place) { return PngReader(bytes, place).decode(); }

}  // namespace

const PictureFormat kPng{is_png, png_cost, decode_png};

}  // namespace kairos
