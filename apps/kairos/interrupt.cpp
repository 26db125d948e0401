#include "interrupt.h"

#include <atomic>
#include <csignal>

#include <unistd.h>

namespace kairos::cli {

namespace {

// A signal handler reaches nothing but what is static; this program has no other use of it.
std::atomic<bool> polling{false}, requested{false};

extern "C" void on_signal(int) {
  if (polling && !requested.exchange(true)) return;
  constexpr char kMessage[] = "kairos: interrupted\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1);
  _exit(1);
}

}  // namespace

void install_interrupt_handler() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void begin_polling() { polling = true; }
void end_polling() { polling = false; }
bool interrupted() { return requested; }

}  // namespace kairos::cli
