#include <deque>

#include <kairos/error.h>
#include <kairos/flow.h>
#include <kairos/picture.h>

#include "dataset_source.h"
#include "interrupt.h"
#include "log.h"

namespace kairos::cli {

namespace {

/// Everything of a frame is one rendering, whose rays see all of the time from the first line's opening to the last
/// one's closing: of discrete rays next to none would see an instant.
class AllOverTime : public PixelConsumer {
 public:
  RecordNeeds needs() const override { return {RecordNeeds::Time::segments, false, false}; }
  void add(const PixelRecord&) override {}
};

class SceneSource : public DatasetSource {
 public:
  SceneSource(const DatasetScene& arguments, std::shared_ptr<const Scene> scene)
      : arguments_(arguments), scene_(std::move(scene)) {}

  double fps() const override { return arguments_.scene.shot.fps.value_or(contents(*scene_).fps); }

  std::array<int, 2> size() const override {
    const ShotOptions& options = arguments_.scene.shot;
    const std::array<int, 2> size = contents(*scene_).image_size.value_or(std::array<int, 2>{960, 540});
    return {options.width > 0 ? options.width : size[0], options.height > 0 ? options.height : size[1]};
  }

  void begin(int frame, const FrameTimes& times) override {
    SceneArguments of_frame = arguments_.scene;
    of_frame.shot.frame = frame;
    ShotOptions options = shot_options(of_frame, *scene_);
    options.shutter = {(times.open - times.frame_time) * fps(), (times.close - times.frame_time) * fps()};
    frame_ = frame;
    times_ = times;
    shot_ = make_shot(*scene_, options);
    if (!(shot_.shutter_close > shot_.shutter_open))
      throw Error(ErrorCode::bad_usage, "", "a data set needs exposures of some length; give another --shutter");
    arguments_.light.background.apply(shot_);
    if (told_ || arguments_.quiet) return;
    told_ = true;
    for (const std::string& note : shot_.notes) cli::log("note: " + note);
  }

  ViewTransform view() const override { return usual_view(shot_, arguments_.sampling.params.shading); }
  const Shot* shot() const override { return &shot_; }

  std::vector<Image> expose(std::span<const Shutter> shutters) override {
    const Projection& projection = shot_.projection;
    AllOverTime over_time;
    std::vector<PixelConsumer*> consumers{&over_time};
    std::deque<Picture> pictures;  // which do not move
    for (const Shutter& shutter : shutters) {
      RenderParams params = arguments_.sampling.params;
      params.exposure = Exposure(shutter, times_.frame_time, projection.width, projection.height, shot_.shutter_open,
                                 shot_.shutter_close);
      consumers.push_back(&pictures.emplace_back(projection, params));
    }
    begin_polling();
    Renderer(shot_).render(arguments_.sampling.params, consumers, nullptr, progress);
    end_polling();
    std::vector<Image> images;
    for (Picture& picture : pictures) images.push_back(picture.take_shown());
    return images;
  }

  Image flow(double from, double to) override {
    ShotOptions options = arguments_.scene.shot;
    options.frame = frame_;
    options.shutter = {(from - times_.frame_time) * fps(), (to - times_.frame_time) * fps()};
    options.textures = false;
    FlowOptions flow_options;
    flow_options.threads = arguments_.scene.threads;
    flow_options.instruction_set = arguments_.sampling.params.instruction_set;
    flow_options.progress = progress;
    return kairos::flow(make_shot(*scene_, options), flow_options);
  }

 private:
  const DatasetScene& arguments_;
  std::shared_ptr<const Scene> scene_;
  int frame_ = 0;
  FrameTimes times_;
  Shot shot_;
  bool told_ = false;
};

}  // namespace

std::unique_ptr<DatasetSource> dataset_of_scene(const DatasetScene& arguments) {
  auto scene = load_scene(arguments.scene.paths, arguments.scene.load);
  if (!arguments.quiet)
    for (const std::string& warning : contents(*scene).warnings) cli::log("warning: " + warning);
  return std::make_unique<SceneSource>(arguments, std::move(scene));
}

}  // namespace kairos::cli
