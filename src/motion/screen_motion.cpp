#include "motion/screen_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "camera/film_plane.h"
#include "math/sampler.h"

namespace kairos {

namespace {

/// Pixels per shutter are kept as integers, so that sums do not depend on their order.
constexpr double kSpeedUnits = 64;
/// No single triangle decides about the direction of many.
constexpr double kHighestWeight = 1e3;
/// Motion whose directions agree to this share, 0 to 1, has one: all within about 20 degrees.
constexpr double kLeastAgreement = 0.9;
/// So are binary logarithms of depths.
constexpr int64_t kDepthUnits = 4096;
/// The smallest float's.
constexpr int64_t kNearestDepth = -149 * kDepthUnits;
/// What reaches behind the camera counts as this much nearer than its farthest vertex is far.
constexpr int64_t kBehind = 40 * kDepthUnits;
/// Faster than this counts as this: paths that pass the camera have no bound on screen.
constexpr double kHighestSpeed = 1e6;
/// Nothing nearer than this part of the farther end of an edge is projected: an edge that passes the camera plane is
/// cut there. What lies in front of it covers the screen all the same, by the cut's own place far outside.
constexpr double kNearShare = 1e-6;

constexpr uint32_t kPieceSize = 256;  // triangles
constexpr size_t kPiecesPerTask = 16;

struct ScreenBounds {
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
  void include(Vec2d p) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
};

class ToScreen {
 public:
  explicit ToScreen(const Projection& projection) : plane_(projection) {}

  bool is_in_front(Vec3d p) const { return p.z < 0; }

  Vec2d operator()(Vec3d p) const {
    const double scale = plane_.orthographic() ? 1 : 1 / -p.z;
    return plane_.film({p.x * scale, p.y * scale});
  }

 private:
  FilmPlane plane_;
};

/// The ends of a path between two keys, and where those in front of the camera are on screen.
template <size_t N>
struct PathEnds {
  std::array<Vec3d, N> points;
  std::array<Vec2d, N> screen;
  bool all_in_front = true;

  PathEnds(const std::array<Vec3d, N>& ends, const ToScreen& to_screen) : points(ends) {
    for (size_t i = 0; i < N; ++i)
      if (to_screen.is_in_front(points[i]))
        screen[i] = to_screen(points[i]);
      else
        all_in_front = false;
  }

  /// Bounds of the ends' convex hull in front of the camera: a path stays inside of it.
  ScreenBounds bounds(const ToScreen& to_screen) const {
    ScreenBounds bounds;
    if (all_in_front) {
      for (const Vec2d& p : screen) bounds.include(p);
      return bounds;
    }
    for (size_t i = 0; i < N; ++i) {
      const Vec3d& front = points[i];
      if (!to_screen.is_in_front(front)) continue;
      bounds.include(screen[i]);
      for (const Vec3d& behind : points) {
        if (to_screen.is_in_front(behind)) continue;
        const double z = front.z * kNearShare, weight = (z - front.z) / (behind.z - front.z);
        Vec3d cut = lerp(front, behind, weight);
        cut.z = z;
        bounds.include(to_screen(cut));
      }
    }
    return bounds;
  }
};

/// The binary logarithm in units. Of the mantissa and the exponent apart: twice as far is kDepthUnits more, exactly.
int64_t logarithm_of(double depth) {
  int exponent = 0;
  const double mantissa = std::frexp(depth, &exponent);
  const int64_t rest = std::llround(std::log2(mantissa) * static_cast<double>(kDepthUnits));
  return std::max(kNearestDepth, exponent * kDepthUnits + rest);
}

bool overlap(const Crop& a, const Crop& b) { return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1; }

uint64_t pixel_number(int x, int y) { return static_cast<uint64_t>(y) << 32 | static_cast<uint32_t>(x); }

}  // namespace

double PixelMotion::mean_speed() const {
  return count == 0 ? 0 : static_cast<double>(speed) / kSpeedUnits / static_cast<double>(count);
}

double PixelMotion::mean_depth() const {
  if (count == 0) return INFINITY;
  // Whole powers of two apart from the rest, as in logarithm_of.
  const int64_t whole = count * kDepthUnits;
  const int64_t exponent = depth / whole - (depth % whole < 0 ? 1 : 0);
  const double rest = static_cast<double>(depth - exponent * whole) / static_cast<double>(whole);
  return std::ldexp(std::exp2(rest), static_cast<int>(exponent));
}

std::optional<double> PixelMotion::direction() const {
  const auto cosine = static_cast<double>(along), sine = static_cast<double>(across);
  const auto whole = static_cast<double>(weight);
  if (!(whole > 0) || std::hypot(cosine, sine) < kLeastAgreement * whole) return std::nullopt;
  return 0.5 * std::atan2(sine, cosine);
}

std::vector<LookPixel> look_pixels(const Projection& frame) {
  constexpr uint64_t kPixelsPerLook = 64;
  const uint64_t pixels = static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height);
  const auto count =
      static_cast<uint32_t>(std::clamp<uint64_t>(pixels / kPixelsPerLook, kLeastLookPixels, kMostLookPixels));
  const Sampler places(SamplerKind::owen_sobol, count, 0);
  const Sampler::Pixel everywhere = places.pixel(0, 0);
  std::vector<LookPixel> looks(count);
  for (uint32_t i = 0; i < count; ++i) {
    const SamplePoint place = places.point(everywhere, i);
    looks[i] = {static_cast<int>(place.x * static_cast<float>(frame.width)),
                static_cast<int>(place.y * static_cast<float>(frame.height))};
  }
  return looks;
}

