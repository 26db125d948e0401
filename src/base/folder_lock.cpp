#include "base/folder_lock.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <kairos/error.h>

namespace kairos {

FolderLock::FolderLock(const std::string& folder) : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (file_ < 0 || flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(file_);
  throw Error(ErrorCode::io, folder, "is in use by another process; wait for it to end, or choose another folder");
}

FolderLock::~FolderLock() {
  if (file_ >= 0) close(file_);
}

}  // namespace kairos
