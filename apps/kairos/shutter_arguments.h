// Shutters on the command line: units, rolling, curves.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include <kairos/scene.h>
#include <kairos/shutter.h>

#include "arguments.h"

namespace kairos::cli {

/// What the options of add_exposure_options say.
struct ExposureArguments {
  struct Rolling {
    Scan scan = Scan::top;
    Duration time;  ///< of a line, or of all lines
    bool per_line = false;
    bool reset = false;  ///< all lines open together
  };
  std::optional<Rolling> rolling;
  TimeWeight curve;
  std::string curve_text = "box";
  enum class Anchor { first, middle, last } anchor = Anchor::first;
  int sensor_lines = 0, first_line = 0;  ///< 0: the frame is all of the sensor
  std::string map;                       ///< a file, or empty
  Normalise normalise = Normalise::mean;
  bool signed_curve = false;

  /// Is there anything but a box over the same time for all pixels?
  bool any() const { return rolling || !curve.is_box() || !map.empty() || normalise != Normalise::mean; }
};
void add_exposure_options(CLI::App& app, ExposureArguments& out);

/// interval: seconds from the frame's time, of the line that is the anchor. width, height: of the frame. Reads the map.
/// Throws Error for one that cannot be used.
Shutter shutter_of(const ExposureArguments& arguments, const std::array<double, 2>& interval, double fps, int width,
                   int height);

/// A shot that holds all exposures.
struct ExposedShot {
  ShotOptions options;
  std::optional<Shutter> shutter;  ///< unset: all pixels are exposed for all of the shot
  double frame_time = 0;           ///< scene time

  /// Of the shot that was made with the options.
  std::optional<Exposure> exposure(const Shot& shot) const;
};
ExposedShot exposed_shot(const SceneArguments& scene_arguments, const ExposureArguments& arguments, const Scene& scene);

/// One line: which lines are exposed when.
std::string shutter_text(const Shutter& shutter, int width, int height);

}  // namespace kairos::cli
