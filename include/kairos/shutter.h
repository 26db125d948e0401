// When each pixel is exposed: global and rolling shutters, curves, and intervals of any kind.
#pragma once

#include <memory>
#include <vector>

#include <kairos/export.h>
#include <kairos/time_weight.h>

namespace kairos {

/// Where line 0 of a shutter lies, from which its lines are counted.
enum class Scan {
  top,     ///< lines are rows; the upper one is line 0
  bottom,  ///< rows, from the lower one
  left,    ///< columns, from the left one
  right,   ///< columns, from the right one
};

/// What a pixel's integral over its exposure is divided by.
enum class Normalise {
  mean,    ///< the integral of its own weight: brightness does not depend on how long it is exposed
  energy,  ///< how long line 0 is exposed: a line that is exposed for longer is brighter
};

/// When each pixel of a frame is exposed. Seconds from the frame's time; rows from the top.
struct IntervalMap {
  int width = 0, height = 0;
  std::vector<float> open, close;  ///< [y * width + x], open <= close
};

/// Two curtains: line r is exposed from `open + r open_line` to `close + r close_line`. With equal line times it rolls;
/// with open_line 0 all lines open together and close one after the other (global reset); with both 0 it is global.
/// Times are seconds of the scene, relative to the frame's time.
struct Shutter {
  double open = 0, close = 1.0 / 48;
  double open_line = 0, close_line = 0;  ///< per line
  Scan scan = Scan::top;
  int first_line = 0;  ///< number of the frame's first line, where the frame shows a part of a sensor
  /// Over the line's own interval, whose begin and end are its times 0 and 1.
  TimeWeight curve;
  Normalise normalise = Normalise::mean;
  std::shared_ptr<const IntervalMap> map;  ///< in place of the two curtains
};

struct ExposureInterval {
  double open = 0, close = 0;  ///< seconds, as the shutter's
};

/// When the lines of a frame of width x height pixels are exposed: of line `line`, and of all of them together.
KAIROS_API ExposureInterval line_interval(const Shutter& shutter, int line);
KAIROS_API ExposureInterval whole_interval(const Shutter& shutter, int width, int height);

/// A shutter, laid over one shot: what every instant of the shot counts in every pixel. Immutable, cheap to copy.
class KAIROS_API Exposure {
 public:
  /// Shorter exposures, in parts of the shot's time, are means over so long: an instant cannot be weighed.
  static constexpr double kShortest = 0x1p-16;

  /// frame_time: of the scene, at which the shutter's times begin. width, height: pixels of the frame. shot_open,
  /// shot_close: scene time of the shot, which must hold all lines' intervals; it may leave out a part in a billion of
  /// itself. Throws Error(bad_usage) for a shutter that closes before it opens, weighs nothing, or leaves the shot, a
  /// map of another size than the frame and numbers that are not finite.
  Exposure(const Shutter& shutter, double frame_time, int width, int height, double shot_open, double shot_close);

  /// Of a pixel of the frame, over the shot's time 0 to 1. Its begin and end are floats.
  TimeWeight weight(int x, int y) const;

  const Shutter& shutter() const;
  double frame_time() const;
  int width() const;
  int height() const;
  double shot_open() const;
  double shot_close() const;
  /// The shortest of any pixel's, in parts of the shot's time.
  double shortest() const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace kairos
