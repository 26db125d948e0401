#include "study/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include <kairos/error.h>

#include "base/web_page.h"
#include "image/encode.h"
#include "image/pixels.h"
#include "study/measure.h"

namespace kairos::study {

namespace {

constexpr int kWidest = 960;  // pixels
constexpr int kQuality = 92;  // of JPEG: noise is what one wants to see
constexpr int kErrorQuality = 80;
constexpr int kCropsAcross = 6;                    // widths of a crop in that of the picture
constexpr double kNearTime = 1.5;                  // factor between times that still count as equal
constexpr std::array<int, 3> kMarks{16, 64, 256};  // samples per pixel of the baseline

/// 8-bit codes, one or three per pixel.
struct Codes {
  int width = 0, height = 0, channels = 3;
  std::vector<uint8_t> codes;
};

Codes read_codes(const std::string& path, int channels) {
  const Pixels pixels = read_picture(path);
  Codes result{pixels.width, pixels.height, channels, {}};
  if (pixels.codes.empty()) throw Error(ErrorCode::bad_input, path, "is no picture of 8 bits");
  for (size_t i = 0; i < pixels.codes.size(); ++i)
    if (static_cast<int>(i % 4) < channels) result.codes.push_back(pixels.codes[i]);
  return result;
}

Codes part_of(const Codes& whole, const PixelBox& box) {
  Codes part{box.width, box.height, whole.channels, {}};
  for (int y = box.y; y < box.y + box.height; ++y) {
    const auto row = whole.codes.begin() + (static_cast<ptrdiff_t>(y) * whole.width + box.x) * whole.channels;
    part.codes.insert(part.codes.end(), row, row + static_cast<ptrdiff_t>(box.width) * whole.channels);
  }
  return part;
}

/// Means of squares of factor x factor pixels; what does not fill one at the right and below is cut off.
Codes reduced(const Codes& whole, int factor) {
  if (factor <= 1) return whole;
  Codes small{whole.width / factor, whole.height / factor, whole.channels, {}};
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x)
      for (int c = 0; c < whole.channels; ++c) {
        int sum = 0;
        for (int i = 0; i < factor * factor; ++i)
          sum += whole.codes[static_cast<size_t>(
              ((y * factor + i / factor) * whole.width + x * factor + i % factor) * whole.channels + c)];
        small.codes.push_back(static_cast<uint8_t>(sum / (factor * factor)));
      }
  return small;
}

std::string jpeg_uri(const Codes& c, int quality) {
  return "data:image/jpeg;base64," + base64(encode_jpeg(c.codes, c.width, c.height, c.channels, quality, "a picture"));
}
std::string png_uri(const Codes& c) {
  return "data:image/png;base64," + base64(encode_png(c.codes, c.width, c.height, c.channels, "a picture"));
}

double psnr_of(const Codes& errors) {
  double sum = 0;
  for (const uint8_t code : errors.codes) sum += difference_of(code) * difference_of(code);
  return -10 * std::log10(std::max(sum / static_cast<double>(errors.codes.size()), 1e-20));
}

const SeriesSummary* find_series(const EntrySummary& entry, const std::string& name) {
  for (const SeriesSummary& series : entry.series)
    if (series.series.name == name && !series.points.empty()) return &series;
  return nullptr;
}

const PointSummary* nearest(const SeriesSummary& series, double seconds) {
  const auto distance = [&](const PointSummary& p) { return std::abs(std::log(p.seconds.median / seconds)); };
  const auto best =
      std::min_element(series.points.begin(), series.points.end(),
                       [&](const PointSummary& a, const PointSummary& b) { return distance(a) < distance(b); });
  return distance(*best) <= std::log(kNearTime) ? &*best : nullptr;
}

/// Loads each picture once.
class Album {
 public:
  Album(const EntrySummary& entry, const StudyFolder& folder) : entry_(entry), folder_(folder) {}

  const Codes& picture(const std::string& name) { return get(name, 3); }
  const Codes& errors(const std::string& name) { return get(name + "-error", 1); }

 private:
  const Codes& get(const std::string& name, int channels) {
    auto& codes = loaded_[name];
    if (codes.codes.empty()) codes = read_codes(folder_.picture(entry_.entry, name, ".png"), channels);
    return codes;
  }

