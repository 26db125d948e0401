// kairos dataset: sequences of exposed and sharp pictures, flow and poses, laid out as loaders of data sets read them.
#include <cmath>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/flow.h>
#include <kairos/version.h>

#include "arguments.h"
#include "commands.h"
#include "dataset_layout.h"
#include "dataset_pose.h"
#include "dataset_source.h"
#include "frames.h"
#include "interrupt.h"
#include "log.h"
#include "progress_bar.h"
#include "report.h"
#include "time_arguments.h"
#include "view_arguments.h"

namespace kairos::cli {

namespace {

using nlohmann::ordered_json;

struct DatasetArguments {
  DatasetScene of_scene;
  ViewArguments view;
  FrameRange frames;
  const DatasetLayout* layout = nullptr;
  std::string folder, sequence, command_line;
  bool exr = false, quiet = false;

  bool is_file() const { return holds_time(of_scene.scene.paths); }
};

bool rolls(const Shutter& shutter) { return shutter.open_line != 0 || shutter.close_line != 0; }

class Dataset {
 public:
  Dataset(const DatasetArguments& arguments, DatasetSource& source)
      : arguments_(arguments),
        source_(source),
        fps_(source.fps()),
        work_(arguments.quiet, static_cast<size_t>(arguments.frames.count())) {
    source.progress = work_.of_piece();
    poses_ = "frame,line,time_s,qw,qx,qy,qz,x,y,z\n";
  }

  void write() {
    for (int frame = arguments_.frames.first; frame <= arguments_.frames.last; ++frame) write_frame(frame);
    describe();
  }

 private:
  const DatasetLayout& layout() const { return *arguments_.layout; }

  /// The path of a file of the frame, in a folder that is there.
  std::string place(const char* pattern, int frame) const {
    const int number = frame - arguments_.frames.first + layout().first_number;
    return made(std::filesystem::path(arguments_.folder) / dataset_file(pattern, arguments_.sequence, number));
  }
  static std::string made(const std::filesystem::path& path) {
    std::error_code ec;
    std::filesystem::create_directories(path.parent_path(), ec);
    if (ec) throw Error(ErrorCode::io, path.parent_path().string(), "cannot be made: " + ec.message());
    return path.string();
  }

  FrameTimes times_of(int frame) const {
    const auto& shutter = arguments_.of_scene.scene.shutter;
    const std::array<double, 2> in_frames = shutter ? shutter->in_frames(fps_) : std::array<double, 2>{0, 0.5};
    const auto [width, height] = source_.size();
    FrameTimes times;
    times.shutter = shutter_of(exposure(), {in_frames[0] / fps_, in_frames[1] / fps_}, fps_, width, height);
    times.frame_time = frame / fps_;
    const bool columns = times.shutter.scan == Scan::left || times.shutter.scan == Scan::right;
    times.lines = columns ? width : height;
    const ExposureInterval whole = whole_interval(times.shutter, width, height);
    times.open = times.frame_time + whole.open;
    times.close = times.frame_time + whole.close;
    return times;
  }
  const ExposureArguments& exposure() const { return arguments_.of_scene.sampling.exposure; }

  void write_frame(int frame) {
    const FrameTimes times = times_of(frame);
    source_.begin(frame, times);
    const auto instant = [&](double scene_time) {
      Shutter shutter;
      shutter.open = shutter.close = scene_time - times.frame_time;
      return shutter;
    };
    std::vector<Shutter> shutters{times.shutter, instant(times.middle())};
    if (*layout().sharp_first != 0) shutters.push_back(instant(times.first()));
    std::vector<Image> images = source_.expose(shutters);
    for (Image& image : images) image.attributes.push_back({"kairos:command_line", arguments_.command_line});

    ordered_json files;
    const auto write = [&](const Image& image, const char* pattern, int of_frame, const char* what) {
      if (*pattern == 0) return;
      WriteOptions options;
      options.view = arguments_.view.choice.value_or(source_.view());
      options.exposure = arguments_.view.exposure;
      const std::string path = place(pattern, of_frame);
      write_interruptibly(image, path, options);
      if (arguments_.exr) write_interruptibly(image, std::filesystem::path(path).replace_extension(".exr").string());
      files[what] = relative(path);
    };
    const int number = frame - arguments_.frames.first;
    const bool last = frame == arguments_.frames.last;
    const bool evaluates = layout().sharp_every > 0 && number % layout().sharp_every == 0;
    const Image &blurred = images[0], &still = images[1];
    if (*layout().exposed_next == 0 || !last) write(evaluates ? still : blurred, layout().exposed, frame, "exposed");
    if (*layout().exposed_next != 0 && number > 0) write(blurred, layout().exposed_next, frame - 1, "exposed_next");
    write(still, layout().sharp, frame, "sharp");
    write(images.back(), layout().sharp_first, frame, "sharp_first");
    if (*layout().depth != 0) write_lines(frame, times, files);
    if (*layout().flow != 0 && !last) write_flow_of(frame, times, files);
    if (source_.shot() != nullptr) tell_motion(frame, *source_.shot(), times, evaluates, files);
    tell(frame, times, std::move(files));
    work_.next();
    if (!arguments_.quiet)
      cli::log(
          fmt::format("frame {}, {} of {}", frame, frame - arguments_.frames.first + 1, arguments_.frames.count()));
  }

