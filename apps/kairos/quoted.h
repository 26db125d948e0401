#pragma once

#include <string>

namespace kairos::cli {

/// As a shell reads it: in quotes where it has to be.
std::string quoted(const std::string& word);

}  // namespace kairos::cli
