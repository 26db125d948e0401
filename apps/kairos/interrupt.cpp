#include "interrupt.h"

#include <atomic>
#include <csignal>

#include <unistd.h>

#include <kairos/error.h>

#include "exit_status.h"

namespace kairos::cli {

namespace {

// A signal handler reaches nothing but what is static; this program has no other use of it.
std::atomic<bool> polling{false}, requested{false};
std::atomic<int> last_signal{0};

int status_after(int signal) { return signal == SIGTERM ? kTryAgain : kFailed; }

extern "C" void on_signal(int signal) {
  last_signal = signal;
  if (polling && !requested.exchange(true)) return;
  constexpr char kMessage[] = "kairos: interrupted\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1);
  _exit(status_after(signal));
}

}  // namespace

void install_interrupt_handler() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A terminal that closes; unless one was told not to mind, as nohup does.
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  // A file that may not grow any further is an error of writing like any other, and leaves nothing behind.
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

void begin_polling() { polling = true; }
void end_polling() { polling = false; }
bool interrupted() { return requested; }
int interrupted_status() { return status_after(last_signal); }

void write_interruptibly(const Image& image, const std::string& path, WriteOptions options) {
  options.go_on = [] { return !interrupted(); };
  begin_polling();
  try {
    write_image(image, path, options);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
  }
  end_polling();
  if (interrupted()) throw Error(ErrorCode::cancelled, "", "interrupted");
}

}  // namespace kairos::cli
