// The rays that benchmarks trace: the same on every machine and in every run.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "camera/camera_rays.h"
#include "math/hash.h"
#include "math/sampler.h"

namespace kairos::bench {

struct RaySet {
  std::vector<Ray> rays;
  std::vector<float> times;  ///< of each as a discrete ray
};

/// Upper left corners of square tiles, at most `wanted`, that lie evenly over the picture, in rows; all of them where
/// there are no more.
inline std::vector<std::array<int, 2>> tiles_of(const Projection& projection, int side, uint32_t wanted) {
  const int columns = (projection.width + side - 1) / side, rows = (projection.height + side - 1) / side;
  std::vector<std::array<int, 2>> tiles;  // row, column
  if (static_cast<int64_t>(columns) * rows <= wanted) {
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) tiles.push_back({row, column});
  } else {
    const Sampler places(SamplerKind::owen_sobol, std::max(1u, wanted), 0);
    for (uint32_t i = 0; i < places.count(); ++i) {
      const SamplePoint place = places.point(places.pixel(0, 0), i);
      tiles.push_back({static_cast<int>(place.y * static_cast<float>(rows)),
                       static_cast<int>(place.x * static_cast<float>(columns))});
    }
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  }
  for (auto& tile : tiles) tile = {tile[1] * side, tile[0] * side};
  return tiles;
}

/// Sample points of the pixels of some tiles, pixel by pixel, as an integrator takes them. The same pixels for any
/// number of rays.
inline RaySet camera_rays(const Projection& projection, int rays_per_pixel, uint32_t tiles) {
  constexpr int kTile = 16;
  const CameraRays camera(projection);
  const Sampler sampler(SamplerKind::owen_sobol, static_cast<uint32_t>(rays_per_pixel), 0);
  RaySet set;
  for (const auto& [x0, y0] : tiles_of(projection, kTile, tiles))
    for (int y = y0; y < std::min(y0 + kTile, projection.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, projection.width); ++x) {
        const Sampler::Pixel pixel = sampler.pixel(x, y);
        for (uint32_t i = 0; i < sampler.count(); ++i) {
          const SamplePoint point = sampler.point(pixel, i);
          set.rays.push_back(camera.at(x + point.x, y + point.y));
          set.times.push_back(point.time);
        }
      }
  return set;
}

/// Random origins inside the scene and random directions: each ray goes its own way. "Inside" is the box that holds
/// all but the outermost fiftieth of the triangles along each axis: a meadow to the horizon does not count. Of many
/// millions some are looked at.
inline RaySet incoherent_rays(const std::vector<Mesh>& meshes, size_t count) {
  constexpr size_t kMostLookedAt = 10'000'000;
  size_t all_triangles = 0;
  for (const Mesh& mesh : meshes) all_triangles += mesh.triangle_count();
  const size_t step = 1 + all_triangles / kMostLookedAt;
  std::array<std::vector<float>, 3> places;
  size_t passed = 0;  // triangles
  for (const Mesh& mesh : meshes)
    for (const Triangle& triangle : mesh.shape().triangles) {
      if (passed++ % step != 0) continue;
      const Vec3f place = mesh.position(0, triangle[0]);
      for (int axis = 0; axis < 3; ++axis) places[static_cast<size_t>(axis)].push_back(place[axis]);
    }
  std::array<float, 3> low{}, high{};
  for (size_t axis = 0; axis < 3; ++axis) {
    std::vector<float>& all = places[axis];
    if (all.empty()) return {};
    const auto at = [&](size_t index) {
      std::nth_element(all.begin(), all.begin() + static_cast<ptrdiff_t>(index), all.end());
      return all[index];
    };
    low[axis] = at(all.size() / 50);
    high[axis] = at(all.size() - 1 - all.size() / 50);
  }
  RaySet set;
  for (uint64_t i = 0; i < count; ++i) {
    const auto number = [&](uint64_t which) { return unit_float(hash(i, which)); };
    const auto place = [&](size_t axis) { return low[axis] + (high[axis] - low[axis]) * number(axis); };
    const float up = 2 * number(3) - 1, out = std::sqrt(std::max(0.0f, 1 - up * up));
    const float angle = 2 * std::numbers::pi_v<float> * number(4);
    set.rays.push_back({{place(0), place(1), place(2)}, {out * std::cos(angle), up, out * std::sin(angle)}});
    set.times.push_back(number(5));
  }
  return set;
}

}  // namespace kairos::bench
