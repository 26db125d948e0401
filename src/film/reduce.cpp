#include <algorithm>
#include <utility>
#include <vector>

#include <kairos/picture.h>

namespace kairos {

namespace {

/// Every instant counts alike.
struct Box {
  double at(float) const { return 1; }
  double integral(float begin, float end) const { return static_cast<double>(end) - static_cast<double>(begin); }
  std::array<double, 2> moments(float begin, float end) const {
    return {integral(begin, end) / 2, integral(begin, end) / 2};
  }
  double gap(double filled) const { return std::max(0.0, 1 - filled); }
};

struct Curve {
  const TimeWeight& weight;

  double at(float time) const { return weight.at(static_cast<double>(time)); }
  double integral(float begin, float end) const {
    return weight.integral(static_cast<double>(begin), static_cast<double>(end));
  }
  std::array<double, 2> moments(float begin, float end) const {
    return weight.moments(static_cast<double>(begin), static_cast<double>(end));
  }
  double gap(double filled) const { return weight.integral(0, 1) - filled; }
};

/// A colour and what else is averaged.
template <class Vec>
struct Appearance {
  Vec colour, normal, albedo;
};

/// Sums over rays.
template <class Weight>
class Sums {
 public:
  Sums(const PixelRecord& record, const Weight& weight, bool count_meshes)
      : record_(record), weight_(weight), count_meshes_(count_meshes), background_(to_double(record.background)) {}

  void add(const PixelRay& ray) {
    const bool over_time = ray.is_over_time();
    const double instant = over_time ? 0 : weight_.at(ray.time) / static_cast<double>(ray.density);
    const auto scale = static_cast<double>(ray.weight);
    const std::span<const SeenPart> parts = record_.parts_of(ray);
    double filled = 0;
    for (size_t first = 0, next = 0; first < parts.size(); first = next) {
      for (next = first + 1; next < parts.size() && parts[next].layer > 0;) ++next;
      const SeenPart& part = parts[first];
      const double weight = over_time ? weight_.integral(part.where.begin, part.where.end) : instant;
      filled += weight;
      if (next == first + 1 && part.opacity == 1)
        add_opaque(part, weight, scale);
      else
        add_layers(parts.subspan(first, next - first), weight, scale);
    }
    const double gap = over_time ? weight_.gap(filled) : parts.empty() ? instant : 0;
    sum_.colour += background_ * (gap * scale);
    visibility_segments_ += scale * ray.visibility_segments;
    rays_ += scale;
  }

  bool empty() const { return !(rays_ > 0); }
  Vec3d colour() const { return sum_.colour / rays_; }
  Vec3d normal() const { return sum_.normal / rays_; }
  Vec3d albedo() const { return sum_.albedo / rays_; }
  double coverage() const { return covered_ / rays_; }
  double visibility_segments() const { return visibility_segments_ / rays_; }
  float depth() const { return depth_; }
  uint32_t mesh_id() const {
    const auto most = std::max_element(meshes_.begin(), meshes_.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second < b.second : a.first > b.first;
    });
    return most == meshes_.end() ? 0 : most->first + 1;
  }

 private:
  void add_opaque(const SeenPart& part, double weight, double scale) {
    if (part.knots == 1) {
      const double share = weight * scale;
      sum_.colour += to_double(record_.knots[part.first_knot].colour) * share;
      if (!record_.surfaces.empty()) {
        sum_.normal += to_double(record_.surfaces[part.first_knot].normal) * share;
        sum_.albedo += to_double(record_.surfaces[part.first_knot].albedo) * share;
      }
    } else {
      add_knots(part, scale);
    }
    if (part.where.mesh == kNoMesh) return;
    covered_ += weight * scale;
    add_mesh(part.where.mesh, part, weight * scale);
  }

  /// The integral of straight lines between knots times the weight.
  void add_knots(const SeenPart& part, double scale) {
    const auto add = [&](uint32_t knot, double share) {
      sum_.colour += to_double(record_.knots[knot].colour) * share;
      if (record_.surfaces.empty()) return;
      sum_.normal += to_double(record_.surfaces[knot].normal) * share;
      sum_.albedo += to_double(record_.surfaces[knot].albedo) * share;
    };
    const uint32_t last = part.first_knot + part.knots - 1;
    const auto time_of = [&](uint32_t knot) {
      return std::clamp(record_.knots[knot].time, part.where.begin, part.where.end);
    };
    add(part.first_knot, weight_.integral(part.where.begin, time_of(part.first_knot)) * scale);
    for (uint32_t knot = part.first_knot; knot < last; ++knot) {
      const auto [before, after] = weight_.moments(time_of(knot), time_of(knot + 1));
      add(knot, before * scale);
      add(knot + 1, after * scale);
    }
    add(last, weight_.integral(time_of(last), part.where.end) * scale);
  }

