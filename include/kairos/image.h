// Pictures: what rendering gives and what is written to files.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include <kairos/export.h>

namespace kairos {

/// One number per pixel, rows from the top: values[y * width + x].
struct Channel {
  enum class Storage {
    colour,   ///< float or half in EXR, as WriteOptions say
    exact,    ///< always float
    integer,  ///< whole numbers from 0 to 2^24
  };

  std::string name;  ///< as in EXR: "R", "depth.Z", ...
  Storage storage = Storage::colour;
  std::vector<float> values;
};

/// What a file's header says about a picture.
struct Attribute {
  std::string name;
  std::variant<std::string, int, double, std::array<double, 2>, std::vector<std::string>> value;
};

/// Colour "R", "G", "B": linear, scene-referred Rec. 709. Further channels as asked for: see Aov.
struct Image {
  int width = 0, height = 0;              ///< pixels held
  int left = 0, top = 0;                  ///< where they lie in the full frame
  int frame_width = 0, frame_height = 0;  ///< of the full frame
  std::vector<Channel> channels;
  std::vector<Attribute> attributes;
  double pixel_aspect = 1;  ///< a pixel's width over its height, where it is shown

  /// nullptr when there is none of that name.
  KAIROS_API const Channel* find(const std::string& name) const;
};

/// How the colours of a picture become those of a screen: docs/light.md.
enum class ViewTransform {
  standard,  ///< as they are, cut off at 1
  filmic,    ///< as they are up to a brightness, then along a shoulder that never reaches 1
};

struct WriteOptions {
  bool half = false;  ///< 16-bit colours in EXR
  // PNG alone: EXR holds what was rendered.
  ViewTransform view = ViewTransform::standard;
  double exposure = 0;  ///< colours are multiplied by two to this power before the view; -100 to 100
  /// Asked now and then while the file is written: false leaves nothing behind and throws Error(cancelled).
  std::function<bool()> go_on = {};
};

/// Writes EXR (all channels, attributes in the header, crop as data window) or PNG (colour alone, sRGB, 8 bit; with a
/// channel "A" of alpha, by which colours are divided, since PNG's are not premultiplied), as the path's extension
/// says, to a temporary file beside it that is renamed at the end: nobody sees half a file. Throws Error(bad_usage) for
/// another extension, Error(io) when writing fails.
KAIROS_API void write_image(const Image& image, const std::string& path, const WriteOptions& options = {});

/// Throws what write_image would, as far as that is known before there is an image.
KAIROS_API void check_writable_image(const std::string& path);

/// Reads EXR (all channels, and the attributes of the kinds that Attribute knows, in alphabetical order), or PNG, JPEG,
/// WebP, TGA and HDR (R, G and B as linear values, and A). Refuses what would need more than `byte_limit` bytes of
/// pixels. Throws Error(io) or Error(bad_input).
KAIROS_API Image read_image(const std::string& path, uint64_t byte_limit = uint64_t{1} << 32);

/// A picture for surfaces to show, in memory. Rows from the top, four values per pixel: red, green, blue, alpha. All
/// but one of the lists are empty.
struct Pixels {
  int width = 0, height = 0;
  std::vector<uint8_t> codes;             ///< 0 to 255, as formats of 8 bits hold them: usually sRGB
  std::vector<float> values;              ///< linear
  std::vector<uint16_t> wide_codes = {};  ///< 0 to 65535, as formats of 16 bits hold them: usually sRGB
};

}  // namespace kairos
