// Ctrl-C, SIGTERM and SIGHUP: stop within a second, leave no half-done file.
#pragma once

#include <string>

#include <kairos/image.h>

namespace kairos::cli {

/// From now on a signal ends the program with exit status 1 and one line.
void install_interrupt_handler();

/// Between these two a first signal only makes interrupted() true: whoever polls it stops the work.
void begin_polling();
void end_polling();
bool interrupted();

/// Writes the picture, or stops and leaves nothing behind: then throws Error(cancelled).
void write_interruptibly(const Image& image, const std::string& path, WriteOptions options = {});

}  // namespace kairos::cli
