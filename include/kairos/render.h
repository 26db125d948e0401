// From a shot to a picture.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <kairos/export.h>
#include <kairos/image.h>
#include <kairos/record.h>
#include <kairos/scene.h>
#include <kairos/shutter.h>
#include <kairos/tracer.h>

namespace kairos {

enum class IntegratorKind {
  tc,         ///< time-continuous rays: exact in time, sampled over the pixel
  qmc,        ///< discrete rays, sampled over the pixel and the shutter
  automatic,  ///< mixed, with the number of rays of each kind chosen per pixel for the time of `spp` discrete samples
  mixed,      ///< time-continuous rays where anything moves, discrete rays for what stands still relative to the camera
};
enum class SamplerKind {
  owen_sobol,    ///< Owen-scrambled Sobol' points, jointly in x, y and time
  multi_jitter,  ///< correlated multi-jittered in x and y, time stratified apart
  random,        ///< independent
};
enum class ShadingKind {
  normal,   ///< (|n.x|, |n.y|, |n.z|) of the unit normal in world space: the mesh's own, or the triangle's
  flat,     ///< base colour plus emission, unlit
  whitted,  ///< lit, with shadows, mirrors and glass
  path,     ///< lit by what surfaces scatter, too: paths of light
  // No surfaces, whatever the integrator: from blue (never) to red (all of the shutter), for how long a ray meets the
  // box of a moving mesh, which moves linearly from key to key.
  bounds,        ///< as the kernels' test of tree nodes says, which may say too much
  bounds_exact,  ///< as it is
};
/// Does the shading ask for lights?
constexpr bool is_lit(ShadingKind kind) { return kind == ShadingKind::whitted || kind == ShadingKind::path; }
/// What gets a shading sample of its own along a time-continuous ray.
enum class Clusters {
  automatic,  ///< pixel; of lit pictures where blended surfaces are seen, on
  on,         ///< each cluster: segments that touch, of triangles that join smoothly
  pixel,      ///< all rays of a pixel that are traced together: each triangle, or lit all they see
  off,        ///< each segment
};
/// How it is found what stands between lit surfaces and point, spot and directional lights.
enum class Shadows {
  automatic,  ///< exact where it is worth it, by looks at some pixels
  sampled,    ///< by discrete rays, at the instants of shading samples
  exact,      ///< in time, wherever surface, light and camera rest; elsewhere sampled
};
/// How it is found what mirrors and panes show of what moves.
enum class Mirrors {
  automatic,  ///< tc: exact; mixed: exact where it is worth it, by looks at some pixels; automatic: sampled
  sampled,    ///< by discrete rays, at the instants of shading samples
  exact,      ///< in time, in Whitted's shading, wherever the mirror and the camera rest; elsewhere sampled
};
/// Does light that arrives at a point of a surface count for all pixels that see the point while it moves? Of lit
/// pictures under a mean over the shutter, and seen through nothing blended by time-continuous rays. Light is then
/// blurred by a cell of the surface, of 1 to 8 pixels, as a race in a few pixels finds best. docs/method.md,
/// "Surface cells".
enum class Cells {
  automatic,  ///< of `tc`, `mixed` and `automatic`, in pictures of 37,000 pixels and more, if it brings light clearly
              ///< nearer to the truth in those pixels
  on,
  off,  ///< every pixel looks for its light by itself
};
enum class FilterKind {
  box,              ///< the pixel itself
  gaussian,         ///< standard deviation 0.5 px, cut at 1.5 px
  blackman_harris,  ///< 3 px wide
};

/// Channels beside the colour. Means are over the pixel and the shutter, with zero where nothing is seen: divide by the
/// coverage for the mean over what is seen.
enum class Aov {
  depth,     ///< "depth.Z": nearest distance along the view axis over the pixel and the shutter; +infinity for nothing
  normal,    ///< "normal.X", "normal.Y", "normal.Z": mean of the unit normal in world space
  albedo,    ///< "albedo.R", "albedo.G", "albedo.B": mean base colour
  coverage,  ///< "coverage.A": the fraction in which anything is seen
  segments,  ///< "segments.Y": mean number of visibility segments per ray (discrete rays: of hits)
  mesh,      ///< "mesh.id": 1 + index of the mesh that is seen most (the lowest of equals); 0 for nothing
};

/// Pixels [x0, x1) x [y0, y1) of the frame.
struct Crop {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

/// Processor time of rays of one shot, in nanoseconds, on one thread, where something moves: tracing, shading and
/// adding up. See Renderer::calibrate.
struct Calibration {
  /// Time-continuous rays per pixel of which the time is known: the more there are, the less does each take.
  static constexpr std::array<int, 3> kRays{1, 4, 16};

