// E. Mueggler, H. Rebecq, G. Gallego, T. Delbruck, D. Scaramuzza: The Event-Camera Dataset and Simulator (2017).
// Sharp pictures beside blurred ones, and flow, are additions of ours.
#include <array>
#include <cstdio>

#include <kairos/files.h>
#include <kairos/flow.h>

#include "event_folder/folder_layout.h"

namespace kairos {

namespace {

class RpgLayout : public FolderLayout {
 public:
  explicit RpgLayout(const FolderPlan& plan)
      : plan_(plan), events_(plan.place("events.txt"), plan.width, plan.height, plan.file) {}

  EventSink& events() override { return events_; }
  void finish_events() override { events_.finish(); }

  void add(const Moment& moment) override {
    const auto add_to = [&](std::string& list, const char* pattern) {
      std::string path = plan_.place(pattern, moment.number);
      list += seconds(moment.time) + ' ' + path.substr(plan_.folder.string().size() + 1) + '\n';
      return path;
    };
    plan_.write_picture(moment.picture(), add_to(images_, "images/frame_%08d.png"));
    if (moment.blurred != nullptr) plan_.write_picture(moment.sharp, add_to(sharp_, "sharp/frame_%08d.png"));
    write_image(depth_picture(moment.depth), add_to(depths_, "depthmaps/frame_%08d.exr"));
    if (moment.flow == nullptr) return;
    const std::string path = plan_.place("flow/frame_%08d.flo", moment.number);
    write_flow(*moment.flow, path);
    flows_ +=
        seconds(moment.time) + ' ' + seconds(moment.next) + ' ' + path.substr(plan_.folder.string().size() + 1) + '\n';
  }

  void add_pose(int64_t time, const CameraPose& pose) override { poses_ += trajectory_line(plan_.stamp(time), pose); }

  void finish() override {
    std::array<char, 160> lens{};
    std::snprintf(lens.data(), lens.size(), "%.9g %.9g %.9g %.9g 0 0 0 0 0\n", plan_.lens.fx, plan_.lens.fy,
                  plan_.lens.cx - 0.5, plan_.lens.cy - 0.5);
    write_file(plan_.place("calib.txt"), lens.data());
    write_file(plan_.place("images.txt"), images_);
    if (!sharp_.empty()) write_file(plan_.place("sharp.txt"), sharp_);
    write_file(plan_.place("depthmaps.txt"), depths_);
    if (!flows_.empty()) write_file(plan_.place("flow.txt"), flows_);
    write_file(plan_.place("groundtruth.txt"), poses_);
  }

 private:
  std::string seconds(int64_t time) const {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%.9f", static_cast<double>(plan_.stamp(time)) * 1e-9);
    return text.data();
  }

  FolderPlan plan_;
  EventFileWriter events_;
  std::string images_, sharp_, depths_, flows_, poses_;
};

}  // namespace

std::unique_ptr<FolderLayout> make_rpg_layout(const FolderPlan& plan) { return std::make_unique<RpgLayout>(plan); }

}  // namespace kairos
