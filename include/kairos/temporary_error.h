// Errors after which it makes sense to try again.
#pragma once

#include <kairos/error.h>

namespace kairos {

/// What failed may go well later, or elsewhere, without anything being changed: a disk was full, memory was too little,
/// a file system was gone for a while. Farms run such jobs again.
class KAIROS_API TemporaryError : public Error {
 public:
  using Error::Error;
};

}  // namespace kairos
