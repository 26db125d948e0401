#include <algorithm>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepImageStateAttribute.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfIDManifest.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <kairos/deep_image.h>

#include "image/exr_output.h"

namespace kairos {

namespace {

/// A channel's samples as the file holds them, and where those of each pixel begin.
struct DeepPlane {
  Imf::PixelType type = Imf::FLOAT;
  std::vector<uint32_t> whole;
  std::vector<float> real;
  std::vector<char*> pixels;
};

DeepPlane encode_samples(const Channel& channel, const std::vector<size_t>& first) {
  DeepPlane plane;
  char* samples = nullptr;
  if (channel.storage == Channel::Storage::integer) {
    plane.type = Imf::UINT;
    for (const float value : channel.values) plane.whole.push_back(static_cast<uint32_t>(value));
    samples = reinterpret_cast<char*>(plane.whole.data());
  } else {
    plane.real = channel.values;
    samples = reinterpret_cast<char*>(plane.real.data());
  }
  static_assert(sizeof(float) == 4);
  for (size_t pixel = 0; pixel + 1 < first.size(); ++pixel) plane.pixels.push_back(samples + 4 * first[pixel]);
  return plane;
}

Imf::IDManifest manifest_of(const std::vector<std::string>& names) {
  Imf::IDManifest manifest;
  auto& group = manifest.add("id");
  group.setComponents({"name"});
  group.setHashScheme(Imf::IDManifest::NOTHASHED);
  group.setEncodingScheme(Imf::IDManifest::ID_SCHEME);
  for (size_t id = 0; id < names.size(); ++id)
    if (!names[id].empty()) group.insert(id, names[id]);
  return manifest;
}

void check_samples(const DeepImage& deep) {
  const size_t pixels = static_cast<size_t>(deep.image.width) * static_cast<size_t>(deep.image.height);
  bool sound = deep.first.size() == pixels + 1 && std::is_sorted(deep.first.begin(), deep.first.end());
  for (const Channel& channel : deep.image.channels)
    sound = sound && deep.first.front() == 0 && channel.values.size() == deep.first.back();
  if (!sound || deep.image.find("Z") == nullptr)
    throw Error(ErrorCode::bad_usage, "", "a deep picture needs a channel Z, and samples for each of its pixels");
}

}  // namespace

void write_deep_image(const DeepImage& deep, const std::string& path, const std::function<bool()>& go_on) {
  if (!path.ends_with(".exr")) throw Error(ErrorCode::bad_usage, path, "deep pictures are EXR; give a name with .exr");
  check_samples(deep);
  translate_exr_errors(path, ErrorCode::io, "cannot be written as deep EXR", [&] {
    const Image& image = deep.image;
    Imf::Header header = exr_header(image, Imf::ZIPS_COMPRESSION);
    header.setType(Imf::DEEPSCANLINE);
    header.insert("deepImageState", Imf::DeepImageStateAttribute(Imf::DIS_TIDY));
    if (!deep.names.empty() && image.find("id") != nullptr)
      addIDManifest(header, Imf::CompressedIDManifest(manifest_of(deep.names)));
    const auto width = static_cast<size_t>(image.width);
    const auto origin = static_cast<std::ptrdiff_t>(image.top) * image.width + image.left;  // Imf asks for pixel (0, 0)
    std::vector<unsigned> counts;
    for (size_t pixel = 0; pixel + 1 < deep.first.size(); ++pixel)
      counts.push_back(static_cast<unsigned>(deep.first[pixel + 1] - deep.first[pixel]));
    std::vector<DeepPlane> planes;
    for (const Channel& channel : image.channels) {
      header.channels().insert(channel.name,
                               Imf::Channel(channel.storage == Channel::Storage::integer ? Imf::UINT : Imf::FLOAT));
      planes.push_back(encode_samples(channel, deep.first));
    }
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - origin),
                                             sizeof(unsigned), sizeof(unsigned) * width));
    for (size_t c = 0; c < planes.size(); ++c)
      buffer.insert(image.channels[c].name,
                    Imf::DeepSlice(planes[c].type, reinterpret_cast<char*>(planes[c].pixels.data() - origin),
                                   sizeof(char*), sizeof(char*) * width, 4));
    AtomicFile file(path);
    {
      ExrStream stream(file, path);
      Imf::DeepScanLineOutputFile exr(stream, header, 0);
      exr.setFrameBuffer(buffer);
      for (int row = 0; row < image.height; ++row) {
        if (go_on && !go_on()) throw Error(ErrorCode::cancelled, path, "is not written: stopped");
        exr.writePixels(1);
      }
    }
    file.commit();
  });
}

}  // namespace kairos
