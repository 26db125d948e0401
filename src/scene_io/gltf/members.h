// Members of the objects in a glTF file's JSON, taken out one by one: what is still there in the end was not read.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene_io/gltf/warnings.h"

namespace kairos::gltf {

/// An object that a reader is at. Each of the functions below takes the member away, and throws Error(bad_input, "name:
/// JSON path") when it is of another kind than asked for; whole numbers may be written as 3.0. What a reader leaves is
/// named in `warnings` when it is done with the object: so no list of what is read can go stale. `extras` and names are
/// notes, and no loss.
class Members {
 public:
  /// The whole file. Throws Error when it is no object.
  Members(nlohmann::json& root, std::string document, Warnings& warnings);

  std::string place() const;  ///< "nodes[3].extensions"; empty for the whole file
  [[noreturn]] void fail(const std::string& what) const;
  void need(const char* key) const;  ///< throws Error when it is missing
  bool has(const char* key) const { return object_.contains(key); }

  int index(const char* key, int otherwise = -1);
  uint64_t size(const char* key, uint64_t otherwise = 0);
  double number(const char* key, double otherwise);
  std::string text(const char* key, const std::string& otherwise = "");
  bool flag(const char* key, bool otherwise = false);
  std::vector<int> indices(const char* key);
  std::vector<double> numbers(const char* key, const std::vector<double>& otherwise = {});
  /// The same; Error unless there are as many as in `otherwise`.
  std::vector<double> as_many_numbers(const char* key, const std::vector<double>& otherwise);
  std::vector<std::string> texts(const char* key);
  std::map<std::string, int> named_indices(const char* key);
  std::map<std::string, int> all_indices();  ///< all members, by name
  /// A list of numbers, or a number as a list of one; empty where there is none, or something else.
  std::vector<double> numbers_or_number(const char* key);
  /// Looks without taking: null where it is missing.
  const nlohmann::json* peek(const char* key) const;

  /// What has a meaning, though none for a picture that rays make, or for which other members stand.
  void pass(const char* key) { object_.erase(key); }
  void pass_rest() { object_.clear(); }
  /// Passes it and says what is lost: "the surface looks less velvety".
  void lose(const char* key, const std::string& what);

  /// Calls read(Members&) for the object `key`, if there is one. False for none.
  template <class Read>
  bool object(const char* key, const Read& read) {
    const auto found = object_.find(key);
    if (found == object_.end()) return false;
    Members inner(*found, *this, key, std::nullopt);
    read(inner);
    inner.report_rest();
    object_.erase(found);
    return true;
  }
  /// Calls read(Members&) for each element of the array `key`, in order.
  template <class Read>
  void each(const char* key, const Read& read) {
    const auto found = object_.find(key);
    if (found == object_.end()) return;
    check_array(*found, key);
    for (size_t i = 0; i < found->size(); ++i) {
      Members inner((*found)[i], *this, key, i);
      read(inner);
      inner.report_rest();
      (*found)[i] = nullptr;  // the memory of many small objects is large
    }
    object_.erase(found);
  }
  /// Calls read(Members&) for the extension, if the object has it. False for none.
  template <class Read>
  bool extension(const char* name, const Read& read) {
    const auto all = object_.find("extensions");
    if (all == object_.end()) return false;
    Members extensions(*all, *this, "extensions", std::nullopt);
    return extensions.object(name, read);
  }

  /// To be called when all of the file is read.
  void report_rest();

 private:
  Members(nlohmann::json& value, const Members& parent, const char* key, std::optional<size_t> element);
  std::optional<nlohmann::json> take(const char* key);
  void check_array(const nlohmann::json& value, const char* key) const;
  [[noreturn]] void refuse(const std::string& member, const std::string& what) const;
  [[noreturn]] void expected(const char* what, const std::string& member) const;
  uint64_t whole(const nlohmann::json& value, uint64_t largest, const std::string& member) const;
  /// Calls read(element, member's name) for each of the array.
  template <class Read>
  void each_value(const char* key, const Read& read);

  nlohmann::json& object_;
  const Members* parent_ = nullptr;
  const char* key_ = "";
  std::optional<size_t> element_;
  std::string document_;
  Warnings& warnings_;
};

}  // namespace kairos::gltf
