// Layers of a picture that say which objects an exposure shows, how much of them, and how far away.
#pragma once

#include <kairos/deep_image.h>
#include <kairos/export.h>
#include <kairos/image.h>
#include <kairos/time_file.h>
#include <kairos/time_picture.h>

namespace kairos {

// `objects` are those of the picture over time that `frame` is of and that `image` is an exposure of.

/// Adds the channel "depth.Z": the nearest distance along the view axis that the exposure sees; +infinity for nothing.
KAIROS_API void add_depth(Image& image, const ExposedObjects& objects);
/// Adds the channel "mesh.id": 1 + index of the mesh that is seen most (the lowest of equals); 0 for nothing.
KAIROS_API void add_mesh_ids(Image& image, const ExposedObjects& objects);

enum class MatteKind {
  object,    ///< "CryptoObject": meshes, by name
  material,  ///< "CryptoMaterial"
};
/// Adds channels and attributes of Cryptomatte (J. Friedman and A. Jones 2015; specification 1.2): which names a pixel
/// shows, and how much of each, `ranks` of them at most (even), those with the largest coverage.
KAIROS_API void add_cryptomatte(Image& image, const ExposedObjects& objects, const TimeFrame& frame, MatteKind kind,
                                int ranks = 6);

/// One sample for each object of a pixel, and one for the background where the picture has no alpha, with its distance
/// behind everything. What lies further back is seen through what is nearer for the parts of the exposure and of the
/// pixel in which that is not there: alphas are such that samples composited "over" give the exposure, and distances
/// ascend strictly. Channels "R", "G", "B", "A", "Z" and "id" (1 + index of the mesh; 0: background).
KAIROS_API DeepImage deep_objects(const Image& image, const ExposedObjects& objects, const TimeFrame& frame);

/// One sample for each segment that a ray of the pixel sees during the exposure: a triangle, for as long as it is the
/// nearest thing. By the rule of deep_objects, with the same channels, and "time.begin" and "time.end": when, in parts
/// of the recorded time. `image` is the exposure under `weights`. What control variates add is
/// shared out. Throws what TimeFile::replay does.
KAIROS_API DeepImage deep_segments(const Image& image, const TimeFile& file, const PixelWeights& weights,
                                   const std::function<bool(double fraction)>& progress = {});

/// What every pixel shows over time as deep samples, a piece each: "R", "G", "B" and "A" (coverage) at its beginning,
/// "end.R", "end.G", "end.B" and "end.A" at its end; "Z", when it begins, and "ZBack", when it ends, in parts of the
/// recorded time. For programs that read samples, not for compositing. Throws what reading a file of time does;
/// Error(cancelled) when `progress` says so.
KAIROS_API DeepImage deep_pieces(const TimePicture& picture, const std::function<bool(double fraction)>& progress = {});

}  // namespace kairos