/// Sums at pixels that lie apart. The frame is divided into buckets, so that a triangle is compared with few of them:
/// what covers a bucket is noted once for all of its pixels.
class ScreenMotion::Looks {
 public:
  explicit Looks(const Projection& frame)
      : width_((frame.width + kBuckets - 1) / kBuckets),
        height_((frame.height + kBuckets - 1) / kBuckets),
        buckets_(static_cast<size_t>(kBuckets) * kBuckets) {
    std::vector<uint64_t> seen;
    for (const LookPixel& look : look_pixels(frame)) seen.push_back(pixel_number(look.x, look.y));
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (const uint64_t pixel : seen) {
      const int x = static_cast<int>(pixel & 0xffffffffu), y = static_cast<int>(pixel >> 32);
      bucket(x / width_, y / height_).pixels.push_back({x, y, {}});
    }
  }

  void add(const TriangleOnScreen& triangle) {
    const Crop& p = triangle.pixels;
    // A direction is shared with pixels that the triangle itself does not touch.
    const Crop cells{
        p.x0 / kDirectionCell * kDirectionCell, (p.x1 - 1) / kDirectionCell * kDirectionCell + kDirectionCell,
        p.y0 / kDirectionCell * kDirectionCell, (p.y1 - 1) / kDirectionCell * kDirectionCell + kDirectionCell};
    const int last_column = std::min(kBuckets - 1, (cells.x1 - 1) / width_);
    const int last_row = std::min(kBuckets - 1, (cells.y1 - 1) / height_);
    for (int row = cells.y0 / height_; row <= last_row; ++row) {
      const bool rows_covered = p.y0 <= row * height_ && (row + 1) * height_ <= p.y1;
      for (int column = cells.x0 / width_; column <= last_column; ++column) {
        Bucket& here = bucket(column, row);
        if (rows_covered && p.x0 <= column * width_ && (column + 1) * width_ <= p.x1) {
          add_to(here.whole, triangle, true);
          continue;
        }
        for (Pixel& pixel : here.pixels)
          if (contains(cells, pixel)) add_to(pixel.motion, triangle, contains(p, pixel));
      }
    }
  }

  std::vector<Look> take() const {
    std::vector<Look> looks;
    for (const Bucket& bucket : buckets_)
      for (const Pixel& pixel : bucket.pixels) {
        Look look{pixel_number(pixel.x, pixel.y), pixel.motion};
        look.motion.count += bucket.whole.count;
        look.motion.speed += bucket.whole.speed;
        look.motion.depth += bucket.whole.depth;
        look.motion.along += bucket.whole.along;
        look.motion.across += bucket.whole.across;
        look.motion.weight += bucket.whole.weight;
        looks.push_back(look);
      }
    std::sort(looks.begin(), looks.end(), [](const Look& a, const Look& b) { return a.pixel < b.pixel; });
    return looks;
  }

