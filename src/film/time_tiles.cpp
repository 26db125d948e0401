#include "film/time_tiles.h"

#include <cmath>

#include <kairos/error.h>
#include <kairos/picture.h>

namespace kairos {

namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from, size_t begin, size_t end) {
  to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
            from.begin() + static_cast<std::ptrdiff_t>(end));
}

/// Appends a pixel of another tile.
void append_signal(TimeTile& to, const TimeTile& from, size_t pixel) {
  const size_t begin = from.first[pixel], end = from.first[pixel + 1];
  append(to.begin, from.begin, begin, end);
  if (from.exact()) {
    append(to.floats.left, from.floats.left, begin, end);
    append(to.floats.step, from.floats.step, begin, end);
  } else {
    append(to.halves.left, from.halves.left, begin, end);
    append(to.halves.step, from.halves.step, begin, end);
  }
  to.first.push_back(static_cast<uint32_t>(to.begin.size()));
}

void clear(TimeTile& tile) {
  tile.first.assign(1, 0);
  tile.begin.clear();
  tile.halves.left.clear();
  tile.halves.step.clear();
  tile.floats.left.clear();
  tile.floats.step.clear();
  tile.deviation = {};
}

void append_object(ObjectTile& to, const ObjectTile& from, size_t object) {
  to.mesh.push_back(from.mesh[object]);
  append_signal(to.signals, from.signals, object);
  const size_t begin = from.depth.first[object], end = from.depth.first[object + 1];
  append(to.depth.begin, from.depth.begin, begin, end);
  append(to.depth.left, from.depth.left, begin, end);
  append(to.depth.right, from.depth.right, begin, end);
  to.depth.first.push_back(static_cast<uint32_t>(to.depth.begin.size()));
}

void append_pixel(WholeTile& to, const WholeTile& from, size_t pixel) {
  append_signal(to.signals, from.signals, pixel);
  if (from.records.pixels() > 0) to.records.add(from.records.record(pixel, 0, 0));
  if (from.objects.empty()) return;
  for (size_t object = from.objects.first[pixel]; object < from.objects.first[pixel + 1]; ++object)
    append_object(to.objects, from.objects, object);
  to.objects.first.push_back(static_cast<uint32_t>(to.objects.mesh.size()));
}

/// Without pixels, and with room for what meshes contribute to them only where that is kept.
void clear(WholeTile& tile, bool objects) {
  clear(tile.signals);
  tile.records.clear();
  if (!objects) return;
  tile.objects.first.assign(1, 0);
  tile.objects.mesh.clear();
  clear(tile.objects.signals);
  tile.objects.depth.first.assign(1, 0);
  tile.objects.depth.begin.clear();
  tile.objects.depth.left.clear();
  tile.objects.depth.right.clear();
}

void join_deviation(WholeTile& to, const WholeTile& from) {
  to.signals.deviation.join(from.signals.deviation);
  to.objects.signals.deviation.join(from.objects.signals.deviation);
}

}  // namespace

/// A tile of which pixels are missing.
struct TileMaker::Open {
  std::mutex mutex;
  WholeTile pixels;              // in the order in which they came
  std::vector<uint32_t> places;  // [pixel of the tile]: where it is among them
  size_t missing = 0;
};

struct TileMaker::Workspace {
  explicit Workspace(double tolerance) : coder(tolerance), objects(tolerance) {}

  TimeSignal signal;
  TimeCoder coder;
  ObjectCoder objects;
  WholeTile pixel;  // a single one
};

TileMaker::TileMaker(TileGrid grid, int left, int top, double tolerance, bool objects, bool rays)
    : grid_(grid), left_(left), top_(top), tolerance_(tolerance), objects_(objects), rays_(rays), open_(grid.count()) {}
TileMaker::~TileMaker() = default;

