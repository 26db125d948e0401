// JSON from files that are not to be trusted: in linear time, not deeper than parsers and destructors bear.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace kairos {

/// What a file holds. It is taken apart before it is destroyed: the library's destructor of anything nested allocates,
/// and where that fails it ends the program.
class JsonText {
 public:
  enum class Repeated { refused, last_counts };  ///< of a field that an object holds twice

  /// Strict JSON. Throws Error(bad_input, file) for a syntax error (with its line), and for nesting deeper than any
  /// scene needs.
  JsonText(std::string_view text, const std::string& file, Repeated repeated = Repeated::refused);
  ~JsonText();
  JsonText(const JsonText&) = delete;
  JsonText& operator=(const JsonText&) = delete;

  nlohmann::json& root() { return root_; }
  const nlohmann::json& root() const { return root_; }

 private:
  nlohmann::json root_;
};

}  // namespace kairos
