// Exact answers, computed anew in each run by the programs in tests/oracle.
#pragma once

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "seed.h"

namespace kairos::test {

/// Runs tests/oracle/PROGRAM with what it writes to (a file or a folder), a seed and further arguments.
inline void ask_oracle(const std::string& program, const std::string& out, uint32_t seed,
                       const std::string& more = "") {
  const std::string command =
      "python3 '" KAIROS_SOURCE_DIR "/tests/oracle/" + program + "' '" + out + "' " + std::to_string(seed) + " " + more;
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

}  // namespace kairos::test
