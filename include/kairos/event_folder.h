// Recordings with all that is known beside the events, in folders that data sets' loaders read. docs/events.md.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <kairos/events.h>
#include <kairos/export.h>
#include <kairos/names.h>
#include <kairos/scene.h>

namespace kairos {

enum class EventLayout {
  rpg,        ///< E. Mueggler et al. 2017: text, pictures, poses
  dsec,       ///< M. Gehrig et al. 2021: HDF5, pictures, disparity, flow; a sequence's folder
  evimo2,     ///< L. Burner et al. 2022, version 2: numpy's arrays of events, depth, masks, flow; a sequence's folder
  eventnerf,  ///< V. Rudnev et al. 2023: pictures and poses that share out the time of the events; a split's folder
};

/// Do its files of events have a place for labels?
inline bool keeps_labels(EventLayout layout) { return layout == EventLayout::eventnerf || layout == EventLayout::dsec; }

struct EventFolderOptions {
  EventLayout layout = EventLayout::rpg;
  double frame_rate = 20;  ///< Hz: of pictures, depth and flow; above 0, at most 1e6
  double exposure = 0.01;  ///< seconds: of the blurred pictures; 0: sharp ones alone
  double pose_rate = 200;  ///< Hz; above 0, at most 1e6
  int samples = 64;        ///< per pixel of a picture
  bool exr = false;        ///< beside every PNG an EXR of linear colours
  int64_t epoch = 0;       ///< nanoseconds that are added to all stamps, where the layout has a place for them
};

/// Takes the events of a recording, and then renders what belongs to it: pictures sharp and blurred, depth, flow to the
/// next picture, and poses. Labels and kinds of events are kept where the layout has files for them. Pictures show
/// light as the sensor gets it; sRGB, in which white is the sensor's.
class KAIROS_API EventFolder : public EventSink {
 public:
  /// recording: of this scene; both must outlive the folder. Throws Error(bad_usage) for options out of range and
  /// cameras that are no pinholes, Error(io) when the folder cannot be made, and what make_shot throws.
  EventFolder(const std::string& path, const EventFolderOptions& options, const Scene& scene,
              const EventOptions& recording);
  ~EventFolder() override;

  void add(std::span<const Event> events) override;
  void add_labelled(std::span<const Event> events, std::span<const EventLabel> labels) override;
  /// When all events are there: makes all else. Throws what rendering and writing throw, Error(cancelled) when
  /// `progress` says so.
  void finish(const Progress& progress = {});

  class Maker;

 private:
  std::unique_ptr<Maker> maker_;
};

template <>
inline constexpr auto kNames<EventLayout> = std::to_array<Named<EventLayout>>({{"rpg", EventLayout::rpg},
                                                                               {"dsec", EventLayout::dsec},
                                                                               {"evimo2", EventLayout::evimo2},
                                                                               {"eventnerf", EventLayout::eventnerf}});

}  // namespace kairos