  double discrete_sample = 0;  ///< of everything; above 0
  double still_ray = 0;        ///< a discrete ray to what stands still; 0 where nothing does, or it is never seen
  std::array<double, kRays.size()> tc_ray{};  ///< a time-continuous ray, of kRays in a pixel; above 0
};

/// A calibration, and the shading that it was measured with.
struct CalibrationFile {
  Calibration calibration;
  ShadingKind shading = ShadingKind::normal;
};
/// JSON, from which the same numbers are read. Throw Error(io) when the system refuses; reading throws Error(bad_input)
/// for a file that is none or holds numbers that make no sense.
KAIROS_API CalibrationFile read_calibration(const std::string& path);
KAIROS_API void write_calibration(const CalibrationFile& file, const std::string& path);

/// In units of one discrete sample of everything; see Calibration.
struct RayPrices {
  std::array<double, Calibration::kRays.size()> tc_ray{8, 8, 8};
  double still_ray = 0.3;

  friend bool operator==(const RayPrices&, const RayPrices&) = default;
};

struct RenderParams {
  IntegratorKind integrator = IntegratorKind::automatic;
  int tc_rays = 16;         ///< tc: rays per pixel; mixed: the same, where anything moves; 1 to 2^20
  int shading_samples = 8;  ///< per time-continuous ray, over its segments by duration; with `on` and `off` at least
                            ///< one in each cluster (and no more where nothing changes); 1 to 2^16
  /// Scene time over which a ray takes its shading samples: shots that follow each other go on with the same random
  /// numbers if they have it in common. 0: while the shutter is open.
  double shading_interval = 0;
  Clusters clusters = Clusters::automatic;
  Shadows shadows = Shadows::automatic;  ///< `qmc`, and without clusters by pixel: sampled
  Mirrors mirrors = Mirrors::automatic;  ///< `qmc`, without clusters by pixel, and with cells: sampled
  Cells cells = Cells::automatic;
  int spp = 64;  ///< qmc: samples per pixel; mixed: rays to what stands still; automatic: the budget, in the
                 ///< time of samples of qmc, on average over the pixels; 1 to 2^20
  SamplerKind sampler = SamplerKind::owen_sobol;
  ShadingKind shading = ShadingKind::normal;
  int max_depth = 8;  ///< whitted: how often a ray may be reflected or refracted; path: or scattered; 0 to 64
  /// path: the most that light which is scattered more than once may bring to a shading sample, in any component; what
  /// is brighter is darkened as a whole. 0: no limit, and nothing of the light is lost.
  float clamp = 0;
  FilterKind filter = FilterKind::box;
  std::vector<Aov> aovs;
  /// When each pixel is exposed while the shutter is open, and how much each of its instants counts. Rays look at that
  /// time alone. Made for this shot and its frame; its curve is nowhere negative. Unset: every pixel all the time.
  std::optional<Exposure> exposure;
  /// A channel "A" beside the colour: the coverage, which is the colour's alpha, premultiplied, where the shot's
  /// backdrop is black.
  bool alpha = false;
  std::optional<Crop> crop;  ///< unset: the whole frame; its pixels are those of the whole frame, bit for bit
  uint64_t seed = 0;
  int threads = 0;  ///< 0: as many as the machine has; no effect on the picture. Pictures rendered at the same time do
                    ///< not bind each other
  /// Of the kernels and of Embree, which rounds differently with each; unset: the best one. Where the picture of two
  /// machines must have the same bits, name one that both have.
  std::optional<InstructionSet> instruction_set;
  /// automatic: what rays cost in this shot. Unset: estimated from how much work a few of them are. The picture depends
  /// on these numbers, and never on how long anything takes while it is rendered.
  std::optional<Calibration> calibration;
  /// Motion is given to Embree with at least this many keys, in even steps between those that the shot has: 0 (only
  /// those) to 129. More of them make its boxes tighter and its trees larger; the motion stays the same.
  int discrete_keys = 0;
};

/// Wall clock, of parts that many pictures of a shot can share.
struct BuildSeconds {
  double tracer = 0;       ///< trees for time-continuous rays
  double discrete = 0;     ///< Embree's for discrete rays
  double motion_mask = 0;  ///< where on screen anything moves
  double shading = 0;      ///< tables of the shader

