#include "output/exr.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <kairos/error.h>

#include "base/file.h"
#include "output/atomic_file.h"

namespace kairos {

namespace {

class OutputStream : public Imf::OStream {
 public:
  OutputStream(AtomicFile& file, const std::string& path) : Imf::OStream(path.c_str()), file_(file) {}
  void write(const char data[], int size) override { file_.write(data, static_cast<size_t>(size)); }
  uint64_t tellp() override { return file_.tell(); }
  void seekp(uint64_t position) override { file_.seek(position); }

 private:
  AtomicFile& file_;
};

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

struct AttributeWriter {
  Imf::Header& header;
  const char* name;

  void operator()(const std::string& v) const { header.insert(name, Imf::StringAttribute(v)); }
  void operator()(int v) const { header.insert(name, Imf::IntAttribute(v)); }
  void operator()(double v) const { header.insert(name, Imf::DoubleAttribute(v)); }
  void operator()(const std::array<double, 2>& v) const {
    header.insert(name, Imf::V2dAttribute(Imath::V2d(v[0], v[1])));
  }
  void operator()(const std::vector<std::string>& v) const { header.insert(name, Imf::StringVectorAttribute(v)); }
};

// A channel as the file holds it.
struct Plane {
  Imf::PixelType type;
  std::vector<char> bytes;
};

Plane encode(const Channel& channel, bool half_colours) {
  const auto convert = [&](Imf::PixelType type, auto example, auto&& cast) {
    using Value = decltype(example);
    Plane plane{type, std::vector<char>(channel.values.size() * sizeof(Value))};
    for (size_t i = 0; i < channel.values.size(); ++i) {
      const Value value = cast(channel.values[i]);
      std::memcpy(plane.bytes.data() + i * sizeof(Value), &value, sizeof(Value));
    }
    return plane;
  };
  if (channel.storage == Channel::Storage::integer)
    return convert(Imf::UINT, uint32_t{}, [](float v) { return static_cast<uint32_t>(v); });
  if (channel.storage == Channel::Storage::colour && half_colours) {
    const float most = HALF_MAX;  // a bright colour must not become infinite
    return convert(Imf::HALF, Imath::half{}, [&](float v) { return Imath::half(std::clamp(v, -most, most)); });
  }
  return convert(Imf::FLOAT, float{}, [](float v) { return v; });
}

// Imf wants to know where pixel (0, 0) of the full frame would be.
Imf::Slice slice(Imf::PixelType type, char* first, size_t value_size, const Imath::Box2i& window) {
  const size_t width = static_cast<size_t>(window.max.x - window.min.x) + 1;
  return Imf::Slice::Make(type, first, window, value_size, value_size * width);
}

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
}

// Exceptions of the library become ours: one line, with the file's name in front.
template <class Body>
auto translated(const std::string& path, ErrorCode code, const char* what, Body&& body) {
  try {
    return body();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    std::string why = e.what();
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw Error(code, path, std::string(what) + ": " + why);
  }
}

}  // namespace

void write_exr(const Image& image, const std::string& path, const WriteOptions& options) {
  translated(path, ErrorCode::io, "cannot be written as EXR", [&] {
    const Imath::Box2i display({0, 0}, {image.frame_width - 1, image.frame_height - 1});
    const Imath::Box2i data({image.left, image.top}, {image.left + image.width - 1, image.top + image.height - 1});
    Imf::Header header(display, data, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    for (const Attribute& attribute : image.attributes)
      std::visit(AttributeWriter{header, attribute.name.c_str()}, attribute.value);
    std::vector<Plane> planes;
    Imf::FrameBuffer buffer;
    for (const Channel& channel : image.channels) {
      planes.push_back(encode(channel, options.half));
      Plane& plane = planes.back();
      header.channels().insert(channel.name, Imf::Channel(plane.type));
      buffer.insert(channel.name,
                    slice(plane.type, plane.bytes.data(), plane.bytes.size() / channel.values.size(), data));
    }
    AtomicFile file(path);
    {
      OutputStream stream(file, path);
      Imf::OutputFile exr(stream, header, 0);
      exr.setFrameBuffer(buffer);
      exr.writePixels(image.height);
    }
    file.commit();
  });
}

Image read_exr(const std::string& path, uint64_t byte_limit) {
  const std::vector<uint8_t> bytes = read_file(path, byte_limit);
  return translated(path, ErrorCode::bad_input, "is not a readable EXR file", [&] {
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
      buffer.insert(channel.name, slice(Imf::FLOAT, reinterpret_cast<char*>(channel.values.data()), sizeof(float),
                                        header.dataWindow()));
    exr.setFrameBuffer(buffer);
    exr.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    return image;
  });
}

}  // namespace kairos
