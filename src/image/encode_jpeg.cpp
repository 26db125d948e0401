// JPEG, by libjpeg-turbo.
#include <cstdlib>
#include <memory>

#include <kairos/error.h>

#include "image/encode.h"
#include "image/jpeg_library.h"

namespace kairos {

namespace {

class JpegWriter {
 public:
  JpegWriter() { library_.err = errors_.install(); }
  ~JpegWriter() {
    jpeg_destroy_compress(&library_);
    std::free(bytes_);  // which the library allocated so
  }
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;

  bool try_write(const uint8_t* codes, int width, int height, int channels, int quality) {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_create_compress(&library_);
    jpeg_mem_dest(&library_, &bytes_, &size_);
    library_.image_width = static_cast<JDIMENSION>(width);
    library_.image_height = static_cast<JDIMENSION>(height);
    library_.input_components = channels;
    library_.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&library_);
    jpeg_set_quality(&library_, quality, TRUE);
    constexpr int kFullColour = 90;
    if (quality > kFullColour && channels == 3) {
      library_.comp_info[0].h_samp_factor = 1;
      library_.comp_info[0].v_samp_factor = 1;
    }
    jpeg_start_compress(&library_, TRUE);
    const size_t row_bytes = static_cast<size_t>(width) * static_cast<size_t>(channels);
    while (library_.next_scanline < library_.image_height) {
      JSAMPROW row = const_cast<uint8_t*>(codes) + library_.next_scanline * row_bytes;  // only read
      jpeg_write_scanlines(&library_, &row, 1);
    }
    jpeg_finish_compress(&library_);
    return true;
  }

  std::span<const uint8_t> bytes() const { return {bytes_, size_}; }
  const char* message() const { return errors_.message; }

 private:
  JpegErrors errors_;
  jpeg_compress_struct library_{};
  unsigned char* bytes_ = nullptr;
  unsigned long size_ = 0;
};

}  // namespace

std::vector<uint8_t> encode_jpeg(std::span<const uint8_t> codes, int width, int height, int channels, int quality,
                                 const std::string& place) {
  check_code_count(codes, width, height, channels, place);
  JpegWriter writer;
  if (!writer.try_write(codes.data(), width, height, channels, quality))
    throw Error(ErrorCode::io, place, std::string("cannot be encoded as JPEG: ") + writer.message());
  return {writer.bytes().begin(), writer.bytes().end()};
}

}  // namespace kairos
