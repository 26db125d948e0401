// Files of optical flow and disparity: Middlebury's .flo, and the PNGs of KITTI, DSEC and Sintel.
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
constexpr double kCodeOfZero = 32768, kMostCode16 = 65535;

double codes_per_pixel(FlowCodes codes) { return codes == FlowCodes::dsec ? 128 : 64; }

void add_big_endian(std::vector<uint8_t>& bytes, double code) {  // as PNG's numbers are
  const auto number = static_cast<uint16_t>(code);
  bytes.push_back(static_cast<uint8_t>(number >> 8));
  bytes.push_back(static_cast<uint8_t>(number & 0xff));
}

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

std::vector<uint8_t> png_bytes(const Image& image, const FlowChannels& flow, FlowCodes kind, const std::string& path) {
  std::vector<uint8_t> codes;
  codes.reserve(flow.u.size() * 6);
  const double per_pixel = codes_per_pixel(kind);
  for (size_t i = 0; i < flow.u.size(); ++i) {
    const double u = std::round(static_cast<double>(flow.u[i]) * per_pixel) + kCodeOfZero,
                 v = std::round(static_cast<double>(flow.v[i]) * per_pixel) + kCodeOfZero;
    const bool valid = flow.known(i) && std::min(u, v) >= 0 && std::max(u, v) <= kMostCode16;
    add_big_endian(codes, valid ? u : 0);
    add_big_endian(codes, valid ? v : 0);
    add_big_endian(codes, valid ? 1 : 0);
  }
  return encode_png16(codes, image.width, image.height, 3, path);
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

void write_flow(const Image& image, const std::string& path, FlowCodes codes) {
  check_writable_flow(path);
  const FlowChannels flow = channels_of(image);
  if (has_extension(path, ".flo")) return write_file(path, flo_bytes(image, flow));
  if (has_extension(path, ".png")) return write_file(path, text_of(png_bytes(image, flow, codes, path)));
  write_image(image, path);
}

void write_disparity(const Image& image, double focal_baseline, const std::string& path) {
  if (!has_extension(path, ".png")) throw Error(ErrorCode::bad_usage, path, "must end in .png");
  const Channel* const depth = image.find("depth.Z");
  if (depth == nullptr) throw Error(ErrorCode::bad_usage, path, "the image holds no depth");
  constexpr double kPerPixel = 256;
  std::vector<uint8_t> codes;
  codes.reserve(depth->values.size() * 2);
  for (const float z : depth->values) {
    const double code = std::round(kPerPixel * focal_baseline / static_cast<double>(z));
    add_big_endian(codes, code >= 0 && code <= kMostCode16 ? code : 0);
  }
  write_file(path, text_of(encode_png16(codes, image.width, image.height, 1, path)));
}

void write_occlusion(const Image& image, const std::string& path) {
  if (!has_extension(path, ".png")) throw Error(ErrorCode::bad_usage, path, "must end in .png");
  const FlowChannels flow = channels_of(image);
  std::vector<uint8_t> codes;
  for (const float state : flow.state) codes.push_back(state == static_cast<float>(FlowState::seen) ? 0 : 255);
  write_file(path, text_of(encode_png(codes, image.width, image.height, 1, path)));
}

}  // namespace kairos
