#include "scene_io/pbrt/tokens.h"

#include <cmath>

#include "scene_io/text_numbers.h"

namespace kairos::pbrt {

namespace {
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
bool ends_word(char c) { return is_space(c) || c == '"' || c == '[' || c == ']' || c == '#'; }
}  // namespace

Tokens::Tokens(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) rest_.remove_prefix(kByteOrderMark.size());
  scan();
}

void Tokens::scan() {
  while (!rest_.empty() && (is_space(rest_.front()) || rest_.front() == '#')) {
    if (rest_.front() == '#') {
      const size_t end = rest_.find_first_of("\r\n");
      rest_.remove_prefix(end == rest_.npos ? rest_.size() : end);
      continue;
    }
    if (rest_.front() == '\n' || (rest_.front() == '\r' && rest_.substr(0, 2) != "\r\n")) ++line_;
    rest_.remove_prefix(1);
  }
  token_ = {Token::Kind::end, {}, line_};
  if (rest_.empty()) return;
  const char first = rest_.front();
  if (first == '[' || first == ']') {
    token_.kind = first == '[' ? Token::Kind::open : Token::Kind::close;
    token_.text = rest_.substr(0, 1);
    rest_.remove_prefix(1);
  } else if (first == '"') {
    size_t end = 1;
    while (end < rest_.size() && rest_[end] != '"' && rest_[end] != '\n' && rest_[end] != '\r')
      end += rest_[end] == '\\' && end + 1 < rest_.size() && rest_[end + 1] != '\n' ? 2 : 1;
    if (end >= rest_.size() || rest_[end] != '"') fail({file_, line_}, "a string does not end in its line");
    token_.kind = Token::Kind::string;
    token_.text = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
  } else {
    size_t end = 1;
    while (end < rest_.size() && !ends_word(rest_[end])) ++end;
    token_.kind = Token::Kind::word;
    token_.text = rest_.substr(0, end);
    rest_.remove_prefix(end);
  }
}

Token Tokens::take() {
  const Token token = token_;
  if (token.kind != Token::Kind::end) scan();
  return token;
}

double Tokens::take_number() {
  double value = 0;
  if (token_.kind != Token::Kind::word || !parse_number(token_.text, value))
    fail(place(), token_.kind == Token::Kind::end ? std::string("ends where a number is missing")
                                                  : "'" + printable(token_.text) + "' stands where a number should");
  if (!std::isfinite(value)) fail(place(), "'" + printable(token_.text) + "' is not a finite number");
  take();
  return value;
}

std::string Tokens::take_string() {
  if (token_.kind != Token::Kind::string)
    fail(place(), token_.kind == Token::Kind::end
                      ? std::string("ends where a string is missing")
                      : "'" + printable(token_.text) + "' stands where a string in quotes should");
  return unescape(take().text);
}

std::string unescape(std::string_view text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      result += text[i];
      continue;
    }
    const char c = text[++i];
    result += c == 'n' ? '\n' : c == 't' ? '\t' : c == 'r' ? '\r' : c == 'b' ? '\b' : c == 'f' ? '\f' : c;
  }
  return result;
}

}  // namespace kairos::pbrt
