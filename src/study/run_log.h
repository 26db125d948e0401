// What was measured, kept in a file that survives an interruption at any moment.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <kairos/render.h>

#include "study/plan.h"

namespace kairos::study {

/// How far a picture is from the reference. docs/study.md says how.
struct PictureError {
  double mse = 0, psnr = 0, relative_mse = 0;
};

/// A scene and how it is shaded.
struct Entry {
  std::string scene;  ///< its name, unique in the study
  ShadingKind shading = ShadingKind::normal;

  bool operator==(const Entry&) const = default;
};
/// "demo-normal".
std::string name_of(const Entry& entry);

/// One picture that was rendered and measured.
struct Run {
  Entry entry;
  Setting setting;
  int seed = 0;
  double seconds = 0;  ///< of rendering alone, as the study's clock has it
  double wall_seconds = 0, cpu_seconds = 0;
  double build_seconds = 0;  ///< wall clock, of everything that it needs built
  PictureError error;
  uint64_t rays = 0, segments = 0, shaded = 0, nodes = 0, triangles = 0, root_solves = 0;  ///< see RenderStats
};

/// The reference of an entry, rendered in two halves.
struct ReferenceRun {
  Entry entry;
  int spp = 0;         ///< of each half
  PictureError error;  ///< of their mean, estimated from their difference
  double seconds = 0;  ///< of both, wall clock, all threads
};

// One line of CSV each, without its end; the header first.
extern const char* const kRunHeader;
extern const char* const kReferenceHeader;
std::string to_line(const Run& run);
std::string to_line(const ReferenceRun& run);
/// Throw Error(bad_input, place) for a line that is none.
Run parse_run(const std::string& line, const std::string& place);
ReferenceRun parse_reference(const std::string& line, const std::string& place);

/// A text file that only grows, by whole lines.
class LineLog {
 public:
  /// Makes the file with its header, or opens the one that is there: an unfinished last line, as a crash leaves it, is
  /// cut off. Throws Error(io), or Error(bad_input) when the file's header is another.
  LineLog(std::string path, const std::string& header);

  const std::vector<std::string>& lines() const { return lines_; }  ///< below the header
  const std::string& path() const { return path_; }
  /// On disk when it returns. Throws Error(io).
  void append(const std::string& line);

 private:
  std::string path_;
  std::vector<std::string> lines_;
};

}  // namespace kairos::study
