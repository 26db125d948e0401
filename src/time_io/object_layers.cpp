#include <limits>

#include <kairos/error.h>
#include <kairos/object_layers.h>

#include "film/frame_image.h"
#include "time_io/deep_samples.h"

namespace kairos {

namespace {

std::vector<float>& add_channel(Image& image, const char* name, Channel::Storage storage) {
  return image.channels.emplace_back(Channel{name, storage, {}}).values;
}

}  // namespace

void add_depth(Image& image, const ExposedObjects& objects) {
  std::vector<float>& depth = add_channel(image, "depth.Z", Channel::Storage::exact);
  for (size_t pixel = 0; pixel + 1 < objects.first.size(); ++pixel) {
    float nearest = std::numeric_limits<float>::infinity();
    for (const SeenObject& object : objects.of(pixel)) nearest = std::min(nearest, object.depth);
    depth.push_back(nearest);
  }
}

void add_mesh_ids(Image& image, const ExposedObjects& objects) {
  std::vector<float>& ids = add_channel(image, "mesh.id", Channel::Storage::integer);
  for (size_t pixel = 0; pixel + 1 < objects.first.size(); ++pixel) {
    const SeenObject* most = nullptr;
    for (const SeenObject& object : objects.of(pixel))
      if (object.coverage > (most == nullptr ? 0 : most->coverage)) most = &object;
    ids.push_back(most == nullptr ? 0 : static_cast<float>(most->mesh + 1));
  }
}

DeepImage deep_objects(const Image& image, const ExposedObjects& objects, const TimeFrame& frame) {
  DeepImage deep;
  deep.image = image;
  deep.image.channels.clear();
  for (const char* name : {"R", "G", "B", "A", "Z"}) add_channel(deep.image, name, Channel::Storage::exact);
  add_channel(deep.image, "id", Channel::Storage::integer);
  deep.names.emplace_back(frame.alpha ? "" : "background");
  for (const TimeFrame::Object& object : frame.objects) deep.names.push_back(object.name);
  deep.first.push_back(0);
  std::vector<SeenObject> sorted;
  for (size_t pixel = 0; pixel + 1 < objects.first.size(); ++pixel) {
    sorted.clear();
    Vec3f rest{image.channels[0].values[pixel], image.channels[1].values[pixel], image.channels[2].values[pixel]};
    double covered = 0;
    for (const SeenObject& object : objects.of(pixel)) {
      if (!(object.coverage > 0)) continue;
      sorted.push_back(object);
      rest = rest - object.colour;
      covered += static_cast<double>(object.coverage);
    }
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const SeenObject& a, const SeenObject& b) { return a.depth < b.depth; });
    // Control variates and rounding may let objects cover a little more than all, or less.
    constexpr double kRounding = 1e-4;
    const bool background = !frame.alpha && 1 - covered > kRounding;
    if (!background) share_rest(sorted, rest, covered);
    PixelSamples samples(deep);
    for (const SeenObject& object : sorted)
      samples.add(object.colour, static_cast<double>(object.coverage) / std::max(1.0, covered), object.depth,
                  object.mesh + 1);
    if (background) samples.add(rest, 1 - covered, kBackgroundDistance, 0);
    deep.first.push_back(deep.image.channels[0].values.size());
  }
  return deep;
}

DeepImage deep_pieces(const TimePicture& picture, const std::function<bool(double fraction)>& progress) {
  const TimeFrame& frame = picture.frame();
  DeepImage deep;
  Image& image = deep.image;
  image = frame_image(frame);
  image.attributes.push_back({"kairos:shutter", std::array<double, 2>{frame.open, frame.close}});
  for (const char* name : {"R", "G", "B", "A", "end.R", "end.G", "end.B", "end.A", "Z", "ZBack"})
    add_channel(image, name, Channel::Storage::exact);
  deep.first.push_back(0);
  for (int y = 0; y < frame.height; ++y) {
    if (progress && !progress(static_cast<double>(y) / frame.height))
      throw Error(ErrorCode::cancelled, "", "reading pieces was stopped");
    for (int x = 0; x < frame.width; ++x) {
      for (const TimePiece& piece : picture.signal(frame.left + x, frame.top + y)) {
        for (size_t c = 0; c < 4; ++c) {
          image.channels[c].values.push_back(piece.left[c]);
          image.channels[4 + c].values.push_back(piece.right[c]);
        }
        image.channels[8].values.push_back(static_cast<float>(piece.begin));
        image.channels[9].values.push_back(static_cast<float>(piece.end));
      }
      deep.first.push_back(image.channels[0].values.size());
    }
  }
  return deep;
}

}  // namespace kairos
