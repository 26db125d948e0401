// kairos convert: what a file that holds time says, for other programs.
#include <memory>

#include <fmt/format.h>

#include <kairos/files.h>
#include <kairos/object_layers.h>
#include <kairos/time_arrays.h>
#include <kairos/time_file.h>

#include "commands.h"
#include "interrupt.h"
#include "log.h"
#include "progress_bar.h"

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
  WorkProgress work(arguments.quiet, 1);
  const auto progress = work.of_piece();
  if (arguments.out.ends_with(".exr"))
    write_deep_image(deep_pieces(file.picture(), progress), arguments.out, [] { return !interrupted(); });
  else
    write_time_arrays(file.picture(), arguments.out, progress);
  end_polling();
  work.next();
  if (!arguments.quiet)
    cli::log(fmt::format("wrote {}: {} pieces of {}x{} pixels", arguments.out, file.picture().quality().pieces,
                         file.picture().frame().width, file.picture().frame().height));
}

}  // namespace

void add_convert_command(CLI::App& app, Action& chosen) {
  CLI::App& command =
      *app.add_subcommand("convert", "Write what a file that holds time says as arrays of numpy, or deep samples");
  const auto arguments = std::make_shared<ConvertArguments>();
  command.add_option("FILE", arguments->file, "A picture over time, .ktime")->required();
  command
      .add_option("-o,--output", arguments->out,
                  "The archive of arrays, or the deep picture, to write: docs/time.md says what it holds")
      ->type_name("OUT.npz|OUT.exr")
      ->required();
  command.add_flag("--quiet", arguments->quiet, "No log, errors only");
  command.callback([arguments, &chosen] {
    if (!arguments->out.ends_with(".npz") && !arguments->out.ends_with(".exr"))
      throw CLI::ValidationError(
          "--output",
          fmt::format("'{}' should end with .npz or .exr; kairos expose --stack makes pictures", arguments->out));
    chosen = [arguments] { run_convert(*arguments); };
  });
}

}  // namespace kairos::cli