  /// What each line sees in the middle of its exposure: how far away it is, and where it is in the sharp pictures.
  void write_lines(int frame, const FrameTimes& times, ordered_json& files) {
    const Shot& shot = *source_.shot();
    const auto [width, height] = source_.size();
    const Exposure lines(times.shutter, times.frame_time, width, height, shot.shutter_open, shot.shutter_close);
    const auto flow_to = [&](double scene_time) {
      const double to = (scene_time - shot.shutter_open) / (shot.shutter_close - shot.shutter_open);
      FlowOptions options;
      options.threads = arguments_.of_scene.scene.threads;
      options.instruction_set = arguments_.of_scene.sampling.params.instruction_set;
      options.progress = source_.progress;
      options.times = [&](int x, int y) -> std::array<double, 2> {
        const TimeWeight line = lines.weight(x, y);
        return {(line.begin() + line.end()) / 2, to};
      };
      begin_polling();
      Image image = flow(shot, options);
      end_polling();
      return image;
    };
    const auto file = [&](const char* pattern, const char* what) {
      std::string path = place(pattern, frame);
      files[what] = relative(path);
      return path;
    };
    Image first = flow_to(times.first());
    const Image middle = flow_to(times.middle());
    write_file(file(layout().depth, "depth"), text_matrix(*middle.find("depth.Z"), width));
    write_flow(middle, file(layout().undistort, "undistort"));
    write_flow(first, file(layout().undistort_first, "undistort_first"));
    const auto seen = static_cast<float>(FlowState::seen), hidden = static_cast<float>(FlowState::hidden);
    const std::vector<float>& in_middle = middle.find("flow.state")->values;
    for (Channel& channel : first.channels)
      if (channel.name == "flow.state")
        for (size_t i = 0; i < in_middle.size(); ++i)  // an occlusion is white where it is not seen: turned round
          channel.values[i] = channel.values[i] == seen && in_middle[i] == seen ? hidden : seen;
    write_occlusion(first, file(layout().undistort_seen, "undistort_seen"));
  }

  std::string relative(const std::string& path) const {
    return std::filesystem::relative(path, arguments_.folder).generic_string();
  }

  /// Rows of text.
  static std::string text_matrix(const Channel& channel, int width) {
    std::string text;
    for (size_t i = 0; i < channel.values.size(); ++i)
      text += fmt::format("{:.6g}{}", channel.values[i], (i + 1) % static_cast<size_t>(width) == 0 ? '\n' : ' ');
    return text;
  }

  /// How the camera moves in the frame, where the data set says it.
  void tell_motion(int frame, const Shot& shot, const FrameTimes& times, bool evaluates, const ordered_json& files) {
    const CameraVelocity v = velocity_between(shot, times.open, times.close, times.middle());
    if (*layout().velocity != 0 && frame == arguments_.frames.first)
      write_file(
          made(std::filesystem::path(arguments_.folder) / dataset_file(layout().velocity, arguments_.sequence, 0)),
          fmt::format("# Velocity of the camera in its own axes (x right, y down, z forward), per second, in "
                      "the first frame\n# wx, wy, wz, x, y, z\n{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
                      v.angular.x, -v.angular.y, -v.angular.z, v.linear.x, -v.linear.y, -v.linear.z));
    if (*layout().transforms == 0) return;
    const std::string folder = arguments_.sequence + "/";
    std::string file = files.at("exposed");
    if (file.starts_with(folder)) file = file.substr(folder.size());
    const Vec3d zero;
    const Vec3d &linear = evaluates ? zero : v.linear, &angular = evaluates ? zero : v.angular;
    transforms_.push_back({{"file_path", "./" + file},
                           {"transform_matrix", camera_matrix(shot, times.middle(), CameraAxis::minus_z)},
                           {"camera_linear_velocity", {linear.x, linear.y, linear.z}},
                           {"camera_angular_velocity", {angular.x, angular.y, angular.z}}});
  }

