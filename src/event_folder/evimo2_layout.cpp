// L. Burner, A. Mitrokhin, C. Fermueller, Y. Aloimonos: EVIMO2 (2022), second version: a sequence's folder. Sharp
// pictures beside blurred ones are an addition of ours. Objects have no poses of their own: what moves need not be
// rigid.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/npz_file.h"
#include "event_folder/folder_layout.h"
#include "event_folder/pickle.h"
#include "image/write_png.h"

namespace kairos {

namespace {

using nlohmann::ordered_json;

constexpr double kIndexed = 0.01;  // seconds: from one entry of the index of events to the next
constexpr uint32_t kMaskStep = 1000;
constexpr float kDepthsPerUnit = 1000;  // millimetres of a metre
constexpr const char* kByte = "'|u1'";

class Evimo2Events : public EventSink {
 public:
  explicit Evimo2Events(const FolderPlan& plan)
      : t_(plan.place("dataset_events_t.npy"), "'<f8'"),
        xy_(plan.place("dataset_events_xy.npy"), "'<u2'", 2),
        p_(plan.place("dataset_events_p.npy"), kByte) {}

  void add(std::span<const Event> events) override {
    std::array<std::vector<uint8_t>, 3> bytes;
    for (const Event& event : events) {
      const double time = static_cast<double>(event.time) * 1e-9;
      while (static_cast<double>(index.size()) * kIndexed <= time) index.push_back(count_);
      put_item(bytes[0], time);
      put_item(bytes[1], event.x);
      put_item(bytes[1], event.y);
      put_item(bytes[2], static_cast<uint8_t>(event.polarity > 0));
      ++count_;
    }
    t_.write(bytes[0], events.size());
    xy_.write(bytes[1], 2 * events.size());
    p_.write(bytes[2], events.size());
  }
  void finish() {
    for (NpyFile* file : {&t_, &xy_, &p_}) file->finish();
  }

  std::vector<uint64_t> index;  // how many events are before each step of kIndexed

 private:
  NpyFile t_, xy_, p_;
  uint64_t count_ = 0;
};

ordered_json pose_json(int64_t time, const CameraPose& pose) {
  const auto [w, x, y, z, px, py, pz] = pose;
  ordered_json json;
  json["pos"]["q"] = {{"w", w}, {"x", x}, {"y", y}, {"z", z}};
  json["pos"]["rpy"] = {{"p", std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0))},
                        {"r", std::atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))},
                        {"y", std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))}};
  json["pos"]["t"] = {{"x", px}, {"y", py}, {"z", pz}};
  json["ts"] = static_cast<double>(time) * 1e-9;
  return json;
}

class Evimo2Layout : public FolderLayout {
 public:
  explicit Evimo2Layout(const FolderPlan& plan)
      : plan_(plan),
        events_(plan),
        classical_(plan.place("dataset_classical.npz")),
        depth_(plan.place("dataset_depth.npz")),
        mask_(plan.place("dataset_mask.npz")),
        flow_(plan.place("dataset_flow.npz")) {}

  EventSink& events() override { return events_; }
  void finish_events() override { events_.finish(); }

  void add(const Moment& moment) override {
    const std::array<uint64_t, 2> shape{height(), width()};
    add_picture(classical_, "classical_", moment.number, moment.picture());
    if (moment.blurred != nullptr) {
      if (!sharp_) sharp_ = std::make_unique<NpzFile>(plan_.place("dataset_sharp.npz"));
      add_picture(*sharp_, "sharp_", moment.number, moment.sharp);
    }
    std::vector<uint8_t> bytes;
    for (const float depth : moment.depth.find("depth.Z")->values) {
      const float whole = std::round(depth * kDepthsPerUnit);
      put_item(bytes, static_cast<uint16_t>(whole > 0 && whole <= 65535 ? whole : 0));
    }
    depth_.add_array(key("depth_", moment.number), "'<u2'", shape, bytes);
    bytes.clear();
    const bool wide = plan_.meshes * kMaskStep > std::numeric_limits<uint16_t>::max();
    for (const float mesh : moment.sharp.find("mesh.id")->values) {
      const uint32_t code = static_cast<uint32_t>(mesh) * kMaskStep;
      if (wide)
        put_item(bytes, code);
      else
        put_item(bytes, static_cast<uint16_t>(code));
    }
    mask_.add_array(key("mask_", moment.number), wide ? "'<u4'" : "'<u2'", shape, bytes);
    if (moment.flow != nullptr) add_flow(moment);
    ordered_json frame;
    frame["cam"] = pose_json(moment.time, moment.pose);
    frame["classical_frame"] = "img_" + std::to_string(moment.number) + ".png";
    frame["gt_frame"] = "depth_mask_" + std::to_string(moment.number) + ".png";
    frame["id"] = moment.number;
    frame["ts"] = static_cast<double>(moment.time) * 1e-9;
    frames_.push_back(std::move(frame));
  }

