// JPEG, by libjpeg-turbo: baseline and progressive; grey, colour and, as printers have it, four inks.
#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include <jerror.h>

#include <kairos/error.h>

#include "image/jpeg_library.h"
#include "image/picture_formats.h"

namespace kairos {

namespace {

constexpr uint8_t kMark = 0xff, kStartOfScan = 0xda, kEndOfImage = 0xd9;

/// How many scans there are, at most: each goes over all blocks of its components, however few bytes it has.
uint64_t count_scans(std::span<const uint8_t> bytes) {
  uint64_t scans = 0;
  for (size_t i = 0; i + 1 < bytes.size(); ++i)
    if (bytes[i] == kMark && bytes[i + 1] == kStartOfScan) ++scans;
  return scans;
}

class JpegReader {
 public:
  JpegReader(std::span<const uint8_t> bytes, const std::string& place) : bytes_(bytes), place_(place) {
    library_.err = errors_.install();
    errors_.manager.emit_message = on_message;
    if (!try_create()) throw std::bad_alloc();
    source_.init_source = [](j_decompress_ptr) {};
    source_.term_source = [](j_decompress_ptr) {};
    source_.resync_to_restart = jpeg_resync_to_restart;
    source_.fill_input_buffer = on_end;
    source_.skip_input_data = on_skip;
    source_.next_input_byte = bytes.data();
    source_.bytes_in_buffer = bytes.size();
    library_.src = &source_;
  }
  ~JpegReader() { jpeg_destroy_decompress(&library_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  PictureCost read_header() {
    if (!try_read_header()) fail_damaged(place_, errors_.message);
    PictureCost cost = plain_cost(library_.image_width, library_.image_height, kPictureChannels, place_);
    const uint64_t texels = cost.steps;
    uint64_t samples = 0;  // of all components, of which some may be coarser
    const jpeg_component_info* const components = library_.comp_info;
    for (int c = 0; c < library_.num_components; ++c)
      samples += texels * static_cast<uint64_t>(components[c].h_samp_factor * components[c].v_samp_factor) /
                 static_cast<uint64_t>(library_.max_h_samp_factor * library_.max_v_samp_factor);
    if (jpeg_has_multiple_scans(&library_) != 0) {
      most_scans_ = count_scans(bytes_);
      cost.bytes += samples * sizeof(JCOEF);  // which are kept until the last scan
      cost.steps += samples * most_scans_;
    }
    return cost;
  }

  Pixels decode() {
    const PictureCost cost = read_header();
    Pixels pixels{cost.width, cost.height, std::vector<uint8_t>(texel_count(cost) * kPictureChannels), {}};
    const bool inks = library_.jpeg_color_space == JCS_CMYK || library_.jpeg_color_space == JCS_YCCK;
    if (!try_decode(inks, pixels.codes.data())) fail_damaged(place_, errors_.message);
    if (errors_.damaged) fail_damaged(place_, "data that are missing or make no sense");
    if (inks) mix_inks(pixels.codes);
    return pixels;
  }

 private:
  static JpegReader& reader_of(j_decompress_ptr library) { return *static_cast<JpegReader*>(library->client_data); }

  static void on_message(j_common_ptr library, int level) {
    if (level >= 0) return;  // no warning
    const int code = library->err->msg_code;
    // Others, such as bytes too many between two parts, cost no pixels.
    if (code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE || code == JWRN_MUST_RESYNC || code == JWRN_JPEG_EOF)
      reinterpret_cast<JpegErrors*>(library->err)->damaged = true;
  }

  /// Behind the last byte stands an end mark: a file that lacks no more than that is whole.
  static boolean on_end(j_decompress_ptr library) {
    static constexpr JOCTET kEnd[2] = {kMark, kEndOfImage};
    library->src->next_input_byte = kEnd;
    library->src->bytes_in_buffer = sizeof(kEnd);
    return TRUE;
  }

  static void on_skip(j_decompress_ptr library, long count) {
    if (count <= 0) return;
    const size_t skipped = std::min(static_cast<size_t>(count), library->src->bytes_in_buffer);
    library->src->next_input_byte += skipped;
    library->src->bytes_in_buffer -= skipped;
  }

  /// What was counted is what the cost says; a reader that finds more scans than that has been misled.
  static void on_progress(j_common_ptr library) {
    auto* const decoder = reinterpret_cast<j_decompress_ptr>(library);
    if (static_cast<uint64_t>(decoder->input_scan_number) > reader_of(decoder).most_scans_)
      library->err->error_exit(library);
  }

  bool try_create() {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_create_decompress(&library_);
    library_.client_data = this;
    return true;
  }

  bool try_read_header() {
    if (setjmp(errors_.jump) != 0) return false;
    jpeg_read_header(&library_, TRUE);
    return true;
  }

  bool try_decode(bool inks, uint8_t* out) {
    if (setjmp(errors_.jump) != 0) return false;
    progress_.progress_monitor = on_progress;
    if (most_scans_ > 0) library_.progress = &progress_;
    library_.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_start_decompress(&library_);
    const size_t row_bytes = size_t{library_.output_width} * kPictureChannels;
    while (library_.output_scanline < library_.output_height) {
      JSAMPROW row = out + library_.output_scanline * row_bytes;
      jpeg_read_scanlines(&library_, &row, 1);
    }
    return true;
  }

  /// Light that is left of white behind cyan, magenta, yellow and black; Adobe's files hold what is left.
  void mix_inks(std::vector<uint8_t>& codes) const {
    constexpr unsigned kMost = 255;
    const bool left = library_.saw_Adobe_marker != 0;
    for (size_t i = 0; i < codes.size(); i += kPictureChannels) {
      const unsigned black = left ? codes[i + 3] : kMost - codes[i + 3];
      for (size_t c = i; c < i + 3; ++c)
        codes[c] = static_cast<uint8_t>(((left ? codes[c] : kMost - codes[c]) * black + kMost / 2) / kMost);
      codes[i + 3] = kMost;
    }
  }

  std::span<const uint8_t> bytes_;
  const std::string& place_;
  JpegErrors errors_;
  jpeg_decompress_struct library_{};
  jpeg_source_mgr source_{};
  jpeg_progress_mgr progress_{};
  uint64_t most_scans_ = 0;
};

bool is_jpeg(std::span<const uint8_t> bytes) {
  constexpr std::array<uint8_t, 3> kSignature{kMark, 0xd8, kMark};
  return bytes.size() >= kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), bytes.begin());
}

PictureCost jpeg_cost(std::span<const uint8_t> bytes, const std::string& place) {
  return JpegReader(bytes, place).read_header();
}

Pixels decode_jpeg(std::span<const uint8_t> bytes, const std::string& place) {
  return JpegReader(bytes, place).decode();
}

}  // namespace

const PictureFormat kJpeg{is_jpeg, jpeg_cost, decode_jpeg};

}  // namespace kairos
