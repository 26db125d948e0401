// What reading and writing JPEG have in common: an error of the library's becomes a jump, and its words are kept.
#pragma once

#include <csetjmp>
#include <cstddef>
#include <cstdio>

#include <jpeglib.h>

namespace kairos {

/// Between a setjmp on `jump` and the call that jumps, nothing that has a destructor may come into being.
struct JpegErrors {
  jpeg_error_mgr manager{};  // first: the library's pointer to it is one to all of this
  std::jmp_buf jump{};
  char message[JMSG_LENGTH_MAX] = {};
  bool damaged = false;  ///< did the library go on where data were missing or made no sense?

  jpeg_error_mgr* install() {
    jpeg_std_error(&manager);
    manager.error_exit = [](j_common_ptr library) {
      auto* const errors = reinterpret_cast<JpegErrors*>(library->err);
      library->err->format_message(library, errors->message);
      std::longjmp(errors->jump, 1);
    };
    manager.output_message = [](j_common_ptr) {};
    return &manager;
  }
};

}  // namespace kairos
