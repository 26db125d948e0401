#include "checkpoint.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include <kairos/error.h>
#include <kairos/picture.h>

namespace kairos::cli {

namespace {

class Checkpoints {
 public:
  explicit Checkpoints(const CheckpointedPicture& picture) : picture_(picture) {
    // Of so many rows that threads seldom wait for each other at a strip's end, and few enough to be done in a while.
    constexpr int kLeastRows = 16, kMostStrips = 64;
    const Projection& frame = picture.shot.projection;
    whole_ = picture.params.crop.value_or(Crop{0, frame.width, 0, frame.height});
    strips_ = std::clamp((whole_.y1 - whole_.y0) / kLeastRows, 1, kMostStrips);
  }

  MergedPicture render(const Progress& progress) {
    check_folder();
    Renderer renderer(picture_.shot);
    for (int i = 0; i < strips_; ++i) {
      const Part part{i, strips_};
      if (is_part_there(part_file(picture_.out, part), picture_.mark)) continue;
      try {
        render_strip(renderer, part, progress);
      } catch (...) {
        write_done();
        throw;
      }
      if (std::chrono::duration<double>(std::chrono::steady_clock::now() - written_).count() >= picture_.seconds)
        write_done();
    }
    write_done();
    return merge_parts(picture_.out);
  }

 private:
  /// What is found at the end must be this picture's parts alone.
  void check_folder() const {
    std::set<std::string> names;
    for (int i = 0; i < strips_; ++i) names.insert(part_file(picture_.out, {i, strips_}));
    make_parts_folder(*names.begin());
    for (const auto& entry : std::filesystem::directory_iterator(parts_folder(picture_.out)))
      if (entry.path().extension() == ".exr" && !names.contains(entry.path().string()))
        throw Error(ErrorCode::bad_input, entry.path().string(),
                    "is no part of this picture; remove it, or give the picture another name");
  }

  void render_strip(Renderer& renderer, Part part, const Progress& progress) {
    RenderParams params = picture_.params;
    params.crop = band_of(whole_, part);
    Picture picture(picture_.shot.projection, params);
    PixelConsumer* const consumer = &picture;
    RenderStats stats;
    renderer.render(params, {&consumer, 1}, &stats,
                    [&](double fraction) { return progress((part.index + fraction) / strips_); });
    Image image = picture.take_shown();
    describe(image, picture_.shot, params, stats);
    image.attributes.push_back({"kairos:command_line", picture_.command_line});
    describe_part(image, part, picture_.frame, picture_.mark, picture_.write);
    done_.emplace_back(part, std::move(image));
  }

  void write_done() {
    for (const auto& [part, image] : done_)
      write_image(image, part_file(picture_.out, part), part_options(picture_.out, picture_.write));
    done_.clear();
    written_ = std::chrono::steady_clock::now();
  }

  const CheckpointedPicture& picture_;
  Crop whole_{};
  int strips_ = 1;
  std::vector<std::pair<Part, Image>> done_;  // not written yet
  std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
};

}  // namespace

MergedPicture render_with_checkpoints(const CheckpointedPicture& picture, const Progress& progress) {
  return Checkpoints(picture).render(progress);
}

}  // namespace kairos::cli
