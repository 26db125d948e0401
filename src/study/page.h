// The page on which a study is read, and the tables beside it.
#pragma once

#include <string>

#include "study/plan.h"
#include "study/study_folder.h"

namespace kairos::study {

/// Writes index.html, curves.csv and comparisons.csv from what the folder holds. Throws Error(io).
void write_results(const StudyOptions& options, const StudyFolder& folder, const std::string& command_line);

/// The page of these data (JSON), from the files of src/study/page. Needs nothing beside itself to be shown.
std::string page_of(const std::string& data);

}  // namespace kairos::study
