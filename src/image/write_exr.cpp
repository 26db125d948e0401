#include "image/write_exr.h"

#include <algorithm>
#include <cstring>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>

#include <kairos/error.h>

#include "image/exr_output.h"

namespace kairos {

namespace {

// Between which the caller may stop: a few milliseconds of work for wide pictures.
constexpr int kRowsAtOnce = 64;

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
    Imf::Header header = exr_header(image, Imf::ZIP_COMPRESSION);
    const Imath::Box2i& data = header.dataWindow();
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
      ExrStream stream(file, path);
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
