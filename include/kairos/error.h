// How Kairos reports what it cannot do: one exception type, one line of text.
#pragma once

#include <stdexcept>
#include <string>

#include <kairos/export.h>

namespace kairos {

enum class KAIROS_API ErrorCode {
  bad_input,  ///< a file or a scene that cannot be used
  bad_usage,  ///< arguments that make no sense
  io,         ///< the operating system refused to read or write
  cancelled,  ///< the caller's progress callback asked to stop
};

/// what() is one line: "place: message", where place names a file and, if known, a line or a JSON path. It may be shown
/// on a terminal, whatever the file holds: controls are replaced.
class KAIROS_API Error : public std::runtime_error {
 public:
  Error(ErrorCode error_code, const std::string& place, const std::string& message);

  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace kairos