  double sum() const { return tracer + discrete + motion_mask + shading; }
};

struct RenderStats {
  double build_seconds = 0;       ///< wall clock: all parts that this picture uses, and what it alone needs
  BuildSeconds parts;             ///< of the parts it uses; those made for an earlier picture count as much
  double render_seconds = 0;      ///< wall clock
  double render_cpu_seconds = 0;  ///< processor time of the whole process, over all threads, while it renders
  /// Of these two, what is looked at before the first pixel: for the whole frame, whatever the crop.
  double prepare_seconds = 0, prepare_cpu_seconds = 0;
  uint64_t rays = 0;                              ///< from the camera
  uint64_t segments = 0;                          ///< visibility segments (discrete rays: hits)
  uint64_t shading_samples = 0;                   ///< shading evaluations
  TraceCounters counters;                         ///< tc, mixed
  size_t accel_memory_bytes = 0;                  ///< tc, mixed
  uint64_t moving_pixels = 0;                     ///< mixed, automatic: in which something may move
  uint64_t tc_pixels = 0;                         ///< of them: with time-continuous rays
  std::optional<RayPrices> prices;                ///< automatic: by which rays were chosen; unset where nothing moves
  int threads = 0;                                ///< used
  std::optional<InstructionSet> instruction_set;  ///< of the tc kernels; unset: discrete rays
  std::optional<InstructionSet> embree_instruction_set;  ///< of discrete rays; unset: tc alone
};

/// Told the fraction done, 0 to 1, by the thread that called: at once, about twenty times a second while other threads
/// work, and with 1 at the end. Returning false stops rendering, within about a tenth of a second but for what Embree
/// builds; so does an exception, which reaches the caller.
using Progress = std::function<bool(double fraction)>;

/// Renders a shot again and again: what is expensive is made once, when a picture first needs it, and kept. A picture
/// does not depend on those before it.
class KAIROS_API Renderer {
 public:
  /// The shot, in camera space, must outlive the renderer and not change. Throws Error(bad_input) when it breaks an
  /// invariant: everything behind this door relies on them.
  explicit Renderer(const Shot& shot);
  explicit Renderer(Shot&& shot) = delete;
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Hands every pixel to all of the consumers, which are asked first what they need. One rendering at a time. Throws
  /// Error(bad_usage) for parameters out of range and needs that the integrator cannot meet, Error(cancelled) when
  /// `progress` says so, and what consumers throw.
  void render(const RenderParams& params, std::span<PixelConsumer* const> consumers, RenderStats* stats = nullptr,
              const Progress& progress = {});

  /// The same with a Picture under a box as the only consumer. The image's attributes say how it was made.
  /// Throws Error(bad_usage) for parameters out of range, Error(cancelled) when `progress` says so.
  Image render(const RenderParams& params = {}, RenderStats* stats = nullptr, const Progress& progress = {});

  /// Measures what rays cost, for RenderParams::calibration: a few seconds on one thread, in pixels of the whole frame
  /// in which something moves. Of `params`, what rays are shaded with counts, and the kernels they use. Throws
  /// Error(bad_input) where nothing moves.
  Calibration calibrate(const RenderParams& params = {}, const Progress& progress = {});

 private:
  std::unique_ptr<class ShotParts> parts_;
};

/// Says in the image's attributes how it was made.
KAIROS_API void describe(Image& image, const Shot& shot, const RenderParams& params, const RenderStats& stats);

/// Renders a single picture.
KAIROS_API Image render(const Shot& shot, const RenderParams& params = {}, RenderStats* stats = nullptr,
                        const Progress& progress = {});

}  // namespace kairos