  /// From the frame's sharp picture to the next one.
  void write_flow_of(int frame, const FrameTimes& times, ordered_json& files) {
    begin_polling();
    Image image = source_.flow(times.middle(), times.middle() + 1 / fps_);
    end_polling();
    const std::string path = place(layout().flow, frame);
    write_flow(image, path);
    files["flow"] = relative(path);
    if (*layout().occlusion != 0) {
      const std::string occlusion = place(layout().occlusion, frame);
      write_occlusion(image, occlusion);
      files["occlusion"] = relative(occlusion);
    }
    if (*layout().flow_seen == 0) return;
    for (Channel& channel : image.channels)
      if (channel.name == "flow.state")
        for (float& state : channel.values)
          if (state != static_cast<float>(FlowState::seen)) state = static_cast<float>(FlowState::unknown);
    const std::string seen = place(layout().flow_seen, frame);
    write_flow(image, seen);
    files["flow_seen"] = relative(seen);
  }

  /// What meta.json and poses.csv say of a frame.
  void tell(int frame, const FrameTimes& times, ordered_json files) {
    const ExposureInterval first = line_interval(times.shutter, 0);
    const bool rolling = rolls(times.shutter);
    const Shot* const shot = source_.shot();
    ordered_json& of_frame = frames_.emplace_back(ordered_json{{"frame", frame},
                                                               {"frame_time_s", times.frame_time},
                                                               {"first_line_open_s", times.frame_time + first.open},
                                                               {"first_line_close_s", times.frame_time + first.close},
                                                               {"sharp_s", times.middle()},
                                                               {"sharp_first_s", times.first()}});
    if (shot != nullptr) {
      of_frame["pose_start"] = camera_pose(*shot, shot->shutter_open, CameraAxis::minus_z);
      of_frame["pose_sharp"] = camera_pose(*shot, times.middle(), CameraAxis::minus_z);
      of_frame["pose_end"] = camera_pose(*shot, shot->shutter_close, CameraAxis::minus_z);
    }
    of_frame["files"] = std::move(files);
    for (int line = 0; shot != nullptr && line < (rolling ? times.lines : 1); ++line) {
      const auto pose = camera_pose(*shot, times.middle_of(line), CameraAxis::minus_z);
      poses_ += fmt::format("{},{},{:.17g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", frame, line,
                            times.middle_of(line), pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6]);
    }
    if (frame > arguments_.frames.first) return;
    constexpr const char* kScans[] = {"top", "bottom", "left", "right"};
    const Shutter& s = times.shutter;
    meta_["layout"] = layout().name;
    meta_["sequence"] = arguments_.sequence;
    meta_["fps"] = fps_;
    meta_["exposure_s"] = first.close - first.open;
    meta_["scan"] = rolling ? kScans[static_cast<int>(s.scan)] : "none";
    meta_["line_time_s"] = s.close_line;
    meta_["lines_open_together"] = rolling && s.open_line == 0;
    meta_["readout_s"] = s.close_line * times.lines;
    meta_["readout_definition"] = "lines x line time";
    meta_["curve"] = exposure().curve_text;
    meta_["sharp"] = "the instant in the middle of the middle line's exposure; sharp_first: of the first line's";
    meta_["colour"] = "PNG: sRGB through a view; pictures are averaged in linear light before";
    if (shot == nullptr) return;
    meta_["pose"] =
        "w, x, y, z of the rotation from the camera to the world, then its place in metres; the camera looks along "
        "-z, y is up. poses.csv: at the middle of each line's exposure";
    meta_["intrinsics"] = intrinsics_of(shot->projection);
  }

  void describe() {
    meta_["frames"] = frames_;
    meta_[arguments_.is_file() ? "recording" : "scene"] = arguments_.of_scene.scene.paths;
    meta_["command"] = arguments_.command_line;
    meta_["kairos"] = version();
    const std::filesystem::path folder(arguments_.folder);
    const std::string text = meta_.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
    if (*layout().log != 0) write_file(made(folder / dataset_file(layout().log, arguments_.sequence, 0)), text);
    if (*layout().transforms != 0)
      write_file(made(folder / dataset_file(layout().transforms, arguments_.sequence, 0)), transforms_text());
    if (source_.shot() != nullptr) write_file(made(folder / (arguments_.sequence + "_poses.csv")), poses_);
    write_file(made(folder / (arguments_.sequence + "_meta.json")), text);
    if (!arguments_.quiet) cli::log(fmt::format("wrote {}/{}_meta.json", arguments_.folder, arguments_.sequence));
  }

  /// Of nerfstudio, with what 3DGS-deblur adds.
  std::string transforms_text() const {
    const ordered_json& lens = meta_.at("intrinsics");
    ordered_json json;
    json["w"] = lens.at("width");
    json["h"] = lens.at("height");
    for (const auto& [to, from] : {std::pair("fl_x", "fx"), {"fl_y", "fy"}, {"cx", "cx"}, {"cy", "cy"}})
      if (lens.contains(from)) json[to] = lens.at(from);
    for (const char* none : {"k1", "k2", "p1", "p2"}) json[none] = 0;
    json["orientation_override"] = "none";
    json["exposure_time"] = meta_.at("exposure_s");
    json["rolling_shutter_time"] = meta_.at("readout_s");
    json["frames"] = transforms_;
    return json.dump(1) + "\n";
  }

