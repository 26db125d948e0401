#include "scene_io/gltf/members.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/printable.h>

#include "scene_io/gltf/text.h"

namespace kairos::gltf {

namespace {

using nlohmann::json;

constexpr uint64_t kLargestIndex = std::numeric_limits<int32_t>::max();
constexpr uint64_t kLargestSize = uint64_t{1} << 53;  // what a JSON number surely holds

}  // namespace

Members::Members(json& root, std::string document, Warnings& warnings)
    : object_(root), document_(std::move(document)), warnings_(warnings) {
  if (!root.is_object()) throw Error(ErrorCode::bad_input, document_, "is not a JSON object");
}

Members::Members(json& value, const Members& parent, const char* key, std::optional<size_t> element)
    : object_(value), parent_(&parent), key_(key), element_(element), warnings_(parent.warnings_) {
  if (!value.is_object()) fail("must be an object");
}

std::string Members::place() const {
  if (!parent_) return "";
  const std::string above = parent_->place();
  return (above.empty() ? "" : above + ".") + printable(key_) + (element_ ? fmt::format("[{}]", *element_) : "");
}

void Members::fail(const std::string& what) const {
  const Members* root = this;
  while (root->parent_) root = root->parent_;
  const std::string here = place();
  throw Error(ErrorCode::bad_input, root->document_ + (here.empty() ? "" : ": " + here), what);
}

void Members::refuse(const std::string& member, const std::string& what) const {
  const Members* root = this;
  while (root->parent_) root = root->parent_;
  const std::string here = place();
  throw Error(ErrorCode::bad_input, root->document_ + ": " + (here.empty() ? "" : here + ".") + member, what);
}

void Members::expected(const char* what, const std::string& member) const {
  refuse(member, std::string("must be ") + what);
}

void Members::need(const char* key) const {
  if (!has(key)) fail(std::string(key) + " is missing");
}

std::optional<json> Members::take(const char* key) {
  const auto found = object_.find(key);
  if (found == object_.end()) return std::nullopt;
  json value = std::move(*found);
  object_.erase(found);
  return value;
}

uint64_t Members::whole(const json& value, uint64_t largest, const std::string& member) const {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number >= 0 && number <= static_cast<double>(largest) && number == std::floor(number))
      return static_cast<uint64_t>(number);
  }
  if (!value.is_number_unsigned()) expected("a whole number that is not negative", member);
  const auto number = value.get<uint64_t>();
  if (number > largest) refuse(member, "is larger than " + std::to_string(largest));
  return number;
}

int Members::index(const char* key, int otherwise) {
  const auto value = take(key);
  return value ? static_cast<int>(whole(*value, kLargestIndex, key)) : otherwise;
}

uint64_t Members::size(const char* key, uint64_t otherwise) {
  const auto value = take(key);
  return value ? whole(*value, kLargestSize, key) : otherwise;
}

double Members::number(const char* key, double otherwise) {
  const auto value = take(key);
  if (value && !value->is_number()) expected("a number", key);
  return value ? value->get<double>() : otherwise;
}

std::string Members::text(const char* key, const std::string& otherwise) {
  const auto value = take(key);
  if (value && !value->is_string()) expected("a string", key);
  return value ? value->get<std::string>() : otherwise;
}

bool Members::flag(const char* key, bool otherwise) {
  const auto value = take(key);
  if (value && !value->is_boolean()) expected("true or false", key);
  return value ? value->get<bool>() : otherwise;
}

void Members::check_array(const json& value, const char* key) const {
  if (!value.is_array()) expected("an array", key);
}

template <class Read>
void Members::each_value(const char* key, const Read& read) {
  const auto value = take(key);
  if (!value) return;
  check_array(*value, key);
  for (size_t i = 0; i < value->size(); ++i) read((*value)[i], fmt::format("{}[{}]", key, i));
}

std::vector<int> Members::indices(const char* key) {
  std::vector<int> result;
  each_value(key, [&](const json& value, const std::string& member) {
    result.push_back(static_cast<int>(whole(value, kLargestIndex, member)));
  });
  return result;
}

std::vector<double> Members::numbers(const char* key, const std::vector<double>& otherwise) {
  if (!has(key)) return otherwise;
  std::vector<double> result;
  each_value(key, [&](const json& value, const std::string& member) {
    if (!value.is_number()) expected("a number", member);
    result.push_back(value.get<double>());
  });
  return result;
}

std::vector<double> Members::as_many_numbers(const char* key, const std::vector<double>& otherwise) {
  std::vector<double> result = numbers(key, otherwise);
  if (result.size() != otherwise.size())
    fail(fmt::format("its {} has {} numbers instead of {}", key, result.size(), otherwise.size()));
  return result;
}

std::vector<std::string> Members::texts(const char* key) {
  std::vector<std::string> result;
  each_value(key, [&](const json& value, const std::string& member) {
    if (!value.is_string()) expected("a string", member);
    result.push_back(value.get<std::string>());
  });
  return result;
}

std::map<std::string, int> Members::named_indices(const char* key) {
  std::map<std::string, int> result;
  const auto value = take(key);
  if (!value) return result;
  if (!value->is_object()) expected("an object", key);
  for (const auto& [name, index] : value->items())
    result[name] = static_cast<int>(whole(index, kLargestIndex, std::string(key) + "." + printable(name)));
  return result;
}

std::map<std::string, int> Members::all_indices() {
  std::map<std::string, int> result;
  for (const auto& [name, index] : object_.items())
    result[name] = static_cast<int>(whole(index, kLargestIndex, printable(name)));
  object_.clear();
  return result;
}

std::vector<double> Members::numbers_or_number(const char* key) {
  const auto value = take(key);
  std::vector<double> result;
  if (value && value->is_number()) result.push_back(value->get<double>());
  if (value && value->is_array())
    for (const json& part : *value)
      if (part.is_number()) result.push_back(part.get<double>());
  return result;
}

const json* Members::peek(const char* key) const {
  const auto found = object_.find(key);
  return found == object_.end() ? nullptr : &*found;
}

void Members::lose(const char* key, const std::string& what) {
  if (object_.erase(key) > 0) warnings_.add(place(), what);
}

void Members::report_rest() {
  for (const auto& [key, value] : object_.items()) {
    if (key == "extras" || key == "name") continue;
    if (key == "extensions" && value.is_object()) {
      for (const auto& [name, unused] : value.items())
        warnings_.add(place(), "the extension '" + printable(name) + "' is left out");
    } else {
      warnings_.add(place(), "'" + printable(key) +
                                 "' is left out: it is nothing that glTF 2.0 has there, or nothing "
                                 "that is read");
    }
  }
}

}  // namespace kairos::gltf
