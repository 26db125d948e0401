// Rays as text: one a line, ox oy oz dx dy dz.
#pragma once

#include <istream>
#include <string>

#include <kairos/tracer.h>

namespace kairos::cli {

/// Reads rays line by line. Empty lines and lines that begin with # are passed over.
class RayReader {
 public:
  /// name: for error messages.
  RayReader(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {}

  /// False at the end of the input. Throws Error(bad_input) that names the line: not six finite numbers that fit float,
  /// a direction of zero, a line of more than 4096 characters.
  bool next(Ray& ray);

  /// Whether more input is at hand without waiting for it: when not, answer what has been asked so far.
  bool more_at_hand() { return in_.rdbuf()->in_avail() > 0; }

 private:
  std::istream& in_;
  std::string name_;
  uint64_t line_ = 0;
};

}  // namespace kairos::cli