std::optional<WholeTile> TileMaker::add(const PixelRecord& record, size_t& number) {
  const int x = record.x - left_, y = record.y - top_;
  number = grid_.tile_of(x, y);
  std::unique_ptr<Workspace> work;
  Open* open = nullptr;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (open_[number] == nullptr) {
      open_[number] = std::make_unique<Open>();
      open_[number]->missing = grid_.pixel_count(number);
      open_[number]->places.resize(grid_.pixel_count(number));
      clear(open_[number]->pixels, objects_);
    }
    open = open_[number].get();
    if (!idle_.empty()) {
      work = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (work == nullptr) work = std::make_unique<Workspace>(tolerance_);
  clear(work->pixel, objects_);
  const std::span<const SignalPiece> signal = work->signal.make(record);
  work->coder.add(signal, work->signal.shift(), work->pixel.signals);
  if (objects_) work->objects.add(record, work->pixel.objects);
  if (rays_) work->pixel.records.add(record);

  bool complete = false;
  {
    const std::lock_guard<std::mutex> lock(open->mutex);
    open->places[grid_.index(x, y)] = static_cast<uint32_t>(open->pixels.signals.pixels());
    append_pixel(open->pixels, work->pixel, 0);
    join_deviation(open->pixels, work->pixel);
    complete = --open->missing == 0;
  }
  std::unique_ptr<Open> closed;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(work));
    if (complete) closed = std::move(open_[number]);
  }
  if (closed == nullptr) return std::nullopt;
  WholeTile tile;
  clear(tile, objects_);
  join_deviation(tile, closed->pixels);
  for (const uint32_t place : closed->places) append_pixel(tile, closed->pixels, place);
  return tile;
}

void add_to(TimeQuality& quality, const TimeTile& tile) {
  quality.deviation = std::max(quality.deviation, static_cast<double>(tile.deviation.integral));
  quality.rounding = std::max(quality.rounding, static_cast<double>(tile.deviation.rounding));
  quality.clamped += tile.deviation.clamped;
  quality.pieces += tile.pieces();
  quality.missing -= std::min<uint64_t>(quality.missing, tile.pixels());
}

void check_tolerance(double tolerance) {
  if (tolerance != 0 && !(tolerance >= kLeastTolerance && tolerance <= 1))
    throw Error(ErrorCode::bad_usage, "", "the tolerance of a picture over time must be 0 (exact), or 2^-18 to 1");
}

RecordNeeds time_needs(const RenderParams& params) {
  const bool unlit = params.shading == ShadingKind::normal || params.shading == ShadingKind::flat;
  return {unlit ? RecordNeeds::Time::curves : RecordNeeds::Time::segments, false, false};
}

TimeFrame time_frame(const Shot& shot, const RenderParams& params, const FrameClock& clock, bool objects) {
  const Projection& projection = shot.projection;
  const Crop crop = params.crop.value_or(Crop{0, projection.width, 0, projection.height});
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 > projection.width || crop.y1 > projection.height || crop.x0 >= crop.x1 ||
      crop.y0 >= crop.y1)
    throw Error(ErrorCode::bad_usage, "", "the crop of a picture over time is empty or leaves the frame");
  if (params.integrator == IntegratorKind::qmc || params.shading == ShadingKind::bounds ||
      params.shading == ShadingKind::bounds_exact)
    throw Error(ErrorCode::bad_usage, "",
                "discrete rays and pictures of bounds know no time; for a picture over time use the integrator tc, "
                "mixed or auto with another shading");
  TimeFrame frame;
  frame.width = crop.x1 - crop.x0;
  frame.height = crop.y1 - crop.y0;
  frame.left = crop.x0;
  frame.top = crop.y0;
  frame.frame_width = projection.width;
  frame.frame_height = projection.height;
  frame.open = shot.shutter_open;
  frame.close = shot.shutter_close;
  frame.frame_time = clock.frame_time;
  frame.fps = clock.fps;
  if (!projection.matrix) frame.pixel_aspect = projection.pixel_aspect;
  frame.alpha = params.alpha;
  frame.view = usual_view(shot, params.shading);
  if (objects) {
    for (const Mesh& mesh : shot.meshes) frame.objects.push_back({mesh.name, mesh.material});
    for (const Material& material : shot.materials) frame.materials.push_back(material.name);
  }
  Image described;
  describe(described, shot, params, {});
  for (Attribute& attribute : described.attributes)
    if (attribute.name != "kairos:render_seconds") frame.attributes.push_back(std::move(attribute));
  return frame;
}

}  // namespace kairos
