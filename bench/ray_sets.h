// The rays that benchmarks trace: the same on every machine and in every run.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <kairos/scene.h>
#include <kairos/tracer.h>

#include "integrators/camera_rays.h"
#include "math/hash.h"
#include "math/sampler.h"

namespace kairos::bench {

struct RaySet {
  std::vector<Ray> rays;
  std::vector<float> times;  ///< of each as a discrete ray
};

/// Sample points of a picture, pixel by pixel in tiles, as an integrator takes them; only so many tiles, spread evenly
/// over the picture, as give about `wanted` rays.
inline RaySet camera_rays(const Projection& projection, int rays_per_pixel, size_t wanted) {
  constexpr int kTile = 16;
  const int columns = (projection.width + kTile - 1) / kTile, rows = (projection.height + kTile - 1) / kTile;
  const size_t tiles = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  const size_t rays_per_tile = static_cast<size_t>(kTile * kTile * rays_per_pixel);
  const double stride = std::max(1.0, static_cast<double>(tiles * rays_per_tile) / static_cast<double>(wanted));
  const CameraRays camera(projection);
  const Sampler sampler(SamplerKind::owen_sobol, static_cast<uint32_t>(rays_per_pixel), 0);
  RaySet set;
  for (double place = 0; place < static_cast<double>(tiles); place += stride) {
    const int tile = static_cast<int>(place), x0 = tile % columns * kTile, y0 = tile / columns * kTile;
    for (int y = y0; y < std::min(y0 + kTile, projection.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, projection.width); ++x) {
        const Sampler::Pixel pixel = sampler.pixel(x, y);
        for (uint32_t i = 0; i < sampler.count(); ++i) {
          const SamplePoint point = sampler.point(pixel, i);
          set.rays.push_back(camera.at(x + point.x, y + point.y));
          set.times.push_back(point.time);
        }
      }
  }
  return set;
}

/// Random origins inside the scene and random directions: each ray goes its own way. "Inside" is the box that holds
/// all but the outermost fiftieth of the triangles along each axis: a meadow to the horizon does not count.
inline RaySet incoherent_rays(const std::vector<Mesh>& meshes, size_t count) {
  std::array<std::vector<float>, 3> places;
  for (const Mesh& mesh : meshes)
    for (const Triangle& triangle : mesh.triangles)
      for (int axis = 0; axis < 3; ++axis)
        places[static_cast<size_t>(axis)].push_back(mesh.positions.front()[triangle[0]][axis]);
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
