// kairos merge: parts of a file in, the file out.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <kairos/event_parts.h>
#include <kairos/image.h>
#include <kairos/time_file.h>

#include "commands.h"
#include "frames.h"
#include "interrupt.h"
#include "log.h"
#include "parts.h"

namespace kairos::cli {

namespace {

struct MergeArguments {
  std::vector<std::string> outs;
  std::optional<FrameRange> frames;
  bool clean = false, quiet = false;
};

/// Returns the files of the parts.
std::vector<std::string> merge_picture(const std::string& out) {
  check_writable_image(out);
  const MergedPicture merged = merge_parts(out);
  write_interruptibly(merged.image, out, merged.write);
  return merged.parts;
}

std::vector<std::string> merge_time(const std::string& out) {
  std::vector<std::string> parts = all_part_files(out, ".ktime");
  merge_time_files(parts, out);
  return parts;
}

/// Of a recording of events.
std::vector<std::string> merge_events(const std::string& out) {
  std::vector<std::string> parts = all_part_files(out, ".npz");
  merge_event_parts(parts, out);
  for (size_t i = parts.size(); i-- > 0;) parts.push_back(parts[i] + ".json");
  return parts;
}

void merge(const MergeArguments& arguments, const std::string& out) {
  // Merged before; or a frame of a sequence that was not divided.
  if (std::filesystem::is_regular_file(out) && !std::filesystem::exists(parts_folder(out))) {
    if (!arguments.quiet) log(out + " is there already, and has no parts");
    return;
  }
  const bool time = has_parts(out, ".ktime"), events = has_parts(out, ".npz");
  const std::vector<std::string> files = time ? merge_time(out) : events ? merge_events(out) : merge_picture(out);
  if (!arguments.quiet) log(fmt::format("wrote {} from {} parts", out, events ? files.size() / 2 : files.size()));
  if (arguments.clean) remove_parts(files, out);
}

void run_merge(const MergeArguments& arguments) {
  for (const std::string& out : arguments.outs) {
    if (!arguments.frames) {
      merge(arguments, out);
      continue;
    }
    const FrameName name("OUT", out);
    for (int frame = arguments.frames->first; frame <= arguments.frames->last; ++frame)
      merge(arguments, name.at(frame));
  }
}

}  // namespace

void add_merge_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("merge", "Make a file of its parts, which others rendered");
  const auto arguments = std::make_shared<MergeArguments>();
  command.add_option("OUT", arguments->outs, "The file, by the name that was given when its parts were rendered")
      ->required();
  command
      .add_option_function<std::string>(
          "--frames", [arguments](const std::string& text) { arguments->frames = parse_frames("--frames", text); },
          "The pictures of a sequence; OUT then has %04d")
      ->type_name("A-B");
  command.add_flag("--clean", arguments->clean, "Remove the parts once the picture is there");
  command.add_flag("--quiet", arguments->quiet, "Errors only");
  command.callback([arguments, &chosen] {
    if (arguments->frames)
      for (const std::string& out : arguments->outs) FrameName::check("OUT", out);
    chosen = [arguments] { run_merge(*arguments); };
  });
}

}  // namespace kairos::cli