  void add_pose(int64_t time, const CameraPose& pose) override {
    ordered_json instant;
    instant["cam"] = pose_json(time, pose);
    instant["id"] = -1;  // there is no picture of it
    instant["ts"] = static_cast<double>(time) * 1e-9;
    trajectory_.push_back(std::move(instant));
  }

  void finish() override {
    for (const auto& [name, times] : {std::pair("t", &flow_from_), std::pair("t_end", &flow_to_)})
      add_list(flow_, name, "'<f8'", *times);
    for (NpzFile* file : {&classical_, &depth_, &mask_, &flow_}) file->finish();
    if (sharp_) sharp_->finish();
    NpzFile info(plan_.place("dataset_info.npz"));
    add_list(info, "index", "'<u8'", events_.index);
    std::vector<uint8_t> bytes;
    put_item(bytes, kIndexed);
    info.add_array("discretization", "'<f8'", {}, bytes);
    const double cx = plan_.lens.cx - 0.5, cy = plan_.lens.cy - 0.5;
    const std::array<uint64_t, 2> square{3, 3};
    bytes.clear();
    for (const double item : {plan_.lens.fx, 0.0, cx, 0.0, plan_.lens.fy, cy, 0.0, 0.0, 1.0}) put_item(bytes, item);
    info.add_array("K", "'<f8'", square, bytes);
    add_list(info, "D", "'<f8'", std::vector<double>(4));
    info.add_array("meta", "'|O'", {}, pickled_object_array(meta(cx, cy)));
    info.finish();
  }

 private:
  uint64_t width() const { return static_cast<uint64_t>(plan_.width); }
  uint64_t height() const { return static_cast<uint64_t>(plan_.height); }

  static std::string key(const char* kind, int number) {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%s%010d", kind, number);
    return text.data();
  }

  template <class Value>
  static void add_list(NpzFile& file, const char* name, const char* descr, const std::vector<Value>& values) {
    std::vector<uint8_t> bytes;
    for (const Value value : values) put_item(bytes, value);
    const std::array<uint64_t, 1> shape{values.size()};
    file.add_array(name, descr, shape, bytes);
  }

  /// Blue, green, red, as OpenCV has them.
  void add_picture(NpzFile& file, const char* kind, int number, const Image& image) const {
    std::vector<uint8_t> codes = screen_codes(image, plan_.view, 3);
    for (size_t i = 0; i < codes.size(); i += 3) std::swap(codes[i], codes[i + 2]);
    const std::array<uint64_t, 3> shape{height(), width(), 3};
    file.add_array(key(kind, number), kByte, shape, codes);
  }

  /// What is not known is not a number.
  void add_flow(const Moment& moment) {
    const auto &u = moment.flow->find("flow.u")->values, &v = moment.flow->find("flow.v")->values,
               &state = moment.flow->find("flow.state")->values;
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < u.size(); ++i) {
      put_item(bytes, state[i] > 0 ? u[i] : kNone);
      put_item(bytes, state[i] > 0 ? v[i] : kNone);
    }
    const std::array<uint64_t, 3> shape{height(), width(), 2};
    flow_.add_array(key("flow_", moment.number), "'<f4'", shape, bytes);
    flow_from_.push_back(static_cast<double>(moment.time) * 1e-9);
    flow_to_.push_back(static_cast<double>(moment.next) * 1e-9);
  }

  ordered_json meta(double cx, double cy) const {
    ordered_json json;
    json["frames"] = frames_;
    json["full_trajectory"] = trajectory_;
    json["imu"] = ordered_json::object();
    json["meta"] = {{"cx", cx},
                    {"cy", cy},
                    {"dist_model", "radtan"},
                    {"fx", plan_.lens.fx},
                    {"fy", plan_.lens.fy},
                    {"k1", 0.0},
                    {"k2", 0.0},
                    {"k3", 0.0},
                    {"k4", 0.0},
                    {"p1", 0.0},
                    {"p2", 0.0},
                    {"res_x", plan_.width},
                    {"res_y", plan_.height},
                    {"ros_time_offset", static_cast<double>(plan_.file.epoch) * 1e-9}};
    return json;
  }

  FolderPlan plan_;
  Evimo2Events events_;
  NpzFile classical_, depth_, mask_, flow_;
  std::unique_ptr<NpzFile> sharp_;
  std::vector<double> flow_from_, flow_to_;
  ordered_json frames_ = ordered_json::array(), trajectory_ = ordered_json::array();
};

}  // namespace

std::unique_ptr<FolderLayout> make_evimo2_layout(const FolderPlan& plan) {
  return std::make_unique<Evimo2Layout>(plan);
}

}  // namespace kairos
