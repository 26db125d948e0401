// The list of typed, named values that ends most pbrt statements.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <kairos/vec.h>

#include "scene_io/pbrt/tokens.h"

namespace kairos::pbrt {

struct Parameter {
  std::string type, name;
  std::vector<double> numbers;       ///< may be not finite
  std::vector<std::string> strings;  ///< also of booleans: "true" or "false"
  size_t line = 0;
  mutable bool used = false;  ///< has someone asked for it?
};

class Parameters {
 public:
  Parameters() = default;
  /// Reads until something follows that is no parameter. Throws Error(bad_input) for malformed ones.
  explicit Parameters(Tokens& tokens);

  /// Appends those of `defaults` that are not here under that name.
  void add_missing(const std::vector<Parameter>& defaults);
  std::vector<Parameter> take_all() { return std::move(list_); }

  /// The one of that name, or nullptr. Counts as used. An empty type stands for any.
  const Parameter* find(std::string_view name, std::string_view type = {}) const;

  /// Each gives `otherwise` where there is no such parameter and throws Error(bad_input) where it is of another kind,
  /// not finite, or not one value.
  double number(std::string_view name, double otherwise) const;
  int64_t integer(std::string_view name, int64_t otherwise) const;
  bool boolean(std::string_view name, bool otherwise) const;
  std::string string(std::string_view name, const std::string& otherwise) const;
  Vec3d vec3(std::string_view name, Vec3d otherwise) const;

  /// Points, normals or texture coordinates; empty where there are none. Numbers that are not finite come through.
  std::vector<Vec3f> vec3_list(std::string_view name) const;
  std::vector<Vec2f> vec2_list(std::string_view name) const;
  /// Indices: what is no index becomes kBadIndex.
  std::vector<uint32_t> index_list(std::string_view name) const;

  /// Warns of what nobody asked for, as "parameter 'x' of `whose` is left out".
  void warn_unused(const std::string& whose, Warnings& warnings) const;

  Place place(const Parameter& parameter) const { return {file_, parameter.line}; }
  const Place& place() const { return place_; }  ///< where the list begins

 private:
  const std::vector<double>& numbers(const Parameter& parameter, size_t multiple) const;

  std::string file_;
  Place place_;
  std::vector<Parameter> list_;
};

}  // namespace kairos::pbrt
