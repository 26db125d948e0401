#include <algorithm>

#include <kairos/error.h>
#include <kairos/picture.h>

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

Picture::Picture(const Projection& frame, const RenderParams& params, TimeWeight weight)
    : alpha_(params.alpha), aovs_(params.aovs), weight_(std::move(weight)), exposure_(params.exposure) {
  if (exposure_ && !weight_.is_box())
    throw Error(ErrorCode::bad_usage, "", "a picture takes an exposure or a weight of time, not both");
  const Crop crop = params.crop.value_or(Crop{0, frame.width, 0, frame.height});
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 > frame.width || crop.y1 > frame.height || crop.x0 >= crop.x1 ||
      crop.y0 >= crop.y1)
    throw Error(ErrorCode::bad_usage, "", "a picture's crop is empty or leaves the frame");
  image_.width = crop.x1 - crop.x0;
  image_.height = crop.y1 - crop.y0;
  image_.left = crop.x0;
  image_.top = crop.y0;
  image_.frame_width = frame.width;
  image_.frame_height = frame.height;
  const size_t pixels = static_cast<size_t>(image_.width) * static_cast<size_t>(image_.height);
  const auto add = [&](const ChannelNames& channels) {
    for (const char* name : channels.names)
      image_.channels.push_back({name, channels.storage, std::vector<float>(pixels)});
  };
  add({Channel::Storage::colour, {"R", "G", "B"}});
  if (alpha_) add({Channel::Storage::colour, {"A"}});
  for (auto aov = aovs_.begin(); aov != aovs_.end(); ++aov) {
    if (std::find(aovs_.begin(), aov, *aov) != aov) throw Error(ErrorCode::bad_usage, "", "an AOV is asked for twice");
    add(channels_of(*aov));
  }
}

RecordNeeds Picture::needs() const {
  const auto shows = [&](Aov aov) { return std::find(aovs_.begin(), aovs_.end(), aov) != aovs_.end(); };
  const bool constant = weight_.is_box() && (!exposure_ || exposure_->shutter().curve.is_box());
  return {constant ? RecordNeeds::Time::box : RecordNeeds::Time::curves, shows(Aov::normal), shows(Aov::albedo)};
}

void Picture::add(const PixelRecord& record) {
  const bool count_meshes = std::find(aovs_.begin(), aovs_.end(), Aov::mesh) != aovs_.end();
  const PixelMeans means = reduce(record, exposure_ ? exposure_->weight(record.x, record.y) : weight_, count_meshes);
  const size_t pixel = static_cast<size_t>(record.y - image_.top) * static_cast<size_t>(image_.width) +
                       static_cast<size_t>(record.x - image_.left);
  size_t channel = 0;
  const auto put = [&](float value) { image_.channels[channel++].values[pixel] = value; };
  const auto put3 = [&](Vec3f value) {
    for (int i = 0; i < 3; ++i) put(value[i]);
  };
  put3(means.colour);
  if (alpha_) put(means.coverage);
  for (const Aov aov : aovs_) switch (aov) {
      case Aov::depth:
        put(means.depth);
        break;
      case Aov::normal:
        put3(means.normal);
        break;
      case Aov::albedo:
        put3(means.albedo);
        break;
      case Aov::coverage:
        put(means.coverage);
        break;
      case Aov::segments:
        put(means.visibility_segments);
        break;
      case Aov::mesh:
        put(static_cast<float>(means.mesh_id));
        break;
    }
}

Image Picture::take_shown() {
  if (exposure_ || !weight_.has_negative())
    for (Channel& channel : image_.channels)
      if (channel.name == "R" || channel.name == "G" || channel.name == "B")
        for (float& value : channel.values) value = std::max(value, 0.0f);
  return take();
}

ViewTransform usual_view(const Shot& shot, ShadingKind shading) {
  return is_lit(shading) && reflects_light(shot) ? ViewTransform::filmic : ViewTransform::standard;
}

}  // namespace kairos
