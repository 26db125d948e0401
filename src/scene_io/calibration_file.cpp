#include "scene_io/calibration_file.h"

#include <cmath>

#include <kairos/files.h>
#include <kairos/names.h>

#include "base/file.h"
#include "scene_io/json_node.h"
#include "scene_io/json_text.h"

namespace kairos {

namespace {

constexpr int kVersion = 1;
constexpr uint64_t kMaxBytes = 1u << 16;
// Nanoseconds that a ray may take, and how far rays may be apart: what lies outside was not measured.
constexpr double kLeastTime = 1e-3, kMostTime = 1e9, kMostRatio = 1e6;

}  // namespace

CalibrationFile parse_calibration(std::string_view text, const std::string& path) {
  const JsonText json(text, path);
  const JsonNode root(json.root(), path);
  root.expect_fields({"kairos_calibration", "shading", "nanoseconds"});
  const JsonNode version = root.at("kairos_calibration");
  if (version.number() != kVersion) version.fail("only version 1 is known; measure again");
  CalibrationFile file;
  const JsonNode shading = root.at("shading");
  const std::optional<ShadingKind> kind = parse<ShadingKind>(shading.string());
  if (!kind) shading.fail("must be the name of a shading");
  file.shading = *kind;
  const JsonNode times = root.at("nanoseconds");
  times.expect_fields({"discrete_sample", "still_ray", "tc_ray"});
  Calibration& calibration = file.calibration;
  calibration.discrete_sample = times.at("discrete_sample").number(kLeastTime, kMostTime);
  const auto ratio = [&](const JsonNode& node, double least) {
    const double time = node.number(least, kMostTime), units = time / calibration.discrete_sample;
    if (units > kMostRatio || (least > 0 && units < 1 / kMostRatio))
      node.fail("is a million times off discrete_sample; measure again");
    return time;
  };
  calibration.still_ray = ratio(times.at("still_ray"), 0);
  const JsonNode rays = times.at("tc_ray");
  rays.expect_fields({"1", "4", "16"});
  for (size_t i = 0; i < Calibration::kRays.size(); ++i)
    calibration.tc_ray[i] = ratio(rays.at(std::to_string(Calibration::kRays[i]).c_str()), kLeastTime);
  return file;
}

CalibrationFile read_calibration(const std::string& path) {
  const std::vector<uint8_t> bytes = read_file(path, kMaxBytes);
  return parse_calibration({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

void write_calibration(const CalibrationFile& file, const std::string& path) {
  write_file(path, calibration_text(file));
}

std::string calibration_text(const CalibrationFile& file) {
  nlohmann::ordered_json json;
  json["kairos_calibration"] = kVersion;
  json["shading"] = to_string(file.shading);
  nlohmann::ordered_json& times = json["nanoseconds"];
  times["discrete_sample"] = file.calibration.discrete_sample;
  times["still_ray"] = file.calibration.still_ray;
  for (size_t i = 0; i < Calibration::kRays.size(); ++i)
    times["tc_ray"][std::to_string(Calibration::kRays[i])] = file.calibration.tc_ray[i];
  return json.dump(2) + "\n";
}

}  // namespace kairos