  /// Layers seen at the same time, from front to back.
  void add_layers(std::span<const SeenPart> layers, double weight, double scale) {
    Appearance<Vec3f> seen;
    float open = 1, coverage = 1, heaviest = 0;
    const SeenPart *nearest = nullptr, *named = nullptr;
    bool sky = false;
    for (const SeenPart& layer : layers) {
      const float share = open * layer.opacity;
      if (layer.knots == 1) {
        seen.colour += record_.knots[layer.first_knot].colour * share;
        if (!record_.surfaces.empty()) {
          seen.normal += record_.surfaces[layer.first_knot].normal * share;
          seen.albedo += record_.surfaces[layer.first_knot].albedo * share;
        }
      } else {
        add_knots(layer, scale * static_cast<double>(share));
      }
      if (layer.where.mesh == kNoMesh) {
        sky = true;
        continue;
      }
      open *= 1 - layer.opacity;
      if (nearest == nullptr) nearest = &layer;
      if (share <= heaviest) continue;
      heaviest = share;
      named = &layer;
    }
    if (open > 0) {
      coverage = 1 - open;
      if (!sky) seen.colour += record_.background * open;
    }
    const double share = weight * scale;
    covered_ += share * static_cast<double>(coverage);
    sum_.colour += to_double(seen.colour) * share;
    sum_.normal += to_double(seen.normal) * share;
    sum_.albedo += to_double(seen.albedo) * share;
    if (named != nullptr) add_mesh(named->where.mesh, *nearest, share);
  }

  void add_mesh(uint32_t mesh, const SeenPart& nearest, double share) {
    if (share == 0) return;
    depth_ = std::min({depth_, nearest.where.dist_begin, nearest.where.dist_end});
    if (!count_meshes_) return;
    auto entry = std::find_if(meshes_.begin(), meshes_.end(), [&](const auto& known) { return known.first == mesh; });
    if (entry == meshes_.end()) entry = meshes_.insert(entry, {mesh, 0});
    entry->second += share;
  }

  const PixelRecord& record_;
  Weight weight_;
  bool count_meshes_;
  Vec3d background_;
  double rays_ = 0, visibility_segments_ = 0, covered_ = 0;
  Appearance<Vec3d> sum_;
  float depth_ = std::numeric_limits<float>::infinity();
  std::vector<std::pair<uint32_t, double>> meshes_;  // in order of first sight
};

/// The share times (S - S') of a record's still term.
struct StillMeans {
  Vec3d colour, normal, albedo;
  double coverage = 0;

  StillMeans(const PixelRecord& record, double share) {
    add(record, record.still.rays, share);
    add(record, record.still.rays.first(record.still.own), -share);
  }

 private:
  void add(const PixelRecord& record, std::span<const PixelRay> rays, double share) {
    Sums<Box> sums(record, {}, false);
    for (const PixelRay& ray : rays) sums.add(ray);
    if (sums.empty()) return;
    colour += sums.colour() * share;
    normal += sums.normal() * share;
    albedo += sums.albedo() * share;
    coverage += sums.coverage() * share;
  }
};

template <class Weight>
PixelMeans reduce_under(const PixelRecord& record, const Weight& weight, bool count_meshes) {
  Sums<Weight> sums(record, weight, count_meshes);
  for (const PixelRay& ray : record.rays) sums.add(ray);
  PixelMeans means;
  if (sums.empty()) return means;
  means.visibility_segments = static_cast<float>(sums.visibility_segments());
  means.depth = sums.depth();
  means.mesh_id = sums.mesh_id();
  if (record.still.rays.empty()) {
    means.colour = to_float(sums.colour());
    means.normal = to_float(sums.normal());
    means.albedo = to_float(sums.albedo());
    means.coverage = static_cast<float>(sums.coverage());
    return means;
  }
  const StillMeans still(record, static_cast<double>(record.still.share) * weight.integral(0, 1));
  means.colour = to_float(sums.colour() + still.colour);
  means.normal = to_float(sums.normal() + still.normal);
  means.albedo = to_float(sums.albedo() + still.albedo);
  means.coverage = static_cast<float>(sums.coverage() + still.coverage);
  return means;
}

}  // namespace

PixelMeans reduce(const PixelRecord& record, const TimeWeight& weight, bool count_meshes) {
  if (weight.is_box()) return reduce_under(record, Box{}, count_meshes);
  return reduce_under(record, Curve{weight}, count_meshes);
}

}  // namespace kairos
