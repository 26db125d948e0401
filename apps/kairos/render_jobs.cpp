#include "render_jobs.h"

#include <filesystem>

#include <kairos/error.h>
#include <kairos/time_file.h>

namespace kairos::cli {

namespace {

FrameJob part_of(FrameJob job, Part part) {
  if (!job.out.empty()) job.out = part_file(job.out, part);
  if (!job.time.empty()) job.time = part_file(job.time, part, ".ktime");
  job.part = part;
  return job;
}

/// Is the part of a picture over time there? All of it: it gets its name when it is, but a disk may lose some.
bool is_time_there(const FrameJob& job, const std::string& mark) {
  if (!std::filesystem::is_regular_file(job.time)) return false;
  std::optional<TimeFile> file;
  try {
    file.emplace(TimeFile::open(job.time));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bad_input) return false;
    throw;
  }
  if (file->info().mark != mark) refuse_other_part(job.time);
  const TimeFrame& frame = file->picture().frame();
  constexpr int kSide = TimeFileWriter::kTileSide;
  const Crop band = pixels_of(job, {frame.left, frame.left + frame.width, frame.top, frame.top + frame.height});
  const auto tiles = [](int pixels) { return static_cast<uint64_t>((pixels + kSide - 1) / kSide); };
  return file->info().tiles_there ==
         tiles(band.x1 - band.x0) * tiles(band.y1 - band.y0) * static_cast<uint64_t>(file->info().slabs);
}

}  // namespace

std::vector<FrameJob> all_jobs(const RenderFiles& files, const ShotOptions& shot) {
  std::vector<FrameJob> jobs;
  if (files.frames && !files.time.empty()) {
    FrameJob job{shot, files.frames->count(), "", "", files.time, {}};
    job.shot.frame = files.frames->first;
    jobs.push_back(std::move(job));
  } else if (files.frames) {
    const FrameName out("--output", files.out);
    for (int frame = files.frames->first; frame <= files.frames->last; ++frame) {
      FrameJob job{shot, 0, out.at(frame), "", "", {}};
      if (!files.stats_file.empty()) job.stats_file = FrameName("--stats-file", files.stats_file).at(frame);
      job.shot.frame = frame;
      jobs.push_back(std::move(job));
    }
  } else {
    jobs.push_back({shot, 0, files.out, files.stats_file, files.time, {}});
  }
  if (!files.part) return jobs;
  const int64_t frames = static_cast<int64_t>(jobs.size()), pieces = (files.part->count + frames - 1) / frames;
  const int64_t units = frames * pieces;
  std::vector<FrameJob> chosen;
  for (int64_t unit = units * files.part->index / files.part->count;
       unit < units * (files.part->index + 1) / files.part->count; ++unit) {
    const FrameJob& job = jobs[static_cast<size_t>(unit / pieces)];
    const bool whole = pieces == 1 && files.frames && job.slabs == 0;  // nothing to merge
    chosen.push_back(whole ? job : part_of(job, {static_cast<int>(unit % pieces), static_cast<int>(pieces)}));
  }
  return chosen;
}

bool is_there(const FrameJob& job, const std::string& mark) {
  return (job.out.empty() || is_part_there(job.out, mark)) && (job.time.empty() || is_time_there(job, mark)) &&
         (job.stats_file.empty() || std::filesystem::is_regular_file(job.stats_file));
}

Crop pixels_of(const FrameJob& job, const Crop& whole) {
  return job.part ? band_of(whole, *job.part, job.time.empty() ? 1 : TimeFileWriter::kTileSide) : whole;
}

}  // namespace kairos::cli
