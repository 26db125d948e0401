// A pixel's record while it is made. One thread's memory, reused from pixel to pixel.
#pragma once

#include <vector>

#include <kairos/record.h>

namespace kairos {

class RecordBuilder {
 public:
  explicit RecordBuilder(bool surfaces = true) : surfaces_wanted_(surfaces) {}

  /// window: see PixelRecord.
  void begin_pixel(int x, int y, Vec3f background, const TimeRange& window = {}) {
    record_ = {};
    record_.x = x;
    record_.y = y;
    record_.background = background;
    record_.window = window;
    clear();
  }
  void clear() {
    rays_.clear();
    still_rays_.clear();
    parts_.clear();
    knots_.clear();
    surfaces_.clear();
  }

  bool keeps_surfaces() const { return surfaces_wanted_; }  ///< normals and albedo
  uint32_t part_count() const { return static_cast<uint32_t>(parts_.size()); }
  uint32_t knot_count() const { return static_cast<uint32_t>(knots_.size()); }
  std::span<const PixelRay> rays() const { return rays_; }
  std::span<const PixelRay> still_rays() const { return still_rays_; }
  std::span<const SeenPart> parts() const { return parts_; }
  std::span<const Knot> knots() const { return knots_; }
  /// Of a knot; nothing where surfaces are not kept.
  KnotSurface surface(uint32_t knot) const { return surfaces_wanted_ ? surfaces_[knot] : KnotSurface{}; }
  std::span<const SeenPart> parts_of(const PixelRay& ray) const {
    return std::span(parts_).subspan(ray.first_part, ray.parts);
  }

  /// Returns the knot's number.
  uint32_t add_knot(float time, const Vec3f& colour, const Vec3f& normal, const Vec3f& albedo) {
    knots_.push_back({time, colour});
    if (surfaces_wanted_) surfaces_.push_back({normal, albedo});
    return knot_count() - 1;
  }
  /// Adds knots to be set later; returns the first one's number.
  uint32_t add_knots(uint32_t count) {
    knots_.resize(knots_.size() + count);
    if (surfaces_wanted_) surfaces_.resize(knots_.size());
    return knot_count() - count;
  }
  void set_knot(uint32_t index, float time, const Vec3f& colour, const Vec3f& normal, const Vec3f& albedo) {
    knots_[index] = {time, colour};
    if (surfaces_wanted_) surfaces_[index] = {normal, albedo};
  }
  void add_part(const SeenPart& part) { parts_.push_back(part); }
  /// ray: its parts are already there.
  void add_ray(const PixelRay& ray) { rays_.push_back(ray); }
  void add_still_ray(const PixelRay& ray) { still_rays_.push_back(ray); }

  void set_plan(const PixelPlan& plan, bool moves) {
    record_.plan = plan;
    record_.moves = moves;
  }
  /// own, share: see StillTerm.
  void set_still(uint32_t own, float share) {
    record_.still.own = own;
    record_.still.share = share;
  }

  /// All of it; valid until the next pixel begins.
  const PixelRecord& finish() {
    record_.rays = rays_;
    record_.parts = parts_;
    record_.knots = knots_;
    record_.surfaces = surfaces_;
    record_.still.rays = still_rays_;
    return record_;
  }

 private:
  bool surfaces_wanted_;
  PixelRecord record_;
  std::vector<PixelRay> rays_, still_rays_;
  std::vector<SeenPart> parts_;
  std::vector<Knot> knots_;
  std::vector<KnotSurface> surfaces_;
};

}  // namespace kairos
