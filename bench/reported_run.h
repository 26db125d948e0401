// How measuring programs end.
#pragma once

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos::bench {

/// What `run` returns; 1 where it throws an Error, which is said in one line.
inline int reported_run(const char* program, int (*run)(int argc, char** argv), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    fmt::print(stderr, "{}: {}\n", program, error.what());
    return 1;
  }
}

}  // namespace kairos::bench