  const EntrySummary& entry_;
  const StudyFolder& folder_;
  std::map<std::string, Codes> loaded_;
};

Crop make_crop(Album& album, const std::vector<Setting>& shown, const PixelBox& box, bool gain) {
  Crop crop{box, gain, {}};
  crop.views.push_back(
      {"reference", std::numeric_limits<double>::infinity(), png_uri(part_of(album.picture("reference"), box))});
  for (const Setting& setting : shown)
    crop.views.push_back({name_of(setting), psnr_of(part_of(album.errors(name_of(setting)), box)),
                          png_uri(part_of(album.picture(name_of(setting)), box))});
  return crop;
}

/// The points of the baseline whose times are looked at: kMarks, and the dearest.
std::vector<const PointSummary*> marks_of(const SeriesSummary& baseline) {
  std::vector<const PointSummary*> marks;
  for (const PointSummary& point : baseline.points)
    if (&point == &baseline.points.back() || std::find(kMarks.begin(), kMarks.end(), point.setting.spp) != kMarks.end())
      marks.push_back(&point);
  return marks;
}

}  // namespace

PixelBox largest_excess(std::span<const uint8_t> a, std::span<const uint8_t> b, int width, PixelBox size) {
  const int height = static_cast<int>(a.size()) / width;
  // sums[y][x]: over the rectangle above and to the left of (x, y).
  const auto columns = static_cast<size_t>(width) + 1;
  std::vector<double> sums(columns * (static_cast<size_t>(height) + 1));
  const auto at = [&](int x, int y) -> double& {
    return sums[static_cast<size_t>(y) * columns + static_cast<size_t>(x)];
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      const double excess = difference_of(a[i]) * difference_of(a[i]) - difference_of(b[i]) * difference_of(b[i]);
      at(x + 1, y + 1) = excess + at(x, y + 1) + at(x + 1, y) - at(x, y);
    }
  double most = -std::numeric_limits<double>::infinity();
  PixelBox best = size;
  for (int y = 0; y + size.height <= height; ++y)
    for (int x = 0; x + size.width <= width; ++x) {
      const double sum =
          at(x + size.width, y + size.height) - at(x, y + size.height) - at(x + size.width, y) + at(x, y);
      if (sum <= most) continue;
      most = sum;
      best = {x, y, size.width, size.height};
    }
  return best;
}

PagePictures pictures_of(const EntrySummary& entry, const StudyFolder& folder) {
  PagePictures page;
  Album album(entry, folder);
  const Codes& reference = album.picture("reference");
  const int factor = (reference.width + kWidest - 1) / kWidest;
  const Codes shown_reference = reduced(reference, factor);
  page.width = shown_reference.width;
  page.height = shown_reference.height;
  page.reference = jpeg_uri(shown_reference, kQuality);
  const PixelBox size{0, 0, std::max(1, reference.width / kCropsAcross),
                      std::max(1, std::min(reference.height, reference.width / kCropsAcross * 3 / 4))};

  const SeriesSummary* const baseline = find_series(entry, "owen-sobol");
  const auto show = [&](const SeriesSummary& series, const PointSummary& point) {
    for (const Picture& known : page.pictures)
      if (known.setting == point.setting) return;
    const std::string name = name_of(point.setting);
    page.pictures.push_back({point.setting, series.series.name, point.first.seconds, point.first.error.psnr,
                             jpeg_uri(reduced(album.picture(name), factor), kQuality),
                             jpeg_uri(reduced(album.errors(name), factor), kErrorQuality)});
  };
  if (baseline == nullptr) {
    for (const SeriesSummary& series : entry.series)
      if (!series.points.empty()) show(series, series.points.back());
    return page;
  }
  for (const PointSummary* mark : marks_of(*baseline)) {
    const double seconds = mark->seconds.median;
    std::vector<Setting> baselines{mark->setting};
    show(*baseline, *mark);
    for (const char* name : {"multi-jitter", "tc", "mixed", "auto"}) {
      const SeriesSummary* const series = find_series(entry, name);
      const PointSummary* const point = series == nullptr ? nullptr : nearest(*series, seconds);
      if (point == nullptr) continue;
      show(*series, *point);
      if (point->setting.method == Method::multi_jitter) {
        baselines.insert(baselines.begin(), point->setting);
        continue;
      }
      std::vector<Setting> all = baselines;
      all.push_back(point->setting);
      EqualTime pair{name, mark->setting.spp, seconds, point->setting, {}};
      const auto &before = album.errors(name_of(mark->setting)).codes,
                 &after = album.errors(name_of(point->setting)).codes;
      if (before != after) {
        pair.crops.push_back(make_crop(album, all, largest_excess(before, after, reference.width, size), true));
        pair.crops.push_back(make_crop(album, all, largest_excess(after, before, reference.width, size), false));
      }
      page.pairs.push_back(std::move(pair));
    }
  }
  return page;
}

}  // namespace kairos::study
