// kairos merge: parts of a picture in, the picture out.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include <kairos/image.h>

#include "commands.h"
#include "frames.h"
#include "interrupt.h"
#include "log.h"
#include "parts.h"

namespace kairos::cli {

namespace {

struct MergeArguments {
  std::string out;
  std::optional<FrameRange> frames;
  bool clean = false, quiet = false;
};

void merge(const MergeArguments& arguments, const std::string& out) {
  // Merged before; or a frame of a sequence that was not divided.
  if (std::filesystem::is_regular_file(out) && !std::filesystem::exists(parts_folder(out))) {
    if (!arguments.quiet) log(out + " is there already, and has no parts");
    return;
  }
  check_writable_image(out);
  const MergedPicture merged = merge_parts(out);
  write_interruptibly(merged.image, out, merged.write);
  if (!arguments.quiet) log(fmt::format("wrote {} from {} parts", out, merged.parts.size()));
  if (arguments.clean) remove_parts(merged, out);
}

void run_merge(const MergeArguments& arguments) {
  if (!arguments.frames) return merge(arguments, arguments.out);
  const FrameName name("OUT", arguments.out);
  for (int frame = arguments.frames->first; frame <= arguments.frames->last; ++frame) merge(arguments, name.at(frame));
}

}  // namespace

void add_merge_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("merge", "Make a picture of its parts, which render wrote");
  const auto arguments = std::make_shared<MergeArguments>();
  command.add_option("OUT", arguments->out, "The picture, by the name that render was given with -o")
      ->type_name("OUT.exr|OUT.png")
      ->required();
  command
      .add_option_function<std::string>(
          "--frames", [arguments](const std::string& text) { arguments->frames = parse_frames("--frames", text); },
          "The pictures of a sequence; OUT then has %04d")
      ->type_name("A-B");
  command.add_flag("--clean", arguments->clean, "Remove the parts once the picture is there");
  command.add_flag("--quiet", arguments->quiet, "Errors only");
  command.callback([arguments, &chosen] {
    if (arguments->frames) FrameName::check("OUT", arguments->out);
    chosen = [arguments] { run_merge(*arguments); };
  });
}

}  // namespace kairos::cli
