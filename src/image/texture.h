// A picture that surfaces look up colours in.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <kairos/scene.h>
#include <kairos/vec.h>

#include "image/pixels.h"

namespace kairos {

struct Texel {
  Vec3f colour;  ///< linear
  float alpha = 1;
};

/// A pyramid of ever smaller copies of a picture. Immutable and safe to use from many threads at once.
class Texture {
 public:
  /// What the codes of formats of 8 and 16 bits mean. Alpha is always linear.
  enum class Encoding {
    srgb,    ///< colours
    linear,  ///< numbers
  };

  Texture(Pixels pixels, Encoding encoding);

  /// uv: (0, 0) is the picture's upper left corner, (1, 1) its lower right one. footprint: how wide a piece to average
  /// over, in texels of the picture; at most 1 gives the picture itself. wrap: along u and v. Bilinear in the two
  /// nearest levels of the pyramid, linear between them; with `nearest`, a footprint of at most 1 gives the texel that
  /// uv lies in.
  Texel at(Vec2f uv, float footprint, std::array<TextureWrap, 2> wrap = {}, bool nearest = false) const;

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  bool has_alpha() const { return has_alpha_; }  ///< is it anywhere below 1?
  size_t memory_bytes() const;

 private:
  Texel texel(const Pixels& level, int x, int y) const;
  Texel containing(const Pixels& level, Vec2f uv, std::array<TextureWrap, 2> wrap) const;
  Texel bilinear(const Pixels& level, Vec2f uv, std::array<TextureWrap, 2> wrap) const;
  Pixels half_of(const Pixels& level) const;
  void store(Pixels& level, size_t index, const Texel& value) const;

  std::array<float, 256> decoded_;  // colour codes
  std::vector<Pixels> levels_;      // [0] is the picture
  bool has_alpha_ = false;
};

}  // namespace kairos
