// Ctrl-C, SIGTERM and SIGHUP: stop within a second, leave no half-done file.
#pragma once

#include <string>

#include <kairos/image.h>

namespace kairos::cli {

/// From now on a signal ends the program with one line, and exit status 1, or 75 for SIGTERM: who sends that, such as a
/// scheduler that needs the machine, means that it may be tried again.
void install_interrupt_handler();

/// Between these two a first signal only makes interrupted() true: whoever polls it stops the work.
void begin_polling();
void end_polling();
bool interrupted();
/// The exit status after that.
int interrupted_status();

/// Writes the picture, or stops and leaves nothing behind: then throws Error(cancelled).
void write_interruptibly(const Image& image, const std::string& path, WriteOptions options = {});

}  // namespace kairos::cli
