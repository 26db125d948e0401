#include "parts.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <kairos/error.h>

#include "arguments.h"
#include "frame_mark.h"

namespace kairos::cli {

namespace {

constexpr uint64_t kMostParts = 65536;
constexpr const char* kPartName = "kairos:part";
constexpr const char* kPartFrameName = "kairos:part_frame";
constexpr const char* kPartViewName = "kairos:part_view";
constexpr const char* kPartExposureName = "kairos:part_exposure";
constexpr const char* kSecondsName = "kairos:render_seconds";

/// A number that Slurm sets for each task of an array.
uint64_t of_slurm(const std::string& option, const char* name, std::optional<uint64_t> otherwise = {}) {
  const char* text = std::getenv(name);
  if (text == nullptr && otherwise) return *otherwise;
  if (text == nullptr)
    throw CLI::ValidationError(option,
                               fmt::format("slurm: {} is not set: this is no task of an array (sbatch --array)", name));
  return parse_count(name, text, 0, UINT32_MAX);
}

template <class Value>
Value attribute(const Image& image, const char* name, const std::string& path) {
  for (const Attribute& attribute : image.attributes)
    if (attribute.name == name)
      if (const Value* value = std::get_if<Value>(&attribute.value)) return *value;
  throw Error(ErrorCode::bad_input, path, fmt::format("is no part of a picture: its header has no '{}'", name));
}

struct PartImage {
  std::string path, mark;
  Image image;
  Part part;
  int frame = 0;
};

PartImage read_part(const std::string& path) {
  if (is_damaged_picture(path))
    throw Error(ErrorCode::bad_input, path, "is no whole picture; render this part again, which replaces it");
  PartImage result;
  result.path = path;
  result.image = read_image(path);
  try {
    result.part = parse_part(kPartName, attribute<std::string>(result.image, kPartName, path));
  } catch (const CLI::ValidationError& error) {
    throw Error(ErrorCode::bad_input, path, error.what());
  }
  result.mark = attribute<std::string>(result.image, kFrameMarkName, path);
  result.frame = attribute<int>(result.image, kPartFrameName, path);
  return result;
}

/// Sorted.
std::vector<std::string> files_in_folder(const std::string& out, const char* ending) {
  std::error_code ec;
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(parts_folder(out), ec))
    if (entry.is_regular_file() && entry.path().extension() == ending) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Throws where there are none.
std::vector<std::string> part_files(const std::string& out, const char* ending) {
  std::vector<std::string> paths = files_in_folder(out, ending);
  if (!paths.empty()) return paths;
  throw Error(ErrorCode::bad_input, parts_folder(out), "holds no parts; make them with kairos ... --part I/N");
}

/// Throws where a part was not found. found: [part]
void check_all_there(const std::vector<bool>& found, const std::string& out) {
  constexpr size_t kMostNamed = 10;
  std::vector<size_t> missing;
  for (size_t i = 0; i < found.size(); ++i)
    if (!found[i]) missing.push_back(i + 1);
  if (missing.empty()) return;
  const size_t count = missing.size();
  missing.resize(std::min(count, kMostNamed));
  throw Error(ErrorCode::bad_input, out,
              fmt::format("{} of {} parts are not there: {}{}; render them with --part I/{}", count, found.size(),
                          fmt::join(missing, ", "), count > kMostNamed ? ", ..." : "", found.size()));
}

std::vector<PartImage> read_parts(const std::string& out) {
  std::vector<PartImage> parts;
  for (const std::string& path : part_files(out, ".exr")) parts.push_back(read_part(path));
  return parts;
}

/// Throws where they are not all the parts of one job, each once.
void check_parts(const std::vector<PartImage>& parts, const std::string& out) {
  const PartImage& first = parts.front();
  std::vector<const PartImage*> found(static_cast<size_t>(first.part.count));
  for (const PartImage& part : parts) {
    if (part.mark != first.mark || part.frame != first.frame || part.part.count != first.part.count)
      throw Error(ErrorCode::bad_input, part.path,
                  fmt::format("is part of another job than {}: scene files, options, frame, number of parts, kairos or "
                              "instruction sets were others; remove those that are wrong",
                              first.path));
    auto& place = found[static_cast<size_t>(part.part.index)];
    if (place != nullptr)
      throw Error(ErrorCode::bad_input, part.path, "is the same part as " + place->path + "; remove one of them");
    place = &part;
  }
  std::vector<bool> there;
  for (const PartImage* part : found) there.push_back(part != nullptr);
  check_all_there(there, out);
}

bool same_channels(const Image& a, const Image& b) {
  return std::equal(a.channels.begin(), a.channels.end(), b.channels.begin(), b.channels.end(),
                    [](const Channel& p, const Channel& q) { return p.name == q.name; });
}

}  // namespace

Part parse_part(const std::string& option, std::string_view text) {
  if (text == "slurm") {
    const uint64_t first = of_slurm(option, "SLURM_ARRAY_TASK_MIN"),
                   step = of_slurm(option, "SLURM_ARRAY_TASK_STEP", 1);
    const uint64_t task = of_slurm(option, "SLURM_ARRAY_TASK_ID"), count = of_slurm(option, "SLURM_ARRAY_TASK_COUNT");
    if (step == 0 || task < first || (task - first) / step >= count || (task - first) % step != 0 || count > kMostParts)
      throw CLI::ValidationError(
          option, fmt::format("slurm: task {} is none of {} from {} in steps of {}; give an array A-B, of at most {}",
                              task, count, first, step, kMostParts));
    return {static_cast<int>((task - first) / step), static_cast<int>(count)};
  }
  const auto numbers = split(option, text, '/', 2, "I/N, or slurm");
  const uint64_t count = parse_count(option, numbers[1], 1, kMostParts);
  return {static_cast<int>(parse_count(option, numbers[0], 1, count)) - 1, static_cast<int>(count)};
}

std::string part_text(Part part) { return fmt::format("{}/{}", part.index + 1, part.count); }

Crop band_of(const Crop& whole, Part part, int unit) {
  const int64_t rows = whole.y1 - whole.y0, strips = (rows + unit - 1) / unit;
  if (strips < part.count)
    throw Error(ErrorCode::bad_usage, "",
                fmt::format("--part: {} parts of {} rows{}; give at most {} parts", part.count, rows,
                            unit > 1 ? fmt::format(", {} of which belong together", unit) : "", strips));
  Crop band = whole;
  band.y0 = whole.y0 + unit * static_cast<int>(strips * part.index / part.count);
  band.y1 = std::min(whole.y0 + unit * static_cast<int>(strips * (part.index + 1) / part.count), whole.y1);
  return band;
}

std::string parts_folder(const std::string& out) { return out + ".parts"; }

std::string part_file(const std::string& out, Part part, const char* ending) {
  return fmt::format("{}/{:05}-of-{:05}{}", parts_folder(out), part.index + 1, part.count, ending);
}

bool has_parts(const std::string& out, const char* ending) { return !files_in_folder(out, ending).empty(); }

std::vector<std::string> all_part_files(const std::string& out, const char* ending) {
  std::vector<std::string> paths = part_files(out, ending);
  std::vector<Part> parts;
  for (const std::string& path : paths) {
    std::string text = std::filesystem::path(path).stem().string();
    if (const size_t of = text.find("-of-"); of != text.npos) text.replace(of, 4, "/");
    try {
      parts.push_back(parse_part("", text));
    } catch (const CLI::ValidationError&) {
      parts.push_back({0, 0});
    }
    if (path != part_file(out, parts.back(), ending))
      throw Error(ErrorCode::bad_input, path, "is not named as parts are; remove it, or give it its name again");
    if (parts.back().count != parts.front().count)
      throw Error(ErrorCode::bad_input, path,
                  "is one of another number of parts than " + paths.front() + "; remove those that are wrong");
  }
  std::vector<bool> found(static_cast<size_t>(parts.front().count));
  for (const Part& part : parts) found[static_cast<size_t>(part.index)] = true;
  check_all_there(found, out);
  return paths;
}

void make_parts_folder(const std::string& part_file) {
  const std::filesystem::path folder = std::filesystem::path(part_file).parent_path();
  std::error_code ec;
  std::filesystem::create_directory(folder, ec);  // by another part's run at the same time, perhaps
  if (!std::filesystem::is_directory(folder))
    throw Error(ErrorCode::io, folder.string(), "cannot be made a folder: " + ec.message());
}

void describe_part(Image& image, Part part, int frame, const std::string& mark, const WriteOptions& write) {
  image.attributes.push_back({kPartName, part_text(part)});
  image.attributes.push_back({kPartFrameName, frame});
  image.attributes.push_back({kFrameMarkName, mark});
  image.attributes.push_back({kPartViewName, std::string(to_string(write.view))});
  image.attributes.push_back({kPartExposureName, write.exposure});
}

WriteOptions part_options(const std::string& out, const WriteOptions& of_picture) {
  WriteOptions write;
  write.half = of_picture.half && out.ends_with(".exr");
  return write;
}

void refuse_other_part(const std::string& path) {
  throw Error(
      ErrorCode::bad_input, path,
      "is there, but made otherwise: scene files, options or kairos were others; remove it, or give another name");
}

bool is_part_there(const std::string& path, const std::string& mark) {
  if (!std::filesystem::is_regular_file(path) || is_damaged_picture(path)) return false;
  if (read_frame_mark(path) == mark) return true;
  refuse_other_part(path);
}

MergedPicture merge_parts(const std::string& out) {
  std::vector<PartImage> parts = read_parts(out);
  check_parts(parts, out);
  std::sort(parts.begin(), parts.end(),
            [](const PartImage& a, const PartImage& b) { return a.part.index < b.part.index; });
  MergedPicture merged;
  Image& image = merged.image;
  double seconds = 0;
  for (PartImage& part : parts) {
    merged.parts.push_back(part.path);
    seconds += attribute<double>(part.image, kSecondsName, part.path);
    if (part.part.index == 0) {
      const std::string view = attribute<std::string>(part.image, kPartViewName, part.path);
      merged.write.view = parse_choice<ViewTransform>(kPartViewName, view);
      merged.write.half = true;  // of channels that have half the bits in the parts
      merged.write.exposure = attribute<double>(part.image, kPartExposureName, part.path);
      image = std::move(part.image);
      continue;
    }
    if (part.image.left != image.left || part.image.width != image.width ||
        part.image.top != image.top + image.height || part.image.frame_width != image.frame_width ||
        part.image.frame_height != image.frame_height || !same_channels(part.image, image))
      throw Error(ErrorCode::bad_input, part.path, "does not begin where the part before it ends; render it again");
    for (size_t c = 0; c < image.channels.size(); ++c) {
      const std::vector<float>& more = part.image.channels[c].values;
      image.channels[c].values.insert(image.channels[c].values.end(), more.begin(), more.end());
    }
    image.height += part.image.height;
  }
  std::erase_if(image.attributes, [](const Attribute& attribute) {
    return attribute.name.starts_with(kPartName) || attribute.name == kSecondsName;
  });
  image.attributes.push_back({kSecondsName, seconds});
  return merged;
}

void remove_parts(const std::vector<std::string>& parts, const std::string& out) {
  std::error_code ignored;  // the picture is there; what cannot be removed does no harm
  for (const std::string& part : parts) std::filesystem::remove(part, ignored);
  // What runs that were killed while they wrote have left.
  std::vector<std::filesystem::path> unfinished;
  for (const auto& entry : std::filesystem::directory_iterator(parts_folder(out), ignored))
    if (entry.path().filename().string().starts_with("kairos-") && entry.path().extension() == ".tmp")
      unfinished.push_back(entry.path());
  for (const auto& path : unfinished) std::filesystem::remove(path, ignored);
  std::filesystem::remove(parts_folder(out), ignored);
}

}  // namespace kairos::cli
