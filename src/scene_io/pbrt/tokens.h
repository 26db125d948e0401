// A pbrt scene file as words, strings and brackets, each with its line.
#pragma once

#include <string>
#include <string_view>

#include "scene_io/pbrt/warnings.h"

namespace kairos::pbrt {

struct Token {
  enum class Kind { word, string, open, close, end };
  Kind kind = Kind::end;
  std::string_view text;  ///< of a word, or of a string between its quotes, escapes as they stand
  size_t line = 1;
};

class Tokens {
 public:
  /// `text` must outlive this.
  Tokens(std::string_view text, std::string file);

  const Token& peek() const { return token_; }
  /// The token that peek() shows; moves on. Throws Error(bad_input) for a string that does not end in its line.
  Token take();

  /// A number (any bracketed one too, where `[` and `]` surround the arguments of a statement). Throws Error(bad_input)
  /// where there is none, or it is not finite.
  double take_number();
  std::string take_string();

  const std::string& file() const { return file_; }
  Place place() const { return {file_, token_.line}; }  ///< of the token that peek() shows

 private:
  void scan();

  std::string_view rest_;
  std::string file_;
  size_t line_ = 1;
  Token token_;
};

/// A string's text with its escapes resolved.
std::string unescape(std::string_view text);

}  // namespace kairos::pbrt
