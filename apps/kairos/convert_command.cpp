// kairos convert: what a file that holds time says, for other programs.
#include <memory>

#include <fmt/format.h>

#include <kairos/files.h>
#include <kairos/time_arrays.h>
#include <kairos/time_file.h>

#include "commands.h"
#include "interrupt.h"
#include "log.h"

namespace kairos::cli {

namespace {

struct ConvertArguments {
  std::string file, out;
  bool quiet = false;
};

void run_convert(const ConvertArguments& arguments) {
  check_writable(arguments.out);
  const TimeFile file = TimeFile::open(arguments.file);
  if (!arguments.quiet && !file.info().finished)
    cli::log(fmt::format("warning: {}: is not finished, {} of {} tiles are there; pixels of the others have no pieces",
                         arguments.file, file.info().tiles_there, file.info().tiles));
  begin_polling();
  write_time_arrays(file.picture(), arguments.out, [](double) { return !interrupted(); });
  end_polling();
  if (!arguments.quiet)
    cli::log(fmt::format("wrote {}: {} pieces of {}x{} pixels", arguments.out, file.picture().quality().pieces,
                         file.picture().frame().width, file.picture().frame().height));
}

}  // namespace

void add_convert_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("convert", "Write what a file that holds time says as arrays of numpy");
  const auto arguments = std::make_shared<ConvertArguments>();
  command.add_option("FILE", arguments->file, "A picture over time, .ktime")->required();
  command.add_option("-o,--output", arguments->out, "The archive to write: docs/time.md says which arrays it holds")
      ->type_name("OUT.npz")
      ->required();
  command.add_flag("--quiet", arguments->quiet, "No log, errors only");
  command.callback([arguments, &chosen] {
    if (!arguments->out.ends_with(".npz"))
      throw CLI::ValidationError(
          "--output", fmt::format("'{}' should end with .npz; kairos expose --stack makes pictures", arguments->out));
    chosen = [arguments] { run_convert(*arguments); };
  });
}

}  // namespace kairos::cli
