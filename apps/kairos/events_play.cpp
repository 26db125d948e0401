// kairos events play: a stream of events as a page, or as pictures.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>

#include <kairos/error.h>
#include <kairos/event_file.h>
#include <kairos/event_page.h>
#include <kairos/files.h>
#include <kairos/image.h>

#include "arguments.h"
#include "events_commands.h"
#include "frames.h"
#include "log.h"

namespace kairos::cli {

namespace {

struct PlayArguments {
  std::string path, out, pictures;
  double from = 0, to = std::numeric_limits<double>::infinity();
  double fps = 24;
};

/// Those of a stretch of time.
class Stretch : public EventSink {
 public:
  explicit Stretch(const PlayArguments& arguments) : from_(arguments.from * 1e9), to_(arguments.to * 1e9) {}
  void add(std::span<const Event> more) override {
    for (const Event& event : more) {
      width = std::max(width, int{event.x} + 1);
      height = std::max(height, int{event.y} + 1);
      const auto time = static_cast<double>(event.time);
      if (time >= from_ && time < to_) events.push_back(event);
    }
  }
  std::vector<Event> events;
  int width = 1, height = 1;

 private:
  double from_, to_;
};

/// Pictures of a sequence, frame n at the time n / fps, as far as they are there and seen.
std::vector<EventPagePicture> pictures_of(const PlayArguments& arguments, double end) {
  std::vector<EventPagePicture> pictures;
  if (arguments.pictures.empty()) return pictures;
  const FrameName name("--pictures", arguments.pictures);
  constexpr int kMostFrames = 10000;
  for (int frame = 0; frame < kMostFrames && frame / arguments.fps <= end; ++frame) {
    std::ifstream file(name.at(frame), std::ios::binary);
    if (file) pictures.push_back({frame / arguments.fps, {std::istreambuf_iterator<char>(file), {}}});
  }
  if (pictures.empty())
    throw Error(ErrorCode::bad_input, arguments.pictures, "there is no picture of that name, from frame 0 on");
  return pictures;
}

/// A picture for each frame: white, with the last event of each pixel in red or blue.
void write_pictures(const PlayArguments& arguments, const Stretch& stretch) {
  const FrameName name("--output", arguments.out);
  const auto frame_of = [&](const Event& event) {
    return static_cast<int>(std::floor(static_cast<double>(event.time) * 1e-9 * arguments.fps));
  };
  const auto size = static_cast<size_t>(stretch.width) * static_cast<size_t>(stretch.height);
  int written = 0;
  for (auto event = stretch.events.begin(); event != stretch.events.end(); ++written) {
    const int frame = frame_of(*event);
    Image image;
    image.width = image.frame_width = stretch.width;
    image.height = image.frame_height = stretch.height;
    for (const char* channel : {"R", "G", "B"})
      image.channels.push_back({channel, Channel::Storage::colour, std::vector<float>(size, 1.0f)});
    for (; event != stretch.events.end() && frame_of(*event) == frame; ++event) {
      const size_t at = size_t{event->y} * static_cast<size_t>(stretch.width) + event->x;
      const bool on = event->polarity > 0;
      image.channels[0].values[at] = on ? 0.6f : 0.02f;
      image.channels[1].values[at] = 0.04f;
      image.channels[2].values[at] = on ? 0.02f : 0.6f;
    }
    write_image(image, name.at(frame));
  }
  log(fmt::format("wrote {} pictures", written));
}

void run_play(const PlayArguments& arguments) {
  const bool page = arguments.out.ends_with(".html");
  if (page) check_writable(arguments.out);
  Stretch stretch(arguments);
  const EventFileFacts facts = read_events(arguments.path, stretch);
  stretch.width = std::max(stretch.width, facts.width);
  stretch.height = std::max(stretch.height, facts.height);
  std::sort(stretch.events.begin(), stretch.events.end());
  if (!page) return write_pictures(arguments, stretch);
  if (stretch.events.size() > kMostPageEvents) {
    log(fmt::format("warning: a page holds {} events, and there are {}: the rest is left out; see --from and --to",
                    kMostPageEvents, stretch.events.size()));
    stretch.events.resize(kMostPageEvents);
  }
  const double end = stretch.events.empty() ? 0 : static_cast<double>(stretch.events.back().time) * 1e-9;
  write_file(arguments.out,
             event_page(stretch.events, stretch.width, stretch.height,
                        std::filesystem::path(arguments.path).filename().string(), pictures_of(arguments, end)));
  log("wrote " + arguments.out);
}

}  // namespace

void add_events_play_command(CLI::App& events, Action& chosen) {
  CLI::App& command = *events.add_subcommand("play", "Show a file of events: on a page, or as pictures");
  const auto arguments = std::make_shared<PlayArguments>();
  command.add_option("FILE", arguments->path, "A file of events")->required();
  command.add_option("-o,--output", arguments->out, "A page, or the names of pictures with %d or %04d")
      ->required()
      ->type_name("OUT.html|OUT_%04d.png");
  add_real(command, "--from", "Seconds on the file's clock from which on it is shown [0]", "S",
           [arguments](double value) { arguments->from = value; });
  add_real(command, "--to", "Until when (default: its end)", "S", [arguments](double value) { arguments->to = value; });
  add_real(command, "--fps", "Pictures a second: of the output, and of --pictures [24]", "R",
           [arguments](double value) {
             if (!(value > 0)) throw CLI::ValidationError("--fps", "must be above 0");
             arguments->fps = value;
           });
  command
      .add_option("--pictures", arguments->pictures, "Pictures to show beside on the page: frame n at n / fps seconds")
      ->type_name("NAME_%04d.png");
  command.callback([arguments, &chosen] {
    if (!arguments->out.ends_with(".html")) FrameName::check("--output", arguments->out);
    if (!arguments->pictures.empty()) FrameName::check("--pictures", arguments->pictures);
    chosen = [arguments] { run_play(*arguments); };
  });
}

}  // namespace kairos::cli
