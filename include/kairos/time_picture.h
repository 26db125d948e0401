// Pictures that hold every instant of the shutter's time: exposed after they were rendered. docs/time.md.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/image.h>
#include <kairos/record.h>
#include <kairos/render.h>
#include <kairos/shutter.h>
#include <kairos/time_weight.h>

namespace kairos {

/// What a pixel shows over a stretch of shutter time: red, green, blue and coverage, from `left` to `right` on straight
/// lines. Linear, scene-referred.
struct TimePiece {
  double begin = 0, end = 1;
  std::array<float, 4> left{}, right{};
};

/// How much is kept, and how well.
struct TimeQuality {
  /// How far the integral of a channel from 0 to any instant may be off, in units of shutter time times max(1, mean of
  /// the channel): 2^-18 to 1, or 0 (exact). An exposure with the weight w of integral 1 is off by at most tolerance
  /// times the sum of all rises and falls of w, and what rounding adds. For a box of length L that sum is 2/L.
  double tolerance = 0x1p-14;
  // Known when all pixels are there; in the same units.
  double deviation = 0;  ///< the largest one: at most the tolerance
  double rounding = 0;   ///< of values to 16 bits: the largest
  uint64_t clamped = 0;  ///< values that were too large for 16 bits
  uint64_t pieces = 0;   ///< in all pixels
  uint64_t missing = 0;  ///< pixels that were not rendered

  bool exact() const { return tolerance == 0; }
};

/// What a picture over time is of.
struct TimeFrame {
  int width = 0, height = 0;              ///< pixels held
  int left = 0, top = 0;                  ///< where they lie in the full frame
  int frame_width = 0, frame_height = 0;  ///< of the full frame
  double open = 0, close = 1;             ///< scene time: of shutter times 0 and 1
  double frame_time = 0;                  ///< scene time from which a shutter's times are counted
  double fps = 24;                        ///< frames per unit of scene time
  double pixel_aspect = 1;
  bool alpha = false;                            ///< is coverage the colours' alpha? RenderParams::alpha
  ViewTransform view = ViewTransform::standard;  ///< in which a screen shows it best
  std::vector<Attribute> attributes;             ///< how it was made
  struct Object {
    std::string name;
    uint32_t material = 0;  ///< index
  };
  std::vector<Object> objects;         ///< [mesh], where what each contributes is kept
  std::vector<std::string> materials;  ///< the same: names
};

/// The weight of a pixel, in shutter time, and whether all pixels of a row or a column have the same one.
struct PixelWeights {
  std::function<TimeWeight(int x, int y)> at;  ///< x, y: in the full frame
  bool varies_in_x = false, varies_in_y = false;
};
/// Those of an exposure over the shot that the picture is of, or over its time.
KAIROS_API PixelWeights pixel_weights(const Exposure& exposure);

struct ExposeOptions {
  bool coverage = false;                               ///< the channel "coverage.A", too
  int threads = 0;                                     ///< 0: as many as the machine has; no effect on the picture
  std::function<bool(double fraction)> progress = {};  ///< as render's
};

class TimeTiles;

/// A mesh that an exposure shows in a pixel.
struct SeenObject {
  uint32_t mesh = 0;   ///< TimeFrame::objects
  Vec3f colour;        ///< what it contributes to the pixel's colour: premultiplied
  float coverage = 0;  ///< how much of the pixel and the exposure it fills
  float depth = 0;     ///< the nearest distance along the view axis at which the exposure sees it
};

/// All meshes that an exposure shows.
struct ExposedObjects {
  std::vector<size_t> first;     ///< [pixel], rows from the top, and the end of the last one: of its objects
  std::vector<SeenObject> seen;  ///< ascending meshes within a pixel

  std::span<const SeenObject> of(size_t pixel) const {
    return std::span(seen).subspan(first[pixel], first[pixel + 1] - first[pixel]);
  }
};

/// Immutable; copies share what they hold. May be used from any number of threads.
class KAIROS_API TimePicture {
 public:
  TimePicture(TimeFrame frame, std::shared_ptr<TimeTiles> tiles);
  ~TimePicture();
  TimePicture(const TimePicture&);
  TimePicture(TimePicture&&) noexcept;
  TimePicture& operator=(const TimePicture&);
  TimePicture& operator=(TimePicture&&) noexcept;

  const TimeFrame& frame() const;
  TimeQuality quality() const;

  /// The integral of what every pixel shows times its weight: closed forms, no samples. Channels R, G and B, and A
  /// where TimeFrame says alpha. Pixels that were not rendered are black. Throws what reading a file does;
  /// Error(cancelled) when `progress` says so.
  Image expose(const PixelWeights& weights, const ExposeOptions& options = {}) const;
  Image expose(const TimeWeight& weight = {}, const ExposeOptions& options = {}) const;

  /// What is seen at a shutter time, 0 to 1. The quality bounds what any exposure is off by, not this: only exact
  /// pictures are exact at an instant.
  Image at(double time, const ExposeOptions& options = {}) const;

  /// Is it kept what each mesh contributes?
  bool has_objects() const;
  /// Every pixel's meshes under its weight: integrals in closed form, like the picture's, and within the same bound.
  /// Colours and coverages of a pixel add to the picture's, but for what is seen of sky and background and what the
  /// bound allows. Throws Error(bad_usage) where has_objects() says no, and what `expose` does.
  ExposedObjects objects(const PixelWeights& weights, const ExposeOptions& options = {}) const;
  /// At a shutter time, 0 to 1.
  ExposedObjects objects_at(double time, const ExposeOptions& options = {}) const;

  /// A pixel's pieces in order of time, from 0 to 1; none where it was not rendered. x, y: in the full frame; throws
  /// Error(bad_usage) for one that is not held.
  std::vector<TimePiece> signal(int x, int y) const;

 private:
  TimeFrame frame_;
  std::shared_ptr<TimeTiles> tiles_;
};

/// Where a frame's own times begin, and what one of its frames is: TimeFrame's.
struct FrameClock {
  double frame_time = 0, fps = 24;
};

/// Keeps what pixels show over time in memory.
class KAIROS_API TimeFilm : public PixelConsumer {
 public:
  /// tolerance: see TimeQuality. objects: keep what each mesh contributes, too. Throws Error(bad_usage) for one that
  /// makes no sense, a crop that is not in the frame and an integrator without time.
  TimeFilm(const Shot& shot, const RenderParams& params, double tolerance = TimeQuality().tolerance,
           FrameClock clock = {}, bool objects = false);
  ~TimeFilm() override;

  RecordNeeds needs() const override;
  void add(const PixelRecord& record) override;

  /// What is there. Leaves the film empty.
  TimePicture take();

 private:
  class Tiles;
  RecordNeeds needs_;
  TimeFrame frame_;
  std::unique_ptr<Tiles> tiles_;
};

}  // namespace kairos
