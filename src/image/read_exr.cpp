#include "image/read_exr.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <OpenEXR/ImfVersion.h>

#include "base/file.h"
#include "image/exr_library.h"

namespace kairos {

namespace {

class InputStream : public Imf::IStream {
 public:
  InputStream(std::span<const uint8_t> bytes, const std::string& path) : Imf::IStream(path.c_str()), bytes_(bytes) {}
  bool read(char out[], int size) override {
    const auto count = static_cast<uint64_t>(size);
    if (position_ > bytes_.size() || count > bytes_.size() - position_) throw std::runtime_error("ends too early");
    std::memcpy(out, bytes_.data() + position_, count);
    position_ += count;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::span<const uint8_t> bytes_;
  uint64_t position_ = 0;
};

void read_attributes(const Imf::Header& header, Image& image) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    const Imf::Attribute& attribute = it.attribute();
    const auto put = [&](auto value) { image.attributes.push_back({it.name(), std::move(value)}); };
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) put(text->value());
    if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(&attribute)) put(number->value());
    if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) put(number->value());
    if (const auto* pair = dynamic_cast<const Imf::V2dAttribute*>(&attribute))
      put(std::array<double, 2>{pair->value().x, pair->value().y});
    if (const auto* list = dynamic_cast<const Imf::StringVectorAttribute*>(&attribute))
      put(std::vector<std::string>(list->value()));
  }
}

void read_windows(const Imf::Header& header, const std::string& path, uint64_t byte_limit, Image& image) {
  const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
  const auto extent = [](int low, int high) { return static_cast<int64_t>(high) - low + 1; };
  const int64_t width = extent(data.min.x, data.max.x), height = extent(data.min.y, data.max.y);
  const int64_t frame_width = extent(display.min.x, display.max.x), frame_height = extent(display.min.y, display.max.y);
  const int64_t left = static_cast<int64_t>(data.min.x) - display.min.x;
  const int64_t top = static_cast<int64_t>(data.min.y) - display.min.y;
  uint64_t channels = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    ++channels;
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      throw Error(ErrorCode::bad_input, path, "has subsampled channels, which are not supported");
  }
  constexpr int64_t kMost = std::numeric_limits<int>::max();
  if (width < 1 || height < 1 || frame_width < 1 || frame_height < 1 || width > kMost || height > kMost ||
      frame_width > kMost || frame_height > kMost || std::abs(left) > kMost || std::abs(top) > kMost)
    throw Error(ErrorCode::bad_input, path, "has an empty or an absurd data window");
  // width * height stays below 2^62.
  if (static_cast<uint64_t>(width) * static_cast<uint64_t>(height) >
      byte_limit / sizeof(float) / std::max<uint64_t>(1, channels))
    throw Error(ErrorCode::bad_input, path, "is larger than the limit of " + std::to_string(byte_limit) + " bytes");
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.left = static_cast<int>(left);
  image.top = static_cast<int>(top);
  image.frame_width = static_cast<int>(frame_width);
  image.frame_height = static_cast<int>(frame_height);
  const double aspect = static_cast<double>(header.pixelAspectRatio());
  if (aspect > 0 && std::isfinite(aspect)) image.pixel_aspect = aspect;
}

/// A file's headers, walked through by names and sizes alone: the library allocates what an attribute says it takes.
class HeaderWalk {
 public:
  HeaderWalk(std::span<const uint8_t> bytes, const std::string& place) : bytes_(bytes), place_(place) {}

  /// Past the magic number; the version with its flags.
  int version() {
    word();
    return static_cast<int>(word());
  }

  /// Past one header; false for an empty one, which ends those of a file with several parts.
  bool next() {
    constexpr int kMostAttributes = 10000;
    for (int i = 0;; ++i) {
      if (text().empty()) return i > 0;  // the attribute's name
      const std::string_view kind = text();
      const uint32_t size = word();
      if (i == kMostAttributes || size > bytes_.size() - position_ || !has_its_size(kind, size)) fail();
      const size_t end = position_ + size;
      if (kind == "chlist") pass_channels(end);
      position_ = end;
    }
  }

  size_t position() const { return position_; }

 private:
  [[noreturn]] void fail() const { throw Error(ErrorCode::bad_input, place_, "is no EXR file, or one cut short"); }

  uint32_t word() {
    if (bytes_.size() - position_ < sizeof(uint32_t)) fail();
    uint32_t value = 0;
    for (unsigned i = 0; i < sizeof(value); ++i) value |= uint32_t{bytes_[position_ + i]} << (8 * i);
    position_ += sizeof(value);
    return value;
  }

