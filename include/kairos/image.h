// Pictures: what rendering gives and what is written to files.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

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

  /// nullptr when there is none of that name.
  const Channel* find(const std::string& name) const;
};

struct WriteOptions {
  bool half = false;  ///< 16-bit colours in EXR
};

/// Writes EXR (all channels, attributes in the header, crop as data window) or PNG (colour alone, sRGB, 8 bit), as the
/// path's extension says, to a temporary file beside it that is renamed at the end: nobody sees half a file.
/// Throws Error(bad_usage) for another extension, Error(io) when writing fails.
void write_image(const Image& image, const std::string& path, const WriteOptions& options = {});

/// Throws what write_image would, as far as that is known before there is an image.
void check_writable_image(const std::string& path);

}  // namespace kairos
