#include "scene_io/pbrt/parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "scene_io/mesh_data.h"
#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {

void take_value(Tokens& tokens, Parameter& parameter) {
  const Place place = tokens.place();
  const Token token = tokens.take();
  double number = 0;
  if (token.kind == Token::Kind::string)
    parameter.strings.push_back(unescape(token.text));
  else if (token.kind == Token::Kind::word && parse_number(token.text, number))
    parameter.numbers.push_back(number);
  else if (token.kind == Token::Kind::word && (token.text == "true" || token.text == "false"))
    parameter.strings.emplace_back(token.text);
  else
    fail(place, "'" + printable(token.text) + "' stands where a value of '" + printable(parameter.name) + "' should");
}

/// "type name", with any space between.
bool split_declaration(const std::string& text, Parameter& parameter) {
  constexpr const char* kSpace = " \t";
  const size_t type = text.find_first_not_of(kSpace);
  if (type == text.npos) return false;
  const size_t type_end = text.find_first_of(kSpace, type);
  const size_t name = text.find_first_not_of(kSpace, type_end);
  if (type_end == text.npos || name == text.npos) return false;
  parameter.type = text.substr(type, type_end - type);
  parameter.name = text.substr(name, text.find_first_of(kSpace, name) - name);
  return true;
}

}  // namespace

Parameters::Parameters(Tokens& tokens) : file_(tokens.file()), place_(tokens.place()) {
  while (tokens.peek().kind == Token::Kind::string) {
    Parameter parameter;
    parameter.line = tokens.peek().line;
    const std::string declaration = tokens.take_string();
    if (!split_declaration(declaration, parameter))
      fail({file_, parameter.line}, "'" + printable(declaration) + "' stands where a parameter's \"type name\" should");
    if (tokens.peek().kind == Token::Kind::open) {
      tokens.take();
      while (tokens.peek().kind != Token::Kind::close) {
        if (tokens.peek().kind == Token::Kind::end)
          fail(tokens.place(), fmt::format("the list of '{}' that begins in line {} does not end",
                                           printable(parameter.name), parameter.line));
        take_value(tokens, parameter);
      }
      tokens.take();
    } else {
      take_value(tokens, parameter);
    }
    list_.push_back(std::move(parameter));
  }
}

void Parameters::add_missing(const std::vector<Parameter>& defaults) {
  for (const Parameter& parameter : defaults)
    if (std::none_of(list_.begin(), list_.end(), [&](const Parameter& own) { return own.name == parameter.name; })) {
      list_.push_back(parameter);
      list_.back().used = true;  // not every statement needs to know what applies to many
    }
}

const Parameter* Parameters::find(std::string_view name, std::string_view type) const {
  for (const Parameter& parameter : list_)
    if (parameter.name == name && (type.empty() || parameter.type == type)) {
      parameter.used = true;
      return &parameter;
    }
  return nullptr;
}

const std::vector<double>& Parameters::numbers(const Parameter& parameter, size_t multiple) const {
  if (!parameter.strings.empty() || parameter.numbers.size() % multiple != 0)
    fail(place(parameter), fmt::format("'{}' has {} values; it needs numbers, {} for each", printable(parameter.name),
                                       parameter.numbers.size() + parameter.strings.size(), multiple));
  return parameter.numbers;
}

double Parameters::number(std::string_view name, double otherwise) const {
  const Parameter* found = find(name);
  if (!found) return otherwise;
  if (found->numbers.size() != 1 || !found->strings.empty() || !std::isfinite(found->numbers[0]))
    fail(place(*found), "'" + printable(name) + "' needs one finite number");
  return found->numbers[0];
}

int64_t Parameters::integer(std::string_view name, int64_t otherwise) const {
  const double value = number(name, static_cast<double>(otherwise));
  constexpr double kLargestWhole = 9007199254740992;  // every integer up to here is a double
  if (value != std::floor(value) || std::abs(value) > kLargestWhole)
    fail(place(*find(name)), "'" + printable(name) + "' needs an integer");
  return static_cast<int64_t>(value);
}

bool Parameters::boolean(std::string_view name, bool otherwise) const {
  const Parameter* found = find(name);
  if (!found) return otherwise;
  if (found->strings.size() != 1 || (found->strings[0] != "true" && found->strings[0] != "false"))
    fail(place(*found), "'" + printable(name) + "' needs true or false");
  return found->strings[0] == "true";
}

std::string Parameters::string(std::string_view name, const std::string& otherwise) const {
  const Parameter* found = find(name);
  if (!found) return otherwise;
  if (found->strings.size() != 1 || !found->numbers.empty())
    fail(place(*found), "'" + printable(name) + "' needs one string");
  return found->strings[0];
}

Vec3d Parameters::vec3(std::string_view name, Vec3d otherwise) const {
  const Parameter* found = find(name);
  if (!found) return otherwise;
  const std::vector<double>& n = numbers(*found, 3);
  if (n.size() != 3 || !is_finite(Vec3d{n[0], n[1], n[2]}))
    fail(place(*found), "'" + printable(name) + "' needs three finite numbers");
  return {n[0], n[1], n[2]};
}

std::vector<Vec3f> Parameters::vec3_list(std::string_view name) const {
  const Parameter* found = find(name);
  if (!found) return {};
  const std::vector<double>& n = numbers(*found, 3);
  std::vector<Vec3f> list(n.size() / 3);
  for (size_t i = 0; i < list.size(); ++i) list[i] = to_float({n[3 * i], n[3 * i + 1], n[3 * i + 2]});
  return list;
}

std::vector<Vec2f> Parameters::vec2_list(std::string_view name) const {
  const Parameter* found = find(name);
  if (!found) return {};
  const std::vector<double>& n = numbers(*found, 2);
  std::vector<Vec2f> list(n.size() / 2);
  for (size_t i = 0; i < list.size(); ++i) list[i] = {static_cast<float>(n[2 * i]), static_cast<float>(n[2 * i + 1])};
  return list;
}

std::vector<uint32_t> Parameters::index_list(std::string_view name) const {
  const Parameter* found = find(name);
  if (!found) return {};
  std::vector<uint32_t> list;
  list.reserve(found->numbers.size());
  for (const double number : numbers(*found, 1)) {
    const bool usable = number >= 0 && number < static_cast<double>(kMaxIndices) && number == std::floor(number);
    list.push_back(usable ? static_cast<uint32_t>(number) : kBadIndex);
  }
  return list;
}

void Parameters::warn_unused(const std::string& whose, Warnings& warnings) const {
  for (const Parameter& parameter : list_)
    if (!parameter.used)
      warnings.add(place(parameter), "parameter '" + printable(parameter.name) + "' of " + whose + " is left out");
}

}  // namespace kairos::pbrt
