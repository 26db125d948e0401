// The lines of OBJ and MTL files.
#pragma once

#include <string>
#include <string_view>

namespace kairos {

/// Lines without their ends (LF, CR LF or CR), joined where the last character is a backslash.
class Lines {
 public:
  /// `text` must outlive this. A byte order mark, which would hide the first statement, is passed over.
  explicit Lines(std::string_view text);

  /// False after the last line. `line` holds until the next call.
  bool next(std::string_view& line);

  size_t number() const { return number_; }  ///< of the line last read, from 1

 private:
  std::string_view take();

  std::string_view rest_;
  std::string joined_;
  size_t number_ = 1, next_number_ = 1;
};

/// The next run of characters that are no spaces; empty at the end of the line.
std::string_view take_token(std::string_view& line);

/// What is left of a line, without spaces around it: names and file names may have some inside.
std::string_view trimmed(std::string_view line);

/// Up to a '#'.
std::string_view without_comment(std::string_view line);

}  // namespace kairos