 private:
  static constexpr int kBuckets = 32;  // in a row, and in a column
  struct Pixel {
    int x, y;
    PixelMotion motion;
  };
  struct Bucket {
    std::vector<Pixel> pixels;
    PixelMotion whole;  // of what covers all of it
  };

  static bool contains(const Crop& crop, const Pixel& pixel) {
    return crop.x0 <= pixel.x && pixel.x < crop.x1 && crop.y0 <= pixel.y && pixel.y < crop.y1;
  }
  static void add_to(PixelMotion& motion, const TriangleOnScreen& triangle, bool touches) {
    if (touches) {
      ++motion.count;
      motion.speed += triangle.speed;
      motion.depth += triangle.depth;
    }
    motion.along += triangle.along;
    motion.across += triangle.across;
    motion.weight += triangle.weight;
  }
  Bucket& bucket(int column, int row) { return buckets_[static_cast<size_t>(row * kBuckets + column)]; }

  int width_, height_;  // of a bucket, pixels
  std::vector<Bucket> buckets_;
};

ScreenMotion::ScreenMotion(const Shot& shot, double margin) : shot_(shot), margin_(margin) {
  std::vector<Piece> all;
  for (uint32_t m = 0; m < shot.meshes.size(); ++m) {
    const Mesh& mesh = shot.meshes[m];
    if (mesh.is_static()) continue;
    if (mesh.object) {
      auto& boxes = boxes_[mesh.object.get()];
      if (boxes.empty()) boxes = shape_boxes(*mesh.object);
    }
    const auto triangles =
        static_cast<uint32_t>(mesh.object ? boxes_[mesh.object.get()].size() : mesh.triangle_count());
    for (uint32_t key = 0; key + 1 < mesh.key_count(); ++key) {
      if (mesh.key_times[key] == mesh.key_times[key + 1]) continue;  // a jump takes no time
      for (uint64_t begin = 0; begin < triangles; begin += kPieceSize)
        all.push_back({m,
                       key,
                       static_cast<uint32_t>(begin),
                       static_cast<uint32_t>(std::min<uint64_t>(triangles, begin + kPieceSize)),
                       {}});
    }
  }
  Looks looks(shot.projection);
  std::mutex mutex;  // of looks
  parallel_for(all.size(), kPiecesPerTask, [&](size_t first, size_t last) {
    std::vector<TriangleOnScreen> triangles, found;
    for (size_t i = first; i < last; ++i) {
      triangles.clear();
      project(all[i], triangles);
      Crop& bounds = all[i].bounds;
      if (!triangles.empty()) bounds = triangles.front().pixels;
      for (const TriangleOnScreen& triangle : triangles) {
        bounds.x0 = std::min(bounds.x0, triangle.pixels.x0);
        bounds.x1 = std::max(bounds.x1, triangle.pixels.x1);
        bounds.y0 = std::min(bounds.y0, triangle.pixels.y0);
        bounds.y1 = std::max(bounds.y1, triangle.pixels.y1);
      }
      found.insert(found.end(), triangles.begin(), triangles.end());
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const TriangleOnScreen& triangle : found) looks.add(triangle);
  });
  looks_ = looks.take();
  std::copy_if(all.begin(), all.end(), std::back_inserter(pieces_),
               [](const Piece& piece) { return piece.bounds.x0 < piece.bounds.x1; });
}

