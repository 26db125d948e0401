// The command line: its subcommands are those of commands.h. Exit status 0 on success, else one of exit_status.h.
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <kairos/temporary_error.h>
#include <kairos/tracer.h>
#include <kairos/version.h>

#include "commands.h"
#include "exit_status.h"
#include "interrupt.h"
#include "log.h"
#include "quoted.h"

namespace {

using kairos::cli::kBadUsage;
using kairos::cli::kFailed;
using kairos::cli::kTryAgain;
constexpr const char* kOutOfMemory = "kairos: needs more memory than there is; try a smaller picture or scene\n";

int fail(int status, const std::string& message) {
  kairos::cli::log("kairos: " + message);
  return status;
}

// Memory may also run out where nothing can be thrown any more: in a destructor while another exception is on its way.
[[noreturn]] void on_terminate() {
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    kairos::cli::draw(kOutOfMemory);
    std::_Exit(kTryAgain);
  } catch (...) {  // a fault of ours, which a core dump explains best
  }
  std::abort();
}

/// Threads could not be made: the system was short of memory or of threads. TBB says so in words alone.
bool is_short_of_threads(const std::exception& e) {
  return std::string_view(e.what()).ends_with(std::strerror(EAGAIN));
}

std::string version_text() {
  std::string kernels;
  for (const auto set : kairos::supported_instruction_sets()) kernels += " " + std::string(kairos::to_string(set));
  return fmt::format("kairos {}\nbuilt with {}\nkernels on this machine:{}", kairos::version(), kairos::built_with(),
                     kernels);
}

/// What is wrong with the arguments, and where the right ones are described.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error, std::string_view first) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  if (!chosen.empty()) return fmt::format("{} (see kairos {} --help)", error.what(), chosen.front()->get_name());
  if (first.starts_with('-')) return fmt::format("{} (see kairos --help)", error.what());
  std::string names;
  for (const CLI::App* subcommand : app.get_subcommands({}))
    names += (names.empty() ? "" : ", ") + subcommand->get_name();
  return fmt::format("{}; the subcommands are {} (see kairos --help)",
                     first.empty() ? "a subcommand is required" : fmt::format("'{}' is no subcommand", first), names);
}

int run(int argc, char** argv) {
  CLI::App app("Kairos: ray tracing in which time is integrated exactly", "kairos");
  app.set_version_flag("--version", version_text(), "Print the version, with what it was built, and end");
  app.require_subcommand(1);
  kairos::cli::Action chosen;
  std::string command_line = "kairos";
  for (int i = 1; i < argc; ++i) command_line += " " + kairos::cli::quoted(argv[i]);
  kairos::cli::add_render_command(app, chosen, command_line);
  kairos::cli::add_expose_command(app, chosen, command_line);
  kairos::cli::add_flow_command(app, chosen, command_line);
  kairos::cli::add_dataset_command(app, chosen, command_line);
  kairos::cli::add_merge_command(app, chosen);
  kairos::cli::add_jobs_command(app, chosen);
  kairos::cli::add_calibrate_command(app, chosen);
  kairos::cli::add_query_command(app, chosen);
  kairos::cli::add_info_command(app, chosen);
  kairos::cli::add_compare_command(app, chosen);
  kairos::cli::add_check_command(app, chosen);
  kairos::cli::add_convert_command(app, chosen);
  kairos::cli::add_events_command(app, chosen, command_line);
  kairos::cli::add_study_command(app, chosen, command_line);
  kairos::cli::add_completion_command(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    return fail(kBadUsage, usage_message(app, e, argc > 1 ? argv[1] : ""));
  }
  chosen();
  // What a full disk or a closed pipe swallowed is only known now.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return fail(errno == ENOSPC ? kTryAgain : kFailed, "standard output cannot be written");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(on_terminate);
  kairos::cli::install_interrupt_handler();
  try {
    return run(argc, argv);
  } catch (const kairos::TemporaryError& e) {
    return fail(kTryAgain, e.what());
  } catch (const kairos::Error& e) {
    if (e.code() == kairos::ErrorCode::cancelled) return fail(kairos::cli::interrupted_status(), e.what());
    return fail(e.code() == kairos::ErrorCode::bad_usage ? kBadUsage : kFailed, e.what());
  } catch (const std::bad_alloc&) {
    kairos::cli::draw(kOutOfMemory);
    return kTryAgain;
  } catch (const std::exception& e) {
    return fail(is_short_of_threads(e) ? kTryAgain : kFailed, e.what());
  }
}
