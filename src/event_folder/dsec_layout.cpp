// M. Gehrig, W. Aarents, D. Gehrig, D. Scaramuzza: DSEC, a stereo event camera dataset for driving scenarios (2021). Of
// its four cameras there is one, which is that of the events and of the pictures; depth, poses and sharp pictures
// beside blurred ones are additions of ours.
#include <array>
#include <cstdio>

#include <kairos/files.h>
#include <kairos/flow.h>

#include "event_folder/folder_layout.h"
#include "event_io/rectify_map.h"

namespace kairos {

namespace {

/// Metres between DSEC's event cameras, so that disparities are of the size that it has.
constexpr double kBaseline = 0.6;

class DsecLayout : public FolderLayout {
 public:
  explicit DsecLayout(const FolderPlan& plan)
      : plan_(plan), events_(plan.place("events/left/events.h5"), plan.width, plan.height, plan.file) {}

  EventSink& events() override { return events_; }
  void finish_events() override {
    events_.finish();
    write_rectify_map(plan_.place("events/left/rectify_map.h5"), plan_.width, plan_.height);
  }

  void add(const Moment& moment) override {
    plan_.write_picture(moment.picture(), plan_.place("images/left/rectified/%06d.png", moment.number));
    if (moment.blurred != nullptr)
      plan_.write_picture(moment.sharp, plan_.place("images/left/sharp/%06d.png", moment.number));
    times_ += microseconds(moment.time) + '\n';
    exposures_ += microseconds(moment.open) + ", " + microseconds(moment.close) + '\n';
    write_disparity(moment.depth, plan_.lens.fx * kBaseline, plan_.place("disparity/event/%06d.png", moment.number));
    write_image(depth_picture(moment.depth), plan_.place("depth/%06d.exr", moment.number));
    if (moment.flow == nullptr) return;
    write_flow(*moment.flow, plan_.place("flow/forward/%06d.png", moment.number), FlowCodes::dsec);
    flows_ += microseconds(moment.time) + ", " + microseconds(moment.next) + '\n';
  }

  void add_pose(int64_t time, const CameraPose& pose) override { poses_ += trajectory_line(plan_.stamp(time), pose); }

  void finish() override {
    write_file(plan_.place("images/timestamps.txt"), times_);
    write_file(plan_.place("images/left/exposure_timestamps.txt"),
               "# exposure_start_timestamp_us, exposure_end_timestamp_us\n" + exposures_);
    write_file(plan_.place("disparity/timestamps.txt"), times_);
    if (!flows_.empty())
      write_file(plan_.place("flow/forward_timestamps.txt"), "# from_timestamp_us, to_timestamp_us\n" + flows_);
    write_file(plan_.place("poses.txt"),
               "# time [s], x, y, z, qx, qy, qz, qw: from the camera to the world\n" + poses_);
    write_file(plan_.place("calibration/cam_to_cam.yaml"), calibration());
  }

 private:
  /// Counters cut off.
  std::string microseconds(int64_t time) const { return std::to_string(plan_.stamp(time) / 1000); }

  std::string calibration() const {
    const double fx = plan_.lens.fx, fy = plan_.lens.fy, cx = plan_.lens.cx - 0.5, cy = plan_.lens.cy - 0.5;
    const auto numbers = [](std::initializer_list<double> list) {
      std::string text = "[";
      for (const double number : list) {
        std::array<char, 32> digits{};
        std::snprintf(digits.data(), digits.size(), "%s%.12g", text.size() > 1 ? ", " : "", number);
        text += digits.data();
      }
      return text + "]";
    };
    std::string text = "# Kairos: one pinhole camera, in the places of the left event and the left frame camera.\n";
    text += "intrinsics:\n";
    for (const char* camera : {"cam0", "camRect0", "cam1", "camRect1"}) {
      text += std::string("  ") + camera + ":\n    camera_matrix: " + numbers({fx, fy, cx, cy}) +
              "\n    camera_model: pinhole\n    distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n"
              "    distortion_model: radtan\n    resolution: [" +
              std::to_string(plan_.width) + ", " + std::to_string(plan_.height) + "]\n";
    }
    text += "extrinsics:\n";
    for (const char* turn : {"R_rect0", "R_rect1"})
      text += std::string("  ") + turn + ": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n";
    text += "  T_10: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]\n";
    text += "disparity_to_depth:\n";
    for (const char* pair : {"cams_03", "cams_12"})
      text += std::string("  ") + pair + ": [" + numbers({1, 0, 0, -cx}) + ", " + numbers({0, 1, 0, -cy}) + ", " +
              numbers({0, 0, 0, fx}) + ", " + numbers({0, 0, 1 / kBaseline, 0}) + "]\n";
    return text;
  }

  FolderPlan plan_;
  EventFileWriter events_;
  std::string times_, exposures_, flows_, poses_;
};

}  // namespace

std::unique_ptr<FolderLayout> make_dsec_layout(const FolderPlan& plan) { return std::make_unique<DsecLayout>(plan); }

}  // namespace kairos
