// A comparison of methods of rendering, from scenes to a page. docs/study.md.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "study/plan.h"

namespace kairos::study {

/// Where a study is.
struct Status {
  std::string doing;                   ///< "demo-normal: tc-4-8, seed 2"
  double fraction = 0;                 ///< of the whole study, as far as is known, 0 to 1
  std::optional<double> seconds_left;  ///< unset while nothing has been measured
};
/// Told often. Returning false stops the study.
using Tell = std::function<bool(const Status&)>;
/// Takes a line for the log.
using Log = std::function<void(const std::string&)>;

/// Measures what the folder does not hold yet, then writes the summary and the page. command_line: for the page.
/// Throws Error(cancelled) when `tell` says so: the same call goes on from there. Other errors as load_scene,
/// make_shot, Renderer, StudyFolder.
void run_study(const StudyOptions& options, const std::string& command_line, const Tell& tell, const Log& log);

}  // namespace kairos::study
