#include "shading/lights.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shading/luminance.h"

namespace kairos {

namespace {

struct Arrival {
  Vec3d point;
  const Place& place;

  std::optional<ArrivingLight> operator()(const PointLight& light) const {
    const Vec3d way = place.point_from_world(to_double(light.position)) - point;
    const double dist_squared = dot(way, way);
    if (!(dist_squared > 0)) return std::nullopt;
    return ArrivingLight{normalize(way), std::sqrt(dist_squared), light.intensity / static_cast<float>(dist_squared)};
  }
  std::optional<ArrivingLight> operator()(const SpotLight& light) const {
    auto arriving = (*this)(PointLight{light.position, light.intensity});
    if (!arriving) return arriving;
    const double cosine = -dot(arriving->direction, place.vector_from_world(to_double(light.direction)));
    const double inner = light.cos_inner, outer = light.cos_outer;
    if (cosine <= outer) return std::nullopt;
    const double falloff = inner > outer ? std::min(1.0, (cosine - outer) / (inner - outer)) : 1.0;
    arriving->irradiance = arriving->irradiance * static_cast<float>(falloff * falloff);
    return arriving;
  }
  std::optional<ArrivingLight> operator()(const DirectionalLight& light) const {
    const Vec3d direction = normalize(place.vector_from_world(-to_double(light.direction)));
    return ArrivingLight{direction, std::numeric_limits<double>::infinity(), light.irradiance};
  }
  std::optional<ArrivingLight> operator()(const ConstantLight&) const { return std::nullopt; }
  std::optional<ArrivingLight> operator()(const EnvironmentLight&) const { return std::nullopt; }
};

float power_of(const Light& light) {
  if (const auto* point = std::get_if<PointLight>(&light)) return luminance(point->intensity);
  if (const auto* spot = std::get_if<SpotLight>(&light)) return luminance(spot->intensity);
  return 0;
}
bool is_local(const Light& light) {
  return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light);
}

/// Instants at which a moving light is looked at for where it goes. In between it is taken to stray from a straight way
/// by no more than this part of it.
constexpr int kPlaces = 65;
/// Lights in a leaf, among which what they are worth is not estimated.
constexpr size_t kPunctualPerLeaf = 4;

}  // namespace

Lights::Lights(const Shot& shot, const Looks& looks, const Sky& sky)
    : sky_(sky), areas_(shot, looks), background_(shot.background) {
  std::vector<Punctual> local;
  for (size_t i = 0; i < shot.lights.size(); ++i) {
    const Light& light = shot.lights[i];
    if (const auto* constant = std::get_if<ConstantLight>(&light)) {
      environment_ += constant->radiance;
    } else if (const auto* picture = std::get_if<EnvironmentLight>(&light)) {
      const bool is_there = i < shot.light_textures.size() && shot.light_textures[i];
      if (!is_there) environment_ += picture->radiance;
    } else {
      (is_local(light) ? local : asked_)
          .push_back({light, i < shot.moving_lights.size() ? shot.moving_lights[i] : nullptr});
    }
  }
  const auto still = [](const Punctual& light) { return light.at == nullptr; };
  rest_ = areas_.rest() && std::all_of(asked_.begin(), asked_.end(), still) &&
          std::all_of(local.begin(), local.end(), still);
  if (local.size() <= kMostAsked) {
    asked_.insert(asked_.end(), local.begin(), local.end());
    return;
  }
  std::vector<LightBounds> bounds;
  for (const Punctual& light : local) {
    const LightBounds one = bounds_of(light);
    if (!(one.power > 0) || !std::isfinite(one.power)) continue;  // black
    bounds.push_back(one);
    many_.push_back(light);
  }
  tree_ = LightTree(bounds, kPunctualPerLeaf);
  std::vector<Punctual> sorted;
  for (const uint32_t light : tree_.order()) sorted.push_back(many_[light]);
  many_ = std::move(sorted);
}

LightBounds Lights::bounds_of(const Punctual& light) {
  LightBounds bounds;
  std::vector<LightBox> boxes;
  std::vector<float> times;
  double longest = 0;
  const int places = light.at ? kPlaces : 1;
  for (int i = 0; i < places; ++i) {
    const double time = static_cast<double>(i) / (kPlaces - 1);
    const Light there = light.at ? light.at(time) : light.light;
    const auto* spot = std::get_if<SpotLight>(&there);
    const Vec3d position = to_double(spot != nullptr ? spot->position : std::get<PointLight>(there).position);
    if (!boxes.empty()) longest = std::max(longest, length(position - boxes.back().low));
    boxes.push_back({position, position});
    times.push_back(static_cast<float>(time));
    bounds.power = std::max(bounds.power, static_cast<double>(power_of(there)));
    if (spot != nullptr && !light.at) {
      bounds.axis = normalize(to_double(spot->direction));
      bounds.spread = std::acos(std::clamp(static_cast<double>(spot->cos_outer), -1.0, 1.0)) + 1e-6;
      bounds.fade = 0;
    }
  }
  const Vec3d margin = Vec3d{1, 1, 1} * (longest / kPlaces);
  for (LightBox& box : boxes) box = {box.low - margin, box.high + margin};
  bounds.set_boxes(boxes, times);
  return bounds;
}

std::optional<ArrivingLight> Lights::arriving(const Punctual& one, Vec3d point, float time, const Place& place) {
  if (!one.at) return std::visit(Arrival{point, place}, one.light);
  return std::visit(Arrival{point, place}, one.at(static_cast<double>(time)));
}

std::optional<ArrivingLight> Lights::one_of_many(Vec3d point, Vec3d normal, float time, const Place& place,
                                                 float u) const {
  auto left = static_cast<double>(u);
  const LightTree::Leaf leaf =
      tree_.choose(place.vector_to_world(point) + place.origin, place.vector_to_world(normal), time, left);
  std::array<std::optional<ArrivingLight>, kPunctualPerLeaf> lights;
  std::array<double, kPunctualPerLeaf> worth{};
  double sum = 0;
  const size_t count = leaf.end - leaf.begin;
  for (size_t i = 0; i < count; ++i) {
    lights[i] = arriving(many_[leaf.begin + i], point, time, place);
    if (!lights[i]) continue;
    const double cosine = dot(normal, lights[i]->direction);
    if (cosine > 0) sum += worth[i] = static_cast<double>(luminance(lights[i]->irradiance)) * cosine;
  }
  if (!(sum > 0) || !std::isfinite(sum)) return std::nullopt;
  left *= sum;
  size_t chosen = count;
  for (size_t i = 0; i < count; ++i) {
    if (!(worth[i] > 0)) continue;
    chosen = i;
    if (left < worth[i]) break;
    left -= worth[i];
  }
  ArrivingLight light = *lights[chosen];
  light.irradiance = light.irradiance / static_cast<float>(leaf.probability * worth[chosen] / sum);
  return light;
}

}  // namespace kairos
