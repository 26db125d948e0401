// PNG, by libpng.
#include <csetjmp>
#include <cstring>
#include <new>

#include <png.h>

#include <kairos/error.h>

#include "image/encode.h"

namespace kairos {

namespace {

/// The library's state. What fails inside of it jumps out: between a setjmp and the call that jumps, nothing that has a
/// destructor may come into being.
class PngWriter {
 public:
  PngWriter() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, png_const_charp) {});
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_write_struct(&png_, nullptr);
      throw std::bad_alloc();
    }
    png_set_write_fn(png_, this, on_write, [](png_structp) {});
  }
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  bool try_write(png_uint_32 width, png_uint_32 height, int bits, int kind, png_text* texts, int text_count,
                 uint8_t** rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_IHDR(png_, info_, width, height, bits, kind, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_text(png_, info_, texts, text_count);
    png_write_info(png_, info_);
    png_write_image(png_, rows);
    png_write_end(png_, nullptr);
    return true;
  }

  std::vector<uint8_t> take() {
    if (out_of_memory_) throw std::bad_alloc();
    return std::move(encoded_);
  }
  bool out_of_memory() const { return out_of_memory_; }
  const char* message() const { return message_; }

 private:
  static void on_error(png_structp png, png_const_charp message) {
    auto* const writer = static_cast<PngWriter*>(png_get_error_ptr(png));
    std::strncpy(writer->message_, message, sizeof(writer->message_) - 1);
    png_longjmp(png, 1);
  }

  static void on_write(png_structp png, png_bytep bytes, size_t count) {
    auto* const writer = static_cast<PngWriter*>(png_get_io_ptr(png));
    try {
      writer->encoded_.insert(writer->encoded_.end(), bytes, bytes + count);
    } catch (const std::bad_alloc&) {  // which must not pass through the library
      writer->out_of_memory_ = true;
    }
    if (writer->out_of_memory_) png_error(png, "out of memory");
  }

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::vector<uint8_t> encoded_;
  bool out_of_memory_ = false;
  char message_[96] = {};
};

int kind_of(int channels) {
  return channels == 1 ? PNG_COLOR_TYPE_GRAY : channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA;
}

/// rows: of `channels` codes of `bits` bits for each pixel; only read.
std::vector<uint8_t> encode(std::span<const uint8_t> bytes, int width, int height, int bits, int channels,
                            const std::string& place, const std::vector<PngText>& texts) {
  const size_t row_bytes = static_cast<size_t>(width) * static_cast<size_t>(channels) * static_cast<size_t>(bits / 8);
  std::vector<uint8_t*> rows(static_cast<size_t>(height));
  for (size_t y = 0; y < rows.size(); ++y) rows[y] = const_cast<uint8_t*>(bytes.data()) + y * row_bytes;
  std::vector<png_text> chunks(texts.size());
  for (size_t i = 0; i < texts.size(); ++i) {
    chunks[i].compression = PNG_TEXT_COMPRESSION_NONE;
    chunks[i].key = const_cast<char*>(texts[i].name.c_str());
    chunks[i].text = const_cast<char*>(texts[i].text.c_str());
    chunks[i].text_length = texts[i].text.size();
  }
  PngWriter writer;
  if (!writer.try_write(static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, kind_of(channels),
                        chunks.data(), static_cast<int>(chunks.size()), rows.data()) &&
      !writer.out_of_memory())
    throw Error(ErrorCode::io, place, std::string("cannot be encoded as PNG: ") + writer.message());
  return writer.take();
}

}  // namespace

std::vector<uint8_t> encode_png(std::span<const uint8_t> codes, int width, int height, int channels,
                                const std::string& place, const std::vector<PngText>& texts) {
  check_code_count(codes, width, height, channels, place);
  return encode(codes, width, height, 8, channels, place, texts);
}

std::vector<uint8_t> encode_png16(std::span<const uint8_t> codes, int width, int height, int channels,
                                  const std::string& place) {
  check_code_count(codes, width, height, 2 * channels, place);  // bytes of a pixel
  return encode(codes, width, height, 16, channels, place, {});
}

}  // namespace kairos
