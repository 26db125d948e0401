// How the shapes of a pbrt scene look: a material, a light of its own, and how much of it is there.
#pragma once

#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "scene_io/pbrt/geometry.h"
#include "scene_io/pbrt/light.h"
#include "scene_io/pbrt/material.h"

namespace kairos::pbrt {

/// How much of a shape is there.
struct Alpha {
  TextureRef image;
  double value = 1;  ///< 0 to 1
  friend bool operator==(const Alpha&, const Alpha&) = default;
};

/// What held when a shape was read. What a named material looks like may be known only at the end of the file.
struct Look {
  std::shared_ptr<const Surface> surface;
  std::shared_ptr<const AreaLight> light;  ///< null for none
  Alpha alpha;
  Place place;
};

/// Makes materials of looks, once all of a file is read; equal ones become one.
class SceneLooks {
 public:
  explicit SceneLooks(std::vector<Material>& materials) : materials_(materials) {}

  /// Nobody sees it, and it lights nothing: there is no need for it.
  static bool is_nothing(const Look& look) { return !look.light && (look.alpha.value == 0 || look.surface->invisible); }

  /// Its material's index. emitted: radiance of the shape's light, or black.
  uint32_t material_of(const Look& look, Vec3f emitted);

 private:
  using Key = std::tuple<std::shared_ptr<const Surface>, std::array<float, 3>, bool, bool, std::string,
                         std::array<float, 6>, TextureWrap, double>;

  std::vector<Material>& materials_;
  std::map<Key, uint32_t> indices_;
};

}  // namespace kairos::pbrt
