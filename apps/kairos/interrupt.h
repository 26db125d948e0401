// Ctrl-C and SIGTERM: stop within a second, leave no half-done file.
#pragma once

#include <string>

namespace kairos::cli {

/// From now on a signal ends the program with exit status 1 and one line.
void install_interrupt_handler();

/// Between these two a first signal only makes interrupted() true: whoever polls it stops the work.
void begin_polling();
void end_polling();
bool interrupted();

/// The file that is being written, to be removed when the program is ended; empty: none. Not longer than a path may be.
void guard_file(const std::string& path);

}  // namespace kairos::cli
