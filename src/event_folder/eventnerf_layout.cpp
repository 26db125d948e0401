// V. Rudnev, M. Elgharib, C. Theobalt, V. Golyanik: EventNeRF (2023). A split's folder: its loader gives picture i of n
// the time i / (n - 1) of the last event's. Blurred pictures, depth and flow are additions of ours.
#include <array>
#include <cstdio>

#include <kairos/files.h>
#include <kairos/flow.h>

#include "event_folder/folder_layout.h"

namespace kairos {

namespace {

/// Its stamps begin at 0.
FolderPlan without_epoch(FolderPlan plan) {
  plan.file.epoch = 0;
  return plan;
}

class EventNerfLayout : public FolderLayout {
 public:
  explicit EventNerfLayout(const FolderPlan& plan)
      : plan_(without_epoch(plan)), events_(plan.place("events/events.npz"), plan.width, plan.height, plan_.file) {}

  bool spans_events() const override { return true; }
  EventSink& events() override { return events_; }
  void finish_events() override { events_.finish(); }

  void add(const Moment& moment) override {
    const Intrinsics& lens = plan_.lens;  // its pixels' middles are halves
    write_matrix("intrinsics/%06d.txt", moment.number,
                 {{{lens.fx, 0, lens.cx, 0}, {0, lens.fy, lens.cy, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}});
    write_matrix("pose/%06d.txt", moment.number, moment.matrix);
    plan_.write_picture(moment.sharp, plan_.place("rgb/%06d.png", moment.number));
    if (moment.blurred != nullptr)
      plan_.write_picture(*moment.blurred, plan_.place("rgb_blurred/%06d.png", moment.number));
    write_image(depth_picture(moment.depth), plan_.place("depth/%06d.exr", moment.number));
    if (moment.flow != nullptr) write_flow(*moment.flow, plan_.place("flow/%06d.flo", moment.number));
  }

  void add_pose(int64_t time, const CameraPose& pose) override { poses_ += trajectory_line(time, pose); }
  void finish() override { write_file(plan_.place("trajectory.txt"), poses_); }

 private:
  void write_matrix(const char* pattern, int number, const std::array<std::array<double, 4>, 4>& matrix) {
    std::string text;
    for (const auto& row : matrix) {
      std::array<char, 160> line{};
      std::snprintf(line.data(), line.size(), "%.12g %.12g %.12g %.12g\n", row[0], row[1], row[2], row[3]);
      text += line.data();
    }
    write_file(plan_.place(pattern, number), text);
  }

  FolderPlan plan_;
  EventFileWriter events_;
  std::string poses_;
};

}  // namespace

std::unique_ptr<FolderLayout> make_eventnerf_layout(const FolderPlan& plan) {
  return std::make_unique<EventNerfLayout>(plan);
}

}  // namespace kairos
