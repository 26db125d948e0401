#include "motion/shape_boxes.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace kairos {

namespace {

constexpr size_t kTrianglesOfBox = 128, kMostBoxes = 256;

struct Extent3 {
  Vec3f low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

  void include(Vec3f p) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
};

class Division {
 public:
  Division(const Mesh& mesh, size_t most) : mesh_(mesh), most_(most) {}

  /// Halves the triangles along the longest side of their centres' extent until they are few.
  void divide(std::span<uint32_t> triangles, std::vector<BoxCorners>& boxes) const {
    if (triangles.size() <= most_) return boxes.push_back(corners(triangles));
    Extent3 extent;
    for (const uint32_t t : triangles) extent.include(centre(t));
    const Vec3f size = extent.high - extent.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = triangles.begin() + static_cast<ptrdiff_t>(triangles.size() / 2);
    std::nth_element(triangles.begin(), middle, triangles.end(), [&](uint32_t a, uint32_t b) {
      return std::pair(centre(a)[axis], a) < std::pair(centre(b)[axis], b);
    });
    divide(triangles.first(triangles.size() / 2), boxes);
    divide(triangles.subspan(triangles.size() / 2), boxes);
  }

 private:
  Vec3f corner(uint32_t triangle, size_t i) const { return mesh_.position(0, mesh_.triangle(triangle)[i]); }
  Vec3f centre(uint32_t t) const { return corner(t, 0) + corner(t, 1) + corner(t, 2); }
  BoxCorners corners(std::span<const uint32_t> triangles) const {
    Extent3 box;
    for (const uint32_t t : triangles)
      for (size_t i = 0; i < 3; ++i) box.include(corner(t, i));
    BoxCorners result;
    for (size_t c = 0; c < result.size(); ++c)
      result[c] = {(c & 1) != 0 ? box.high.x : box.low.x, (c & 2) != 0 ? box.high.y : box.low.y,
                   (c & 4) != 0 ? box.high.z : box.low.z};
    return result;
  }

  const Mesh& mesh_;
  size_t most_;
};

}  // namespace

std::vector<BoxCorners> shape_boxes(const Mesh& mesh) {
  std::vector<BoxCorners> boxes;
  std::vector<uint32_t> triangles(mesh.triangle_count());
  if (triangles.empty()) return boxes;
  std::iota(triangles.begin(), triangles.end(), 0u);
  Division(mesh, std::max(kTrianglesOfBox, triangles.size() / kMostBoxes + 1)).divide(triangles, boxes);
  return boxes;
}

}  // namespace kairos
