// What data sets are made of: a scene that is rendered frame by frame, or a file that holds time.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kairos/image.h>
#include <kairos/scene.h>
#include <kairos/shutter.h>

#include "arguments.h"
#include "light_arguments.h"
#include "sampling_arguments.h"

namespace kairos::cli {

/// When a frame is exposed.
struct FrameTimes {
  Shutter shutter;
  double frame_time = 0;       ///< scene time
  double open = 0, close = 1;  ///< scene time: of all lines
  int lines = 1;

  /// The middle of a line's exposure, in scene time.
  double middle_of(int line) const {
    const ExposureInterval interval = line_interval(shutter, line);
    return frame_time + (interval.open + interval.close) / 2;
  }
  double first() const { return middle_of(0); }
  double middle() const { return (middle_of(0) + middle_of(lines - 1)) / 2; }
};

class DatasetSource {
 public:
  virtual ~DatasetSource() = default;

  virtual double fps() const = 0;
  virtual std::array<int, 2> size() const = 0;  ///< pixels of the frame
  /// Goes to a frame. Throws Error for times that are not there, and exposures that have no length.
  virtual void begin(int frame, const FrameTimes& times) = 0;
  /// How a screen shows the frame best.
  virtual ViewTransform view() const = 0;

  // Of the frame:
  /// Where everything is, from the first line's opening to the last one's closing; null: that is not known.
  virtual const Shot* shot() const = 0;
  /// Pictures under shutters, which may be instants, all of the same rays.
  virtual std::vector<Image> expose(std::span<const Shutter> shutters) = 0;
  /// From one scene time to a later one, where a shot is known.
  virtual Image flow(double from, double to) = 0;

  /// What long work tells how far it is.
  std::function<bool(double fraction)> progress;
};

/// How a scene is rendered.
struct DatasetScene {
  SceneArguments scene;
  SamplingArguments sampling;
  LightArguments light;
  bool quiet = false;
};
/// The arguments live as long as the source.
std::unique_ptr<DatasetSource> dataset_of_scene(const DatasetScene& arguments);
/// fps: unset, the file's own. needs_shot: refuse a file that does not know where things are, in the name of the
/// layout.
std::unique_ptr<DatasetSource> dataset_of_file(const std::string& path, std::optional<double> fps, int threads,
                                               bool needs_shot, const std::string& layout);

}  // namespace kairos::cli
