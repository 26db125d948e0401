// What a pixel shows at each instant: the mean over its rays.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <kairos/record.h>

namespace kairos {

/// Times are counted in ticks: so many are the shutter's time. Those of floats are multiples of one, or much shorter.
inline constexpr uint64_t kTicks = uint64_t{1} << 32;
inline constexpr double kTick = 0x1p-32;

/// Red, green, blue, coverage.
using Rgba = std::array<double, 4>;

/// Goes from `left` to `right` on a straight line, until the next one begins or the shutter closes.
struct SignalPiece {
  uint32_t begin = 0;  ///< ticks; 0 for the first, and ascending
  Rgba left{}, right{};
};

/// Makes signals of records. One thread's memory, reused from pixel to pixel.
class TimeSignal {
 public:
  /// At least one piece; valid until the next record. Rays of one instant count as if they held for all of the shutter,
  /// and so does the still term.
  std::span<const SignalPiece> make(const PixelRecord& record);
  /// What one mesh contributes to that: zero where it is not seen. Those of all meshes, and of the sky and the
  /// background, add to the signal.
  std::span<const SignalPiece> make_of_mesh(const PixelRecord& record, uint32_t mesh);

  /// By how much, at most, the integral of the signal from 0 to any instant is off because cuts are rounded to ticks.
  double shift() const { return shift_; }

 private:
  struct Event {
    Rgba jump, slope;  ///< change of both; slope: per tick
  };

  std::span<const SignalPiece> make_counted(const PixelRecord& record);
  bool counts(const SeenPart& part) const { return !mesh_ || part.where.mesh == *mesh_; }
  bool any_counts(std::span<const SeenPart> layers) const;
  void add(const PixelRay& ray, double share);
  void add_instant(std::span<const SeenPart> parts, double share);
  void add_layers(std::span<const SeenPart> layers, double share);
  void add_knots(const SeenPart& part, const Rgba& outside, double share, double coverage);
  void vary(const Rgba& by);
  void jump(uint64_t tick, const Rgba& by);
  void turn(uint64_t tick, const Rgba& by);
  Event& event(uint64_t tick);
  void sort_events();
  void sweep();

  double shift_ = 0;
  const PixelRecord* record_ = nullptr;
  std::optional<uint32_t> mesh_;  // the only one that counts
  Rgba background_{};             // zero where it does not count
  Rgba variation_{};
  Rgba start_{};  // what the signal begins with, without events at its beginning
  std::vector<Event> events_;
  std::vector<uint64_t> order_, sorted_;  // tick, number of the event
  std::vector<SignalPiece> pieces_;
};

}  // namespace kairos
