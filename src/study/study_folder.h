// The folder in which a study grows.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/folder_lock.h"
#include "study/plan.h"
#include "study/run_log.h"

namespace kairos::study {

/// What is known about a scene once it has been loaded and its keys have been chosen.
struct SceneFacts {
  std::string name;
  int width = 0, height = 0;  ///< pixels
  uint64_t triangles = 0, moving_triangles = 0;
  int keys = 0;  ///< RenderParams::discrete_keys that were the fastest
};

/// Names for scenes: the file's without its extension, made unique; letters, digits, '-' and '_' only.
std::vector<std::string> scene_names(const std::vector<std::string>& paths);

/// Opens what an earlier, interrupted study of the same parameters has left, or begins.
class StudyFolder {
 public:
  /// Throws Error(bad_usage) when the folder holds a study of other parameters, unless options.force: then it is
  /// removed. Throws Error(io), also while another process has the folder. Parameters include the scene files' contents
  /// and the program's version and commit.
  explicit StudyFolder(const StudyOptions& options);

  /// Nothing where it has not been measured yet.
  const Run* find(const Entry& entry, const Setting& setting, int seed) const;
  const ReferenceRun* find_reference(const Entry& entry) const;
  const SceneFacts* find_scene(const std::string& name) const;
  const std::vector<Run>& runs() const { return runs_; }

  void add(const Run& run);
  void add(const ReferenceRun& run);
  void add(const SceneFacts& facts);

  std::string file(const std::string& name) const;
  /// `what`: name of a setting, or "reference".
  std::string picture(const Entry& entry, const std::string& what, const std::string& extension) const;

 private:
  std::string folder_;
  std::optional<FolderLock> lock_;
  std::optional<LineLog> run_log_, reference_log_, scene_log_;
  std::vector<Run> runs_;
  std::vector<ReferenceRun> references_;
  std::vector<SceneFacts> scenes_;
};

/// Whole or not at all. Throws Error(io).
void write_file(const std::string& path, std::span<const uint8_t> bytes);
void write_file(const std::string& path, const std::string& text);

/// Everything that results depend on, as JSON text with one value per line.
std::string parameters_text(const StudyOptions& options);

}  // namespace kairos::study
