#include "image/read_exr.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include "base/file.h"
#include "image/exr_library.h"

namespace kairos {

namespace {

class InputStream : public Imf::IStream {
 public:
  InputStream(const std::vector<uint8_t>& bytes, const std::string& path) : Imf::IStream(path.c_str()), bytes_(bytes) {}
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
  const std::vector<uint8_t>& bytes_;
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

}  // namespace

Image read_exr(const std::string& path, uint64_t byte_limit) {
  const std::vector<uint8_t> bytes = read_file(path, byte_limit);
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
