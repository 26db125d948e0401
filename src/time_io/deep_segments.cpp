#include <vector>

#include <kairos/error.h>
#include <kairos/object_layers.h>

#include "time_io/deep_samples.h"

namespace kairos {

namespace {

/// What a ray sees of a triangle during the exposure.
struct SeenSegment {
  Vec3f colour;  ///< contribution to the pixel
  double coverage = 0;
  float depth = 0;
  uint32_t id = 0;
  float begin = 0, end = 0;  ///< parts of the recorded time
};

/// Collects what the pixels of a slab show under weights.
class SegmentCollector : public PixelConsumer {
 public:
  SegmentCollector(const TimeFrame& frame, const PixelWeights& weights, int slabs,
                   std::vector<std::vector<SeenSegment>>& out)
      : frame_(frame), weights_(weights), slabs_(slabs), out_(out) {}

  void begin_slab(int slab) { slab_ = slab; }
  RecordNeeds needs() const override { return {}; }

  void add(const PixelRecord& record) override {
    record_ = &record;
    weight_ = weights_.at(record.x, record.y);
    if (!(weight_.sum() > 0)) return;
    std::vector<SeenSegment>& seen =
        out_[static_cast<size_t>(record.y - frame_.top) * static_cast<size_t>(frame_.width) +
             static_cast<size_t>(record.x - frame_.left)];
    double rays = 0;
    for (const PixelRay& ray : record.rays) rays += static_cast<double>(ray.weight);
    for (const PixelRay& ray : record.rays) {
      double open = 1;  // of what lies behind the layers before
      for (const SeenPart& part : record.parts_of(ray)) {
        if (part.layer == 0) open = 1;
        const double passed = open * static_cast<double>(part.opacity);
        open -= passed;
        if (part.where.mesh != kNoMesh) add_part(ray, part, passed * static_cast<double>(ray.weight) / rays, seen);
      }
    }
  }

 private:
  double in_all(float time) const { return (slab_ + static_cast<double>(time)) / slabs_; }

  /// share: of the ray in the pixel, and of what is seen of the part.
  void add_part(const PixelRay& ray, const SeenPart& part, double share, std::vector<SeenSegment>& seen) const {
    // A ray of one instant stands for all of the time, of which there is a window.
    const bool over_time = ray.is_over_time();
    const float begin = over_time ? part.where.begin : record_->window.begin,
                end = over_time ? part.where.end : record_->window.end;
    SeenSegment segment;
    segment.coverage = share * weight_.integral(in_all(begin), in_all(end));
    if (!(segment.coverage > 0)) return;
    const auto points = weight_.points();
    const double from = std::max(in_all(begin), points.front().time), to = std::min(in_all(end), points.back().time);
    const auto distance_at = [&](double time) {
      const double length = in_all(end) - in_all(begin);
      const double place = over_time && length > 0 ? (time - in_all(begin)) / length : 0;
      return static_cast<float>(static_cast<double>(part.where.dist_begin) * (1 - place) +
                                static_cast<double>(part.where.dist_end) * place);
    };
    segment.depth = std::min(distance_at(from), distance_at(to));
    segment.begin = static_cast<float>(from);
    segment.end = static_cast<float>(to);
    segment.id = part.where.mesh + 1;
    segment.colour = to_float(colour_of(part, over_time, begin, end) * share);
    seen.push_back(segment);
  }

  /// The integral of the weight times the straight lines between the part's knots.
  Vec3d colour_of(const SeenPart& part, bool over_time, float begin, float end) const {
    const auto knots = record_->knots_of(part);
    const auto over = [&](float from, float to) { return weight_.integral(in_all(from), in_all(to)); };
    if (!over_time || knots.size() == 1) return to_double(knots[0].colour) * over(begin, end);
    const auto time_of = [&](const Knot& knot) { return std::clamp(knot.time, begin, end); };
    Vec3d sum = to_double(knots.front().colour) * over(begin, time_of(knots.front())) +
                to_double(knots.back().colour) * over(time_of(knots.back()), end);
    for (size_t i = 0; i + 1 < knots.size(); ++i) {
      const auto [before, after] = weight_.moments(in_all(time_of(knots[i])), in_all(time_of(knots[i + 1])));
      sum += to_double(knots[i].colour) * before + to_double(knots[i + 1].colour) * after;
    }
    return sum;
  }

  const TimeFrame& frame_;
  const PixelWeights& weights_;
  int slabs_, slab_ = 0;
  std::vector<std::vector<SeenSegment>>& out_;
  const PixelRecord* record_ = nullptr;
  TimeWeight weight_;
};

}  // namespace

DeepImage deep_segments(const Image& image, const TimeFile& file, const PixelWeights& weights,
                        const std::function<bool(double fraction)>& progress) {
  const TimeFrame& frame = file.picture().frame();
  DeepImage deep;
  deep.image = image;
  deep.image.channels.clear();
  for (const char* name : {"R", "G", "B", "A", "Z", "id", "time.begin", "time.end"})
    deep.image.channels.push_back(
        {name, *name == 'i' ? Channel::Storage::integer : Channel::Storage::exact, std::vector<float>()});
  std::vector<std::vector<SeenSegment>> seen(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
  const int slabs = file.info().slabs;
  SegmentCollector collector(frame, weights, slabs, seen);
  for (int slab = 0; slab < slabs; ++slab) {
    collector.begin_slab(slab);
    file.replay(collector, slab, [&](double fraction) { return !progress || progress((slab + fraction) / slabs); });
  }
  deep.first.push_back(0);
  for (size_t pixel = 0; pixel < seen.size(); ++pixel) {
    std::vector<SeenSegment>& segments = seen[pixel];
    std::stable_sort(segments.begin(), segments.end(),
                     [](const SeenSegment& a, const SeenSegment& b) { return a.depth < b.depth; });
    Vec3f rest{image.channels[0].values[pixel], image.channels[1].values[pixel], image.channels[2].values[pixel]};
    double covered = 0;
    for (const SeenSegment& segment : segments) {
      rest = rest - segment.colour;
      covered += segment.coverage;
    }
    constexpr double kRounding = 1e-4;  // of sums of coverages
    const bool background = !frame.alpha && 1 - covered > kRounding;
    if (!background) share_rest(segments, rest, covered);
    PixelSamples samples(deep);
    const auto add = [&](const SeenSegment& segment, double coverage) {
      if (!samples.add(segment.colour, coverage, segment.depth, segment.id)) return;
      deep.image.channels[6].values.push_back(segment.begin);
      deep.image.channels[7].values.push_back(segment.end);
    };
    for (const SeenSegment& segment : segments) add(segment, segment.coverage / std::max(1.0, covered));
    if (background) add({rest, 0, kBackgroundDistance, 0, 0, 1}, 1 - covered);
    deep.first.push_back(deep.image.channels[0].values.size());
    std::vector<SeenSegment>().swap(segments);
  }
  return deep;
}

}  // namespace kairos