void ScreenMotion::project(const Piece& piece, std::vector<TriangleOnScreen>& out) const {
  const ToScreen to_screen(shot_.projection);
  const double width = shot_.projection.width, height = shot_.projection.height;
  const Mesh& mesh = shot_.meshes[piece.mesh];
  const double duration =
      static_cast<double>(mesh.key_times[piece.key + 1]) - static_cast<double>(mesh.key_times[piece.key]);
  // `points`: the corners of something at the first key, then at the second.
  const auto add = [&](const auto& points) {
    const size_t corner_count = points.size() / 2;
    const PathEnds ends(points, to_screen);
    const ScreenBounds b = ends.bounds(to_screen);
    if (!(b.x0 <= b.x1)) return;
    TriangleOnScreen seen;
    seen.pixels = {static_cast<int>(std::clamp(std::floor(b.x0 - margin_), 0.0, width)),
                   static_cast<int>(std::clamp(std::floor(b.x1 + margin_) + 1, 0.0, width)),
                   static_cast<int>(std::clamp(std::floor(b.y0 - margin_), 0.0, height)),
                   static_cast<int>(std::clamp(std::floor(b.y1 + margin_) + 1, 0.0, height))};
    if (seen.pixels.x0 >= seen.pixels.x1 || seen.pixels.y0 >= seen.pixels.y1) return;
    double length_2 = 0, nearest = INFINITY, farthest = 0;
    Vec2d longest;  // of the paths on screen; of no direction where one passes the camera
    for (size_t v = 0; v < corner_count; ++v) {
      const double first = points[v].z, second = points[v + corner_count].z;
      nearest = std::min({nearest, -first, -second});
      farthest = std::max({farthest, std::abs(first), std::abs(second)});
      if (!ends.all_in_front) continue;
      const Vec2d &from = ends.screen[v], &to = ends.screen[v + corner_count];
      const Vec2d way{to.x - from.x, to.y - from.y};
      const double way_2 = way.x * way.x + way.y * way.y;
      if (way_2 <= length_2) continue;
      length_2 = way_2;
      longest = way;
    }
    const double path = ends.all_in_front ? std::sqrt(length_2) : kHighestSpeed;
    seen.speed = std::llround(std::min(path / duration, kHighestSpeed) * kSpeedUnits);
    if (nearest > 0)
      seen.depth = logarithm_of(nearest);
    else
      seen.depth = farthest > 0 ? logarithm_of(farthest) - kBehind : kNearestDepth;
    // Of a line's direction, twice its angle is what can be added up: there and back are one direction.
    const double weight = length_2 > 0 ? std::min(path / duration, kHighestWeight) * kSpeedUnits : 0;
    const double share = length_2 > 0 ? weight / length_2 : 0;
    seen.along = std::llround(share * (longest.x * longest.x - longest.y * longest.y));
    seen.across = std::llround(share * 2 * longest.x * longest.y);
    seen.weight = std::llround(weight);
    out.push_back(seen);
  };
  if (mesh.object) {
    const std::vector<BoxCorners>& boxes = boxes_.find(mesh.object.get())->second;
    for (uint32_t b = piece.begin; b < piece.end; ++b) {
      std::array<Vec3d, 16> points;
      for (size_t c = 0; c < boxes[b].size(); ++c) {
        points[c] = to_double(mesh.placements[piece.key].point(boxes[b][c]));
        points[c + boxes[b].size()] = to_double(mesh.placements[piece.key + 1].point(boxes[b][c]));
      }
      add(points);
    }
    return;
  }
  for (uint32_t t = piece.begin; t < piece.end; ++t) {
    const Triangle& corners = mesh.triangle(t);
    std::array<Vec3d, 6> points;
    for (size_t v = 0; v < 3; ++v) {
      points[v] = to_double(mesh.position(piece.key, corners[v]));
      points[v + 3] = to_double(mesh.position(piece.key + 1, corners[v]));
    }
    add(points);
  }
}

void ScreenMotion::visit(const Crop& part, const std::function<void(std::span<const TriangleOnScreen>)>& visit) const {
  std::vector<const Piece*> touched;
  for (const Piece& piece : pieces_)
    if (overlap(piece.bounds, part)) touched.push_back(&piece);
  std::mutex mutex;  // of the visitor
  parallel_for(touched.size(), kPiecesPerTask, [&](size_t first, size_t last) {
    std::vector<TriangleOnScreen> triangles;
    for (size_t i = first; i < last; ++i) project(*touched[i], triangles);
    const std::lock_guard<std::mutex> lock(mutex);
    visit(triangles);
  });
}

const PixelMotion* ScreenMotion::at_look(int x, int y) const {
  const uint64_t pixel = pixel_number(x, y);
  const auto at = std::lower_bound(looks_.begin(), looks_.end(), pixel,
                                   [](const Look& look, uint64_t value) { return look.pixel < value; });
  return at != looks_.end() && at->pixel == pixel ? &at->motion : nullptr;
}

}  // namespace kairos
