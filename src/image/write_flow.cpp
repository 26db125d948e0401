// Files of optical flow: Middlebury's .flo, and the PNGs of KITTI and Sintel.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <kairos/error.h>
#include <kairos/files.h>
#include <kairos/flow.h>

#include "image/encode.h"
#include "image/write_image.h"

namespace kairos {

namespace {

constexpr float kFloTag = 202021.25f;  // whose bytes are "PIEH"
constexpr float kFloUnknown = 1e10f;   // readers take what is above 1e9 for unknown
// KITTI's codes: 64 a pixel, from -512 on.
constexpr double kCodesPerPixel = 64, kCodeOfZero = 32768, kMostFlowCode = 65535;

struct FlowChannels {
  const std::vector<float>&u, &v, &state;

  bool known(size_t pixel) const { return state[pixel] != static_cast<float>(FlowState::unknown); }
};

FlowChannels channels_of(const Image& image) {
  const Channel *u = image.find("flow.u"), *v = image.find("flow.v"), *state = image.find("flow.state");
  if (u == nullptr || v == nullptr || state == nullptr)
    throw Error(ErrorCode::bad_usage, "", "the image holds no flow");
  return {u->values, v->values, state->values};
}

std::string flo_bytes(const Image& image, const FlowChannels& flow) {
  static_assert(std::endian::native == std::endian::little, "numbers of the file are written as they lie in memory");
  std::string bytes;
  const auto add = [&](const auto& number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof number); };
  add(kFloTag);
  add(static_cast<int32_t>(image.width));
  add(static_cast<int32_t>(image.height));
  for (size_t i = 0; i < flow.u.size(); ++i) {
    add(flow.known(i) ? flow.u[i] : kFloUnknown);
    add(flow.known(i) ? flow.v[i] : kFloUnknown);
  }
  return bytes;
}

std::vector<uint8_t> kitti_bytes(const Image& image, const FlowChannels& flow, const std::string& path) {
  std::vector<uint8_t> codes;
  codes.reserve(flow.u.size() * 6);
  const auto add = [&](double code) {
    const auto number = static_cast<uint16_t>(code);
    codes.push_back(static_cast<uint8_t>(number >> 8));  // PNG's numbers are big endian
    codes.push_back(static_cast<uint8_t>(number & 0xff));
  };
  for (size_t i = 0; i < flow.u.size(); ++i) {
    const double u = std::round(static_cast<double>(flow.u[i]) * kCodesPerPixel) + kCodeOfZero,
                 v = std::round(static_cast<double>(flow.v[i]) * kCodesPerPixel) + kCodeOfZero;
    const bool valid = flow.known(i) && std::min(u, v) >= 0 && std::max(u, v) <= kMostFlowCode;
    add(valid ? u : 0);
    add(valid ? v : 0);
    add(valid ? 1 : 0);
  }
  return encode_png16(codes, image.width, image.height, path);
}

std::string_view text_of(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void check_writable_flow(const std::string& path) {
  if (has_extension(path, ".flo")) return check_writable(path);
  try {
    check_writable_image(path);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::bad_usage) throw;
    throw Error(ErrorCode::bad_usage, path, "cannot tell the format of flow; end the name in .flo, .png or .exr");
  }
}

void write_flow(const Image& image, const std::string& path) {
  check_writable_flow(path);
  const FlowChannels flow = channels_of(image);
  if (has_extension(path, ".flo")) return write_file(path, flo_bytes(image, flow));
  if (has_extension(path, ".png")) return write_file(path, text_of(kitti_bytes(image, flow, path)));
  write_image(image, path);
}

void write_occlusion(const Image& image, const std::string& path) {
  if (!has_extension(path, ".png")) throw Error(ErrorCode::bad_usage, path, "must end in .png");
  const FlowChannels flow = channels_of(image);
  std::vector<uint8_t> codes;
  for (const float state : flow.state) codes.push_back(state == static_cast<float>(FlowState::seen) ? 0 : 255);
  write_file(path, text_of(encode_png(codes, image.width, image.height, 1, path)));
}

}  // namespace kairos
