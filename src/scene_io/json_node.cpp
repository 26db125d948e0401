#include "scene_io/json_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <kairos/error.h>

#include "scene_io/text_numbers.h"

namespace kairos {

using nlohmann::json;

void JsonNode::fail(const std::string& what) const { throw Error(ErrorCode::bad_input, place(), what); }

void JsonNode::expect_fields(std::initializer_list<const char*> known) const {
  for (const auto& [name, node] : fields())
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail(fmt::format("unknown field '{}'; expected any of: {}", printable(name), fmt::join(known, ", ")));
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::fields() const {
  if (!value_.is_object()) fail(fmt::format("expected an object, found {}", value_.type_name()));
  std::vector<std::pair<std::string, JsonNode>> all;
  for (const auto& [name, value] : value_.items())
    all.emplace_back(name, JsonNode(value, file_, (path_.empty() ? "" : path_ + ".") + printable(name)));
  return all;
}

std::optional<JsonNode> JsonNode::find(const char* field) const {
  const auto found = value_.find(field);
  if (found == value_.end()) return {};
  return JsonNode(*found, file_, (path_.empty() ? "" : path_ + ".") + field);
}

JsonNode JsonNode::at(const char* field) const {
  if (const auto found = find(field)) return *found;
  fail(fmt::format("the field '{}' is missing", field));
}

std::vector<JsonNode> JsonNode::items() const {
  if (!value_.is_array()) fail(fmt::format("expected an array, found {}", value_.type_name()));
  std::vector<JsonNode> all;
  all.reserve(value_.size());
  for (size_t i = 0; i < value_.size(); ++i) all.emplace_back(value_[i], file_, fmt::format("{}[{}]", path_, i));
  return all;
}

std::vector<JsonNode> JsonNode::items(size_t count) const {
  std::vector<JsonNode> all = items();
  if (all.size() != count) fail(fmt::format("expected {} values, found {}", count, all.size()));
  return all;
}

std::string JsonNode::string() const {
  if (!value_.is_string()) fail(fmt::format("expected a string, found {}", value_.type_name()));
  const auto& text = value_.get_ref<const std::string&>();
  // Names and paths are shown in messages and logs, one line each.
  if (std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }))
    fail("holds a control character");
  return text;
}

bool JsonNode::boolean() const {
  if (!value_.is_boolean()) fail(fmt::format("expected true or false, found {}", value_.type_name()));
  return value_.get<bool>();
}

double JsonNode::number() const {
  if (!value_.is_number()) fail(fmt::format("expected a number, found {}", value_.type_name()));
  const double value = value_.get<double>();
  if (!std::isfinite(value)) fail("expected a finite number");
  return value;
}

double JsonNode::number(double low, double high) const {
  const double value = number();
  if (!(value >= low && value <= high)) fail(fmt::format("{} is not between {} and {}", value, low, high));
  return value;
}

int JsonNode::integer(int low, int high) const {
  const double value = number(low, high);
  if (value != std::floor(value)) fail(fmt::format("{} is not a whole number", value));
  return static_cast<int>(value);
}

double JsonNode::time() const {
  constexpr double kMaxTime = 1e12;
  return number(-kMaxTime, kMaxTime);
}

Vec3d JsonNode::vec3() const {
  const std::vector<JsonNode> xyz = items(3);
  constexpr double kLimit = std::numeric_limits<float>::max();
  return {xyz[0].number(-kLimit, kLimit), xyz[1].number(-kLimit, kLimit), xyz[2].number(-kLimit, kLimit)};
}

Vec3f JsonNode::color() const {
  const Vec3d rgb = vec3();
  if (rgb.x < 0 || rgb.y < 0 || rgb.z < 0) fail("a colour cannot be negative");
  return to_float(rgb);
}

}  // namespace kairos