  /// The library reads as much of these as they always have, whatever the size that is given: what it took for the next
  /// attribute would be another than here.
  static bool has_its_size(std::string_view kind, uint32_t size) {
    constexpr std::pair<std::string_view, uint32_t> kSizes[] = {{"box2f", 16},
                                                                {"box2i", 16},
                                                                {"chromaticities", 32},
                                                                {"compression", 1},
                                                                {"deepImageState", 1},
                                                                {"double", 8},
                                                                {"envmap", 1},
                                                                {"float", 4},
                                                                {"int", 4},
                                                                {"keycode", 28},
                                                                {"lineOrder", 1},
                                                                {"m33d", 72},
                                                                {"m33f", 36},
                                                                {"m44d", 128},
                                                                {"m44f", 64},
                                                                {"rational", 8},
                                                                {"tiledesc", 9},
                                                                {"timecode", 8},
                                                                {"v2d", 16},
                                                                {"v2f", 8},
                                                                {"v2i", 8},
                                                                {"v3d", 24},
                                                                {"v3f", 12},
                                                                {"v3i", 12}};
    return std::all_of(std::begin(kSizes), std::end(kSizes),
                       [&](const auto& known) { return known.first != kind || known.second == size; });
  }

  /// Names, each with 16 bytes, and an empty one just before `end`.
  void pass_channels(size_t end) {
    constexpr size_t kChannel = 16;
    while (!text().empty()) {
      if (position_ > end || end - position_ < kChannel) fail();
      position_ += kChannel;
    }
    if (position_ != end) fail();
  }

  std::string_view text() {
    const auto* const begin = bytes_.data() + position_;
    const auto* const end = static_cast<const uint8_t*>(std::memchr(begin, 0, bytes_.size() - position_));
    if (end == nullptr) fail();
    position_ += static_cast<size_t>(end - begin) + 1;
    return {reinterpret_cast<const char*>(begin), static_cast<size_t>(end - begin)};
  }

  std::span<const uint8_t> bytes_;
  const std::string& place_;
  size_t position_ = 0;
};

/// Rows that are compressed together, at most.
uint64_t most_rows(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    default:
      return 256;
  }
}

/// Before it reads a pixel, the library makes a table of all chunks, and room for one of them uncompressed.
void check_chunks(const Imf::Header& header, const ExrSize& size, uint64_t file_bytes, const std::string& place) {
  const auto width = static_cast<uint64_t>(size.width), height = static_cast<uint64_t>(size.height);
  const auto refuse = [&](bool when) {
    if (when) throw Error(ErrorCode::bad_input, place, "is damaged (its header promises more than there is)");
  };
  constexpr uint64_t kTableEntry = 8, kMostOfAChunk = uint64_t{1} << 28;
  uint64_t chunks = 0, texels = 0;
  if (header.hasTileDescription()) {
    const uint64_t across = header.tileDescription().xSize, down = header.tileDescription().ySize;
    refuse(across == 0 || down == 0 || across > kMostOfAChunk || down > kMostOfAChunk);
    chunks = ((width + across - 1) / across) * ((height + down - 1) / down);
    texels = across * down;
  } else {
    const uint64_t rows = most_rows(header.compression());
    chunks = (height + rows - 1) / rows;
    texels = width * rows;
  }
  refuse(chunks > file_bytes / kTableEntry);
  refuse(texels > kMostOfAChunk / (sizeof(float) * std::max<uint64_t>(1, size.channels)));
}

}  // namespace

ExrSize exr_size(std::span<const uint8_t> bytes, const std::string& place) {
  HeaderWalk walk(bytes, place);
  const int version = walk.version();
  return translate_exr_errors(place, ErrorCode::bad_input, "is not a readable EXR file", [&] {
    InputStream stream(bytes, place);
    ExrSize first;
    for (int part = 0;; ++part) {
      const size_t begin = walk.position();
      if (!walk.next()) {
        if (part == 0) throw Error(ErrorCode::bad_input, place, "is an EXR file without a header");
        return first;
      }
      stream.seekg(begin);
      Imf::Header header;
      int its_version = version;
      header.readFrom(stream, its_version);
      Image image;
      constexpr uint64_t kAny = std::numeric_limits<uint64_t>::max();
      read_windows(header, place, kAny, image);
      ExrSize size{image.width, image.height, 0};
      for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++size.channels;
      check_chunks(header, size, bytes.size(), place);
      if (part == 0) first = size;
      if (!Imf::isMultiPart(version)) return first;
    }
  });
}

Image read_exr(const std::string& path, uint64_t byte_limit) {
  return read_exr(read_file(path, byte_limit), path, byte_limit);
}

Image read_exr(std::span<const uint8_t> bytes, const std::string& path, uint64_t byte_limit) {
  exr_size(bytes, path);
  return translate_exr_errors(path, ErrorCode::bad_input, "is not a readable EXR file", [&] {
    InputStream stream(bytes, path);
    Imf::InputFile exr(stream, 0);
    const Imf::Header& header = exr.header();
    Image image;
    read_windows(header, path, byte_limit, image);
    read_attributes(header, image);
    const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
      const auto storage = it.channel().type == Imf::UINT    ? Channel::Storage::integer
                           : it.channel().type == Imf::FLOAT ? Channel::Storage::exact
                                                             : Channel::Storage::colour;
      image.channels.push_back({it.name(), storage, std::vector<float>(pixels)});
    }
    Imf::FrameBuffer buffer;
    for (Channel& channel : image.channels)
      buffer.insert(channel.name, exr_slice(Imf::FLOAT, reinterpret_cast<char*>(channel.values.data()), sizeof(float),
                                            header.dataWindow()));
    exr.setFrameBuffer(buffer);
    exr.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    return image;
  });
}

}  // namespace kairos
