// How much light a pixel gets, as a function of time in closed form.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <kairos/events.h>
#include <kairos/record.h>

#include "events/coverage.h"
#include "events/edge_motion.h"

namespace kairos {

/// A parabola through its values at both ends and halfway. At its end the light may jump to where the next one begins.
struct LightPiece {
  double begin, end;  ///< seconds
  double first, middle, last;
};

/// The shutter's time as seconds, and the part of it that pieces are wanted for. What lies before and after it is there
/// for edges that are on their way over the pixel.
struct LightClock {
  double open = 0, close = 1;  ///< seconds: of shutter times 0 and 1
  double begin = 0, end = 1;   ///< seconds
  double reach = 1;            ///< seconds: so long before and after it passes a ray an edge is followed

  double seconds(double time) const { return open + (close - open) * time; }
  double shutter_time(double seconds) const { return (seconds - open) / (close - open); }
};

/// What a pixel's light was made of.
struct LightCounts {
  uint64_t edges = 0, steps = 0;
  double fastest = 0;  ///< pixels a second

  void add(const LightCounts& other) {
    edges += other.edges;
    steps += other.steps;
    fastest = std::max(fastest, other.fastest);
  }
};

/// Makes it of records. One thread's memory, reused from pixel to pixel. docs/events.md, "Edges".
class PixelIntensity {
 public:
  /// Reads the finder and must not outlive it. cells: per side of the pixel, each with one ray.
  PixelIntensity(const EdgeFinder& edges, const LightClock& clock, EdgeModel model, int cells, double dark)
      : edges_(edges), clock_(clock), model_(model), cells_(cells), dark_(dark) {}

  /// channels: how much red, green and blue count. In order, without gaps; at least one; valid until the next record.
  std::span<const LightPiece> make(const PixelRecord& record, const Vec3f& channels);

  const LightCounts& counts() const { return counts_; }

 private:
  /// A straight line of a ray's light.
  struct Line {
    double begin, end;  // seconds
    double first, last;

    double at(double time) const {
      return begin < end ? first + (last - first) * ((time - begin) / (end - begin)) : first;
    }
  };
  /// Some lines, during which one surface is seen.
  struct Sight {
    Segment where;
    size_t first_line, lines;
  };
  /// In place of a jump, over the time in which the edge passes the ray's cell.
  struct Ramp {
    double time;  // seconds, at which the ray itself jumps
    double jump;
    double rate, start;  // cells a second; cells past the middle, at `time`
    double begin, end;   // seconds, in which it differs from the jump
    Coverage coverage;

    double at(double now, bool jumped) const {
      return jump * (coverage.at(start + rate * (now - time)) - (jumped ? 1 : 0));
    }
  };

  double light(const Vec3f& colour) const;
  void add_ray(const PixelRay& ray);
  void add_sight(const Segment& where, double begin, double end);
  void add_line(double begin, double end, double first, double last) {
    lines_.push_back({clock_.seconds(begin), clock_.seconds(end), first, last});
  }
  void add_parts(std::span<const SeenPart> layers, double begin, double end);
  void join(const PixelRay& ray, Sight& before, Sight& after);
  void cut();
  double value(double time, double within) const;

  const EdgeFinder& edges_;
  LightClock clock_;
  EdgeModel model_;
  int cells_;
  double dark_;
  LightCounts counts_;
  const PixelRecord* record_ = nullptr;
  Vec3f channels_{};
  double share_ = 1;              // of a ray
  std::vector<Line> lines_;       // ray by ray, in order of time
  std::vector<size_t> ray_ends_;  // of lines_
  std::vector<size_t> cursors_;   // [ray]: its line at the time that is looked at
  std::vector<Sight> sights_;     // of the ray
  std::vector<Ramp> ramps_;       // by begin
  std::vector<size_t> active_;    // of ramps_
  std::vector<double> cuts_, knot_times_;
  std::vector<LightPiece> pieces_;
};

}  // namespace kairos
