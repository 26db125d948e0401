#include "base/system_error.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <kairos/temporary_error.h>

namespace kairos {

namespace {

/// Of full disks, of machines that are short of something, and of file systems on networks.
bool may_pass(int reason) {
  constexpr std::array kReasons{ENOSPC, EDQUOT, EIO,    ENOMEM,   EMFILE,      ENFILE,       EAGAIN,     EBUSY,
                                EINTR,  ESTALE, ENOLCK, ENETDOWN, ENETUNREACH, EHOSTUNREACH, ECONNRESET, ETIMEDOUT};
  return std::find(kReasons.begin(), kReasons.end(), reason) != kReasons.end();
}

}  // namespace

void throw_system_error(const std::string& path, const std::string& what, int reason, const std::string& advice) {
  const std::string message = what + ": " + std::strerror(reason) + advice;
  if (may_pass(reason)) throw TemporaryError(ErrorCode::io, path, message);
  throw Error(ErrorCode::io, path, message);
}

}  // namespace kairos
