// The JSON at the head of a file.
#include <cmath>

#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/names.h>

#include "time_io/file_layout.h"

namespace kairos {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json attribute_json(const Attribute& attribute) {
  return std::visit([](const auto& value) { return ordered_json(value); }, attribute.value);
}

/// False for what no attribute is.
bool parse_attribute(const json& value, Attribute& out) {
  if (value.is_string())
    out.value = value.get<std::string>();
  else if (value.is_number_integer() && value.get<int64_t>() == static_cast<int>(value.get<int64_t>()))
    out.value = static_cast<int>(value.get<int64_t>());
  else if (value.is_number())
    out.value = value.get<double>();
  else if (value.is_array() && std::all_of(value.begin(), value.end(), [](const json& v) { return v.is_string(); }))
    out.value = value.get<std::vector<std::string>>();
  else if (value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number())
    out.value = value.get<std::array<double, 2>>();
  else
    return false;
  return true;
}

template <size_t kCount, class Number>
std::array<Number, kCount> numbers(const json& object, const char* name) {
  return object.at(name).get<std::array<Number, kCount>>();
}

/// What a picture cannot be; empty when it can.
const char* fault(const FileDescription& d) {
  const TimeFrame& f = d.frame;
  constexpr int kMostSide = 1 << 20;
  for (const int side : {f.width, f.height, f.frame_width, f.frame_height})
    if (side < 1 || side > kMostSide) return "sizes";
  if (f.left < 0 || f.top < 0 || f.left > f.frame_width - f.width || f.top > f.frame_height - f.height) return "crop";
  if (static_cast<uint64_t>(f.width) * static_cast<uint64_t>(f.height) > kMostFilePixels) return "sizes";
  for (const double number : {f.open, f.close, f.frame_time, f.fps, f.pixel_aspect, d.tolerance})
    if (!std::isfinite(number)) return "numbers";
  if (f.open > f.close || !(f.fps > 0) || !(f.pixel_aspect > 0)) return "times";
  const uint64_t tiles = TileGrid{f.width, f.height}.count();
  if (d.slabs < 1 || d.slabs > std::min(kMostSlabs, kMostFileTiles / tiles) || (d.slabs > 1 && !(f.open < f.close)))
    return "slabs";
  if (d.tolerance != 0 && !(d.tolerance >= kLeastTolerance && d.tolerance <= 1)) return "tolerance";
  return nullptr;
}

}  // namespace

std::string description_text(const FileDescription& description) {
  const TimeFrame& frame = description.frame;
  ordered_json root;
  root["kairos_time"] = 1;
  root["frame"] = {frame.frame_width, frame.frame_height};
  root["crop"] = {frame.left, frame.left + frame.width, frame.top, frame.top + frame.height};
  root["shutter_s"] = {frame.open, frame.close};
  if (description.slabs > 1) root["slabs"] = description.slabs;
  root["frame_time_s"] = frame.frame_time;
  root["fps"] = frame.fps;
  root["pixel_aspect"] = frame.pixel_aspect;
  root["channels"] = {"R", "G", "B", "A"};
  root["colour"] = "linear Rec. 709, scene-referred; A is coverage";
  root["alpha"] = frame.alpha;
  root["view"] = to_string(frame.view);
  root["tolerance"] = description.tolerance;
  root["tolerance_unit"] = description.slabs > 1 ? "a slab's time x max(1, mean of the channel)"
                                                 : "shutter time x max(1, mean of the channel)";
  root["mark"] = description.mark;
  if (description.objects) {
    root["objects"] = ordered_json::array();
    for (const TimeFrame::Object& object : frame.objects)
      root["objects"].push_back({{"name", object.name}, {"material", object.material}});
    root["materials"] = frame.materials;
  }
  if (description.rays) {
    root["rays"] = true;
    root["meshes"] = description.meshes;
  }
  if (description.geometry_bytes > 0) root["geometry_bytes"] = description.geometry_bytes;
  root["attributes"] = ordered_json::object();
  for (const Attribute& attribute : frame.attributes) root["attributes"][attribute.name] = attribute_json(attribute);
  std::string text = root.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
  text.resize(aligned(text.size()), ' ');
  return text;
}

FileDescription parse_description(const std::string& text, const std::string& path) {
  const auto refuse = [&](const std::string& what) -> Error {
    return {ErrorCode::bad_input, path, "its description is not usable (" + what + "); render it again"};
  };
  FileDescription description;
  TimeFrame& frame = description.frame;
  try {
    const json root = json::parse(text);
    const auto size = numbers<2, int>(root, "frame");
    const auto crop = numbers<4, int>(root, "crop");
    const auto shutter = numbers<2, double>(root, "shutter_s");
    frame.frame_width = size[0];
    frame.frame_height = size[1];
    constexpr int kFar = 1 << 21;
    for (const int edge : crop)
      if (edge < 0 || edge > kFar) throw refuse("crop");
    frame.left = crop[0];
    frame.width = crop[1] - crop[0];
    frame.top = crop[2];
    frame.height = crop[3] - crop[2];
    frame.open = shutter[0];
    frame.close = shutter[1];
    description.slabs = root.value("slabs", uint32_t{1});
    frame.frame_time = root.at("frame_time_s").get<double>();
    frame.fps = root.at("fps").get<double>();
    frame.pixel_aspect = root.at("pixel_aspect").get<double>();
    frame.alpha = root.value("alpha", false);
    frame.view =
        root.value("view", "") == to_string(ViewTransform::filmic) ? ViewTransform::filmic : ViewTransform::standard;
    description.tolerance = root.at("tolerance").get<double>();
    description.mark = root.at("mark").get<std::string>();
    description.objects = root.contains("objects");
    if (description.objects) {
      for (const json& object : root.at("objects"))
        frame.objects.push_back({object.at("name").get<std::string>(), object.at("material").get<uint32_t>()});
      frame.materials = root.at("materials").get<std::vector<std::string>>();
    }
    description.rays = root.value("rays", false);
    description.meshes = root.value("meshes", uint64_t{0});
    description.geometry_bytes = root.value("geometry_bytes", uint64_t{0});
    if (description.geometry_bytes > kMostGeometryBytes) throw refuse("geometry");
    for (const auto& [name, value] : root.at("attributes").items()) {
      Attribute attribute{name, {}};
      if (!parse_attribute(value, attribute)) throw refuse("attribute");
      frame.attributes.push_back(std::move(attribute));
    }
  } catch (const json::exception&) {
    throw refuse("not the JSON that it should be");
  }
  if (const char* what = fault(description)) throw refuse(what);
  return description;
}

}  // namespace kairos
