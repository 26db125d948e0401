#include "interrupt.h"

#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>

#include <unistd.h>

namespace kairos::cli {

namespace {

// A signal handler reaches nothing but what is static; this program has no other use of it.
std::atomic<bool> polling{false}, requested{false}, guarded{false};
char guarded_path[PATH_MAX];

extern "C" void on_signal(int) {
  if (polling && !requested.exchange(true)) return;
  if (guarded) unlink(guarded_path);
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

void guard_file(const std::string& path) {
  guarded = false;
  if (path.empty() || path.size() >= sizeof(guarded_path)) return;
  std::memcpy(guarded_path, path.c_str(), path.size() + 1);
  guarded = true;
}

}  // namespace kairos::cli