  const DatasetArguments& arguments_;
  DatasetSource& source_;
  double fps_;
  WorkProgress work_;
  ordered_json meta_, frames_ = ordered_json::array(), transforms_ = ordered_json::array();
  std::string poses_;
};

void run_dataset(DatasetArguments& arguments) {
  DatasetScene& of_scene = arguments.of_scene;
  if (!arguments.is_file()) read_calibration_into(of_scene.sampling);
  const std::unique_ptr<DatasetSource> source =
      arguments.is_file()
          ? dataset_of_file(of_scene.scene.paths.front(), of_scene.scene.shot.fps, of_scene.scene.threads,
                            arguments.layout->needs_shot(), arguments.layout->name)
          : dataset_of_scene(of_scene);
  Dataset(arguments, *source).write();
}

}  // namespace

void add_dataset_command(CLI::App& app, Action& chosen, const std::string& command_line) {
  CLI::App& command = *app.add_subcommand("dataset", "Make a data set: exposed and sharp pictures, flow, poses");
  const auto arguments = std::make_shared<DatasetArguments>();
  arguments->command_line = command_line;
  std::string names;
  for (const DatasetLayout& layout : dataset_layouts()) names += (names.empty() ? "" : "|") + std::string(layout.name);
  add_scene_arguments(command, arguments->of_scene.scene);
  command
      .add_option_function<std::string>(
          "--layout",
          [arguments, names](const std::string& text) {
            for (const DatasetLayout& layout : dataset_layouts())
              if (text == layout.name) arguments->layout = &layout;
            if (arguments->layout == nullptr)
              throw CLI::ValidationError("--layout", fmt::format("'{}' is not one of: {}", text, names));
          },
          "Whose loaders are to read it")
      ->type_name(names)
      ->required();
  command.add_option("-o,--output", arguments->folder, "The folder of the data set")->type_name("DIR")->required();
  command
      .add_option_function<std::string>(
          "--frames", [arguments](const std::string& text) { arguments->frames = parse_frames("--frames", text); },
          "The frames of the sequence")
      ->type_name("A-B")
      ->excludes("--frame")
      ->required();
  command.add_option("--sequence", arguments->sequence, "The sequence's name (default: the scene's)")
      ->type_name("NAME");
  command.add_flag("--exr", arguments->exr, "An EXR of linear colours beside every PNG");
  add_exposure_options(command, arguments->of_scene.sampling.exposure);
  add_light_options(command, arguments->of_scene.light);
  add_sampling_options(command, arguments->of_scene.sampling);
  add_view_options(command, arguments->view);
  command.add_flag("--quiet", arguments->quiet, "Errors only");
  command.callback([arguments, &chosen, &command] {
    if (arguments->is_file())
      check_options_of_file(
          command, {"--layout", "--frames", "--sequence", "--exr", "--shutter", "--rolling", "--curve", "--anchor",
                    "--sensor-lines", "--signed-curve", "--normalise", "--view", "--exposure"});
    choose_integrator(command, arguments->of_scene.sampling.params);
    if (arguments->of_scene.sampling.params.integrator == IntegratorKind::qmc)
      throw CLI::ValidationError("--integrator", "discrete rays see no time; use tc, mixed or auto");
    if (arguments->layout->rolls && !arguments->of_scene.sampling.exposure.rolling)
      throw CLI::ValidationError("--rolling",
                                 fmt::format("{} is of rolling shutters; give it", arguments->layout->name));
    if (!arguments->of_scene.sampling.exposure.map.empty())
      throw CLI::ValidationError("--interval-map",
                                 "a data set's lines are exposed one after the other; give --rolling");
    if (arguments->sequence.empty())
      arguments->sequence = std::filesystem::path(arguments->of_scene.scene.paths.front()).stem().string();
    if (arguments->sequence.find('/') != std::string::npos || arguments->sequence.find('%') != std::string::npos)
      throw CLI::ValidationError("--sequence", "is the name of a folder, without / and %");
    arguments->of_scene.quiet = arguments->quiet;
    arguments->of_scene.sampling.params.threads = arguments->of_scene.scene.threads;
    arguments->of_scene.scene.shot.textures = arguments->of_scene.sampling.params.shading != ShadingKind::normal;
    arguments->of_scene.scene.shot.strict = arguments->of_scene.scene.load.strict;
    arguments->of_scene.light.apply(command, arguments->of_scene.sampling.params, arguments->of_scene.scene.shot);
    chosen = [arguments] { run_dataset(*arguments); };
  });
}

}  // namespace kairos::cli
