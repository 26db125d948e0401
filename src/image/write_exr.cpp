#include "image/write_exr.h"

#include <algorithm>
#include <cstring>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <kairos/error.h>

#include "base/atomic_file.h"
#include "image/exr_library.h"

namespace kairos {

namespace {

// Between which the caller may stop: a few milliseconds of work for wide pictures.
constexpr int kRowsAtOnce = 64;

class OutputStream : public Imf::OStream {
 public:
  OutputStream(AtomicFile& file, const std::string& path) : Imf::OStream(path.c_str()), file_(file) {}
  void write(const char data[], int size) override { file_.write(data, static_cast<size_t>(size)); }
  uint64_t tellp() override { return file_.tell(); }
  void seekp(uint64_t position) override { file_.seek(position); }

 private:
  AtomicFile& file_;
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

}  // namespace

void write_exr(const Image& image, const std::string& path, const WriteOptions& options) {
  translate_exr_errors(path, ErrorCode::io, "cannot be written as EXR", [&] {
    const Imath::Box2i display({0, 0}, {image.frame_width - 1, image.frame_height - 1});
    const Imath::Box2i data({image.left, image.top}, {image.left + image.width - 1, image.top + image.height - 1});
    Imf::Header header(display, data, static_cast<float>(image.pixel_aspect), Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                       Imf::ZIP_COMPRESSION);
    for (const Attribute& attribute : image.attributes)
      std::visit(AttributeWriter{header, attribute.name.c_str()}, attribute.value);
    std::vector<Plane> planes;
    Imf::FrameBuffer buffer;
    for (const Channel& channel : image.channels) {
      planes.push_back(encode(channel, options.half));
      Plane& plane = planes.back();
      header.channels().insert(channel.name, Imf::Channel(plane.type));
      buffer.insert(channel.name,
                    exr_slice(plane.type, plane.bytes.data(), plane.bytes.size() / channel.values.size(), data));
    }
    AtomicFile file(path);
    {
      OutputStream stream(file, path);
      Imf::OutputFile exr(stream, header, 0);
      exr.setFrameBuffer(buffer);
      for (int row = 0; row < image.height; row += kRowsAtOnce) {
        if (options.go_on && !options.go_on()) throw Error(ErrorCode::cancelled, path, "is not written: stopped");
        exr.writePixels(std::min(kRowsAtOnce, image.height - row));
      }
    }
    file.commit();
  });
}

}  // namespace kairos
