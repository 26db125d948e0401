// A value in a JSON file that knows where it is, so that every complaint names the place.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <kairos/vec.h>

namespace kairos {

/// Refers to a value that outlives it. Each reader throws Error(bad_input, "file: path.to[3].value") when the value is
/// of another kind than asked for.
class JsonNode {
 public:
  JsonNode(const nlohmann::json& value, std::string file, std::string path = {})
      : value_(value), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& what) const;
  std::string place() const { return path_.empty() ? file_ : file_ + ": " + path_; }

  bool is_object() const { return value_.is_object(); }
  /// An object that has none but these fields.
  void expect_fields(std::initializer_list<const char*> known) const;
  std::optional<JsonNode> find(const char* field) const;
  JsonNode at(const char* field) const;  ///< throws when the field is missing
  std::vector<std::pair<std::string, JsonNode>> fields() const;
  std::vector<JsonNode> items() const;  ///< of an array
  std::vector<JsonNode> items(size_t count) const;

  std::string string() const;
  bool boolean() const;
  double number() const;  ///< finite
  double number(double low, double high) const;
  int integer(int low, int high) const;
  double time() const;  ///< in the file's own unit; not so large that differences lose their meaning
  Vec3d vec3() const;   ///< three numbers, each within the range of float
  Vec3f color() const;  ///< three numbers from 0 on

 private:
  const nlohmann::json& value_;
  std::string file_, path_;
};

}  // namespace kairos
