#include "image/write_image.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/image.h>

#include "image/write_exr.h"
#include "image/write_png.h"

namespace kairos {

namespace {

enum class Format { exr, png };

Format format_of(const std::string& path) {
  if (has_extension(path, ".exr")) return Format::exr;
  if (has_extension(path, ".png")) return Format::png;
  throw Error(ErrorCode::bad_usage, path, "cannot tell the image format; end the name in .exr or .png");
}

}  // namespace

bool has_extension(const std::string& path, std::string_view extension) {
  std::string end = path.substr(path.size() - std::min(extension.size(), path.size()));
  for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return end == extension;
}

const Channel* Image::find(const std::string& name) const {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const Channel& channel) { return channel.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

void write_image(const Image& image, const std::string& path, const WriteOptions& options) {
  constexpr double kMostStops = 100;
  if (!(std::abs(options.exposure) <= kMostStops))
    throw Error(ErrorCode::bad_usage, path, "an exposure must be -100 to 100 stops");
  switch (format_of(path)) {
    case Format::exr:
      return write_exr(image, path, options);
    case Format::png:
      return write_png(image, path, options);
  }
}

void check_writable_image(const std::string& path) {
  format_of(path);
  check_writable(path);
}

}  // namespace kairos
