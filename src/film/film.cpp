#include "film/film.h"

#include <algorithm>

#include <kairos/error.h>

namespace kairos {

namespace {

struct ChannelNames {
  Channel::Storage storage;
  std::vector<const char*> names;
};

ChannelNames channels_of(Aov aov) {
  using Storage = Channel::Storage;
  switch (aov) {
    case Aov::depth:
      return {Storage::exact, {"depth.Z"}};
    case Aov::normal:
      return {Storage::colour, {"normal.X", "normal.Y", "normal.Z"}};
    case Aov::albedo:
      return {Storage::colour, {"albedo.R", "albedo.G", "albedo.B"}};
    case Aov::coverage:
      return {Storage::colour, {"coverage.A"}};
    case Aov::segments:
      return {Storage::colour, {"segments.Y"}};
    case Aov::mesh:
      return {Storage::integer, {"mesh.id"}};
  }
  return {};
}

}  // namespace

Film::Film(int frame_width, int frame_height, const Crop& crop, const std::vector<Aov>& aovs) : aovs_(aovs) {
  image_.width = crop.x1 - crop.x0;
  image_.height = crop.y1 - crop.y0;
  image_.left = crop.x0;
  image_.top = crop.y0;
  image_.frame_width = frame_width;
  image_.frame_height = frame_height;
  const size_t pixels = static_cast<size_t>(image_.width) * static_cast<size_t>(image_.height);
  const auto add = [&](const ChannelNames& channels) {
    for (const char* name : channels.names)
      image_.channels.push_back({name, channels.storage, std::vector<float>(pixels)});
  };
  add({Channel::Storage::colour, {"R", "G", "B"}});
  for (size_t i = 0; i < aovs.size(); ++i) {
    if (std::find(aovs.begin(), aovs.begin() + static_cast<ptrdiff_t>(i), aovs[i]) !=
        aovs.begin() + static_cast<ptrdiff_t>(i))
      throw Error(ErrorCode::bad_usage, "", "an AOV is asked for twice");
    add(channels_of(aovs[i]));
  }
}

void Film::set(int x, int y, const PixelSum& sum) {
  const size_t pixel =
      static_cast<size_t>(y - image_.top) * static_cast<size_t>(image_.width) + static_cast<size_t>(x - image_.left);
  size_t channel = 0;
  const auto put = [&](float value) { image_.channels[channel++].values[pixel] = value; };
  const auto put3 = [&](Vec3f value) {
    for (int i = 0; i < 3; ++i) put(value[i]);
  };
  put3(sum.colour());
  for (const Aov aov : aovs_) switch (aov) {
      case Aov::depth:
        put(sum.depth());
        break;
      case Aov::normal:
        put3(sum.normal());
        break;
      case Aov::albedo:
        put3(sum.albedo());
        break;
      case Aov::coverage:
        put(sum.coverage());
        break;
      case Aov::segments:
        put(sum.visibility_segments());
        break;
      case Aov::mesh:
        put(static_cast<float>(sum.mesh_id()));
        break;
    }
}

}  // namespace kairos
