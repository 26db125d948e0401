#include <new>

#include <kairos/version.h>

#include "c_interface/handles.h"

namespace kairos::c_interface {

namespace {

thread_local std::string last_error;

void remember(const char* message) noexcept {
  try {
    last_error = message;
  } catch (...) {
    last_error.clear();
  }
}

kairos_status status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_input:
      return KAIROS_BAD_INPUT;
    case ErrorCode::bad_usage:
      return KAIROS_BAD_USAGE;
    case ErrorCode::io:
      return KAIROS_IO;
    case ErrorCode::cancelled:
      return KAIROS_CANCELLED;
  }
  return KAIROS_INTERNAL;
}

}  // namespace

kairos_status failed() noexcept {
  try {
    throw;
  } catch (const Error& e) {
    remember(e.what());
    return status_of(e.code());
  } catch (const std::bad_alloc&) {
    remember("needs more memory than there is");
    return KAIROS_NO_MEMORY;
  } catch (const std::exception& e) {
    remember(e.what());
  } catch (...) {
    remember("something was thrown that is no error");
  }
  return KAIROS_INTERNAL;
}

}  // namespace kairos::c_interface

extern "C" {

const char* kairos_version() { return kairos::version(); }
const char* kairos_last_error() { return kairos::c_interface::last_error.c_str(); }

}  // extern "C"
