// kairos compare: how far pictures are from a reference, in numbers and side by side.
#include <memory>

#include <kairos/compare.h>
#include <kairos/error.h>
#include <kairos/image.h>

#include "arguments.h"
#include "commands.h"
#include "frames.h"
#include "interrupt.h"

namespace kairos::cli {

namespace {

struct ComparedPictures {
  std::string reference;
  std::vector<std::string> images;
  std::string side_by_side;
  std::vector<std::string> labels;
  std::optional<PixelBox> zoom;
  std::optional<FrameRange> frames;
};

/// All pictures are sequences of the same frames.
void compare_sequences(const ComparedPictures& arguments) {
  const FrameName reference_name("REFERENCE", arguments.reference);
  std::vector<FrameName> names;
  for (const std::string& image : arguments.images) names.emplace_back("IMAGE", image);
  std::vector<SequenceMeter> meters(names.size());
  for (int frame = arguments.frames->first; frame <= arguments.frames->last; ++frame) {
    const Image reference = read_image(reference_name.at(frame));
    for (size_t i = 0; i < names.size(); ++i)
      meters[i].add(reference, read_image(names[i].at(frame)), names[i].at(frame));
  }
  for (size_t i = 0; i < names.size(); ++i) {
    const SequenceDifference result = meters[i].result();
    fmt::print("{}: MSE {:.4g}, PSNR {:.2f} dB, flicker {:.4g}\n", arguments.images[i], result.mean.mse,
               result.mean.psnr, result.flicker);
  }
}

void compare_pictures(const ComparedPictures& arguments) {
  if (arguments.frames) return compare_sequences(arguments);
  if (!arguments.side_by_side.empty()) check_writable_image(arguments.side_by_side);
  const Image reference = read_image(arguments.reference);
  std::vector<Image> images;
  for (const std::string& path : arguments.images) images.push_back(read_image(path));

  std::vector<Difference> differences;
  for (size_t i = 0; i < images.size(); ++i)
    differences.push_back(difference(reference, images[i], arguments.images[i]));
  for (size_t i = 0; i < images.size(); ++i)
    fmt::print("{}: MSE {:.4g}, PSNR {:.2f} dB\n", arguments.images[i], differences[i].mse, differences[i].psnr);
  if (arguments.side_by_side.empty()) return;

  std::vector<Panel> panels;
  for (size_t i = 0; i < images.size(); ++i)
    panels.push_back({&images[i], arguments.labels.empty()
                                      ? ""
                                      : fmt::format("{}  {:.1f} dB", arguments.labels[i], differences[i].psnr)});
  const Image joined = side_by_side(panels, arguments.zoom);
  write_interruptibly(joined, arguments.side_by_side);
}

}  // namespace

void add_compare_command(CLI::App& app, Action& chosen) {
  CLI::App& compare = *app.add_subcommand("compare", "Say how far pictures are from a reference");
  const auto out = std::make_shared<ComparedPictures>();
  compare.add_option("REFERENCE", out->reference, "The picture that counts as right: EXR, PNG, JPEG, TGA or HDR")
      ->required();
  compare.add_option("IMAGE", out->images, "Pictures of the same size")->required();
  compare
      .add_option("--side-by-side", out->side_by_side,
                  "Write the pictures (not the reference) next to each other, in the order given")
      ->type_name("OUT.png|OUT.exr");
  compare
      .add_option_function<std::string>(
          "--zoom",
          [out](const std::string& text) {
            constexpr uint64_t kMost = 65536;
            const auto parts = split("--zoom", text, ',', 4, "X,Y,WIDTH,HEIGHT");
            const auto part = [&](size_t i) { return static_cast<int>(parse_count("--zoom", parts[i], 0, kMost)); };
            out->zoom = PixelBox{part(0), part(1), part(2), part(3)};
          },
          "Show these pixels magnified below each picture of the side-by-side")
      ->type_name("X,Y,WIDTH,HEIGHT");
  compare.add_option("--labels", out->labels, "What to write into the pictures of the side-by-side, with their PSNR")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("A,B,...");
  compare
      .add_option_function<std::string>(
          "--frames",
          [out](const std::string& text) {
            out->frames = parse_frames("--frames", text);
            if (out->frames->count() < 2) throw CLI::ValidationError("--frames", "a sequence has two frames at least");
          },
          "Compare sequences, whose names have %04d: mean error, and flicker, the mean change of the error")
      ->type_name("A-B")
      ->excludes("--side-by-side");
  compare.callback([out, &chosen] {
    if (out->frames) {
      FrameName::check("REFERENCE", out->reference);
      for (const std::string& image : out->images) FrameName::check("IMAGE", image);
    }
    if (!out->labels.empty() && out->labels.size() != out->images.size())
      throw CLI::ValidationError("--labels", fmt::format("{} labels for {} pictures; give each picture one",
                                                         out->labels.size(), out->images.size()));
    if (out->side_by_side.empty() && (out->zoom || !out->labels.empty()))
      throw CLI::ValidationError("--side-by-side", "is missing: --zoom and --labels are about what it writes");
    chosen = [out] { compare_pictures(*out); };
  });
}

}  // namespace kairos::cli
