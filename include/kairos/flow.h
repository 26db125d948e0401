// Optical flow: where what a pixel shows at one instant is at another.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>

#include <kairos/export.h>
#include <kairos/image.h>
#include <kairos/scene.h>
#include <kairos/tracer.h>

namespace kairos {

/// What is known of a pixel's point at the other instant: the values of the channel "flow.state".
enum class FlowState {
  unknown = 0,  ///< nothing: it is behind the camera, or the pixel shows a background that has no direction
  seen = 1,
  hidden = 2,   ///< something lies before it, or it is the back of a surface that is seen from its front alone
  outside = 3,  ///< it is outside of the frame
};

struct FlowOptions {
  bool backward = false;  ///< from when the shutter closes to when it opens
  std::optional<InstructionSet> instruction_set;
  int threads = 0;                                     ///< 0: as many as the machine has; no effect on the result
  std::function<bool(double fraction)> progress = {};  ///< as render's
  /// From when to when in each pixel of the frame, shutter times from 0 to 1 in any order, in place of the ends of the
  /// shutter's time: a rolling shutter's lines have instants of their own. Instants that are no keys lie on the
  /// straight lines between them.
  std::function<std::array<double, 2>(int x, int y)> times = {};
};

/// Of the point that each pixel's centre shows when the shutter opens, of opaque surfaces and cut-outs: channels
/// "flow.u" and "flow.v", by how many pixels it lies further right and further down when it closes (0 where unknown),
/// "flow.state" (FlowState), and "depth.Z", its distance along the view axis when the shutter opens (+infinity:
/// background, which is as far away as can be and moves as the camera turns). A point moves with its triangle, on
/// straight lines between the shot's keys; there are no differences over small times. Flow is a point sample, not a
/// mean over the pixel. Throws Error(bad_input) as a Renderer does, Error(bad_usage) for a shot of a single instant,
/// Error(cancelled).
KAIROS_API Image flow(const Shot& shot, const FlowOptions& options = {});

/// How a PNG holds flow.
enum class FlowCodes {
  kitti,  ///< 16 bits, 64ths of a pixel
  dsec,   ///< 16 bits, 128ths; what is farther than 256 pixels is marked as not valid
};
/// Writes flow by the path's extension: .flo (Middlebury's: unknown vectors are 1e10), .png (KITTI's: 16 bits, 64ths of
/// a pixel; what is unknown, or farther than 512 pixels, is marked as not valid; or others' `codes`), .exr (all
/// channels). Throws what write_image does, and Error(bad_usage) for an image without flow.
KAIROS_API void write_flow(const Image& flow, const std::string& path, FlowCodes codes = FlowCodes::kitti);

/// A PNG of disparities as KITTI and DSEC have them, 16 bits, 256ths of a pixel: focal_baseline / depth, of the image's
/// channel "depth.Z". 0: farther than can be said, or nearer. Throws what write_flow does.
KAIROS_API void write_disparity(const Image& depth, double focal_baseline, const std::string& path);

/// A PNG that is white where a point is not seen at the other instant (Sintel's occlusions), and black elsewhere.
KAIROS_API void write_occlusion(const Image& flow, const std::string& path);

/// Throws what write_flow would, as far as that is known before there is any flow.
KAIROS_API void check_writable_flow(const std::string& path);

}  // namespace kairos
