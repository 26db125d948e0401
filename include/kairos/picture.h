// The reduction of pixels to pictures.
#pragma once

#include <kairos/export.h>
#include <kairos/image.h>
#include <kairos/record.h>
#include <kairos/render.h>
#include <kairos/time_weight.h>

namespace kairos {

/// Means over a pixel's rays of the integrals over the shutter; zero without rays.
struct PixelMeans {
  Vec3f colour;                   ///< with the background in what is not covered
  Vec3f normal, albedo;           ///< zero where the record has no surfaces
  float coverage = 0;             ///< of all but sky and background
  float visibility_segments = 0;  ///< per ray
  /// The nearest distance at an end of any part of a mesh that is seen while the weight is not zero; +infinity for
  /// none.
  float depth = std::numeric_limits<float>::infinity();
  uint32_t mesh_id = 0;  ///< 1 + index of the mesh seen most (the lowest of equals), 0 for none
};

/// weight: of instants; the integral of what is seen times the weight is exact. count_meshes: find out mesh_id.
KAIROS_API PixelMeans reduce(const PixelRecord& record, const TimeWeight& weight = {}, bool count_meshes = true);

/// A picture under any weight of time. The channels are those of RenderParams::alpha and aovs beside the colour.
class KAIROS_API Picture : public PixelConsumer {
 public:
  /// Of the frame, or of the crop inside of it that `params` names; each pixel under its weight of `params.exposure`,
  /// if there is one, else under `weight`. Where a weight is not constant it needs curves. Throws Error(bad_usage) for
  /// an AOV named twice, a crop that is not in the frame, and two weights.
  Picture(const Projection& frame, const RenderParams& params, TimeWeight weight = {});

  RecordNeeds needs() const override;
  void add(const PixelRecord& record) override;

  /// The finished image, without attributes. Leaves the picture empty.
  Image take() { return std::move(image_); }
  /// The same, for who looks at it: no colour is below 0, where no weight is. A record is right in the mean over many
  /// pictures; in one, its still term may take away more than there is, and then 0 is nearer to the truth.
  Image take_shown();

 private:
  bool alpha_;
  std::vector<Aov> aovs_;
  TimeWeight weight_;
  std::optional<Exposure> exposure_;
  Image image_;
};

/// In which a screen shows a picture best, if nobody says: colours that say what a surface is stay as they are; light
/// needs room for what is brighter than a screen.
KAIROS_API ViewTransform usual_view(const Shot& shot, ShadingKind shading);

}  // namespace kairos
