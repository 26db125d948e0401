// What writers of flat and of deep OpenEXR files have in common.
#pragma once

#include <string>

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <kairos/image.h>

#include "base/atomic_file.h"
#include "image/exr_library.h"

namespace kairos {

class ExrStream : public Imf::OStream {
 public:
  ExrStream(AtomicFile& file, const std::string& path) : Imf::OStream(path.c_str()), file_(file) {}
  void write(const char data[], int size) override { file_.write(data, static_cast<size_t>(size)); }
  uint64_t tellp() override { return file_.tell(); }
  void seekp(uint64_t position) override { file_.seek(position); }

 private:
  AtomicFile& file_;
};

struct ExrAttributeWriter {
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

/// Windows and attributes, without channels.
inline Imf::Header exr_header(const Image& image, Imf::Compression compression) {
  const Imath::Box2i display({0, 0}, {image.frame_width - 1, image.frame_height - 1});
  const Imath::Box2i data({image.left, image.top}, {image.left + image.width - 1, image.top + image.height - 1});
  Imf::Header header(display, data, static_cast<float>(image.pixel_aspect), Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                     compression);
  for (const Attribute& attribute : image.attributes)
    std::visit(ExrAttributeWriter{header, attribute.name.c_str()}, attribute.value);
  return header;
}

}  // namespace kairos
