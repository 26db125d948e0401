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

  /// What made the light of the record rise (polarity 1) or fall (-1) when piece `piece` of it fired at `time`
  /// (seconds): what changed it most in that piece, or else in an earlier one. polarity 0: what is seen then.
  EventLabel label(size_t piece, double time, int polarity);

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
    Vec2d film;
  };
  /// Where a ray sees something else: in place of the sight before.
  struct Turn {
    double time, jump;
    size_t sight;
    bool arrives;   // what is seen then is the nearer one
    bool outlines;  // one hides the other; not so where triangles of a surface meet
  };
  /// A part of a change of light, by what made it.
  struct Cause {
    EventLabel label;
    double change, most;  // most: of a single ray, which saw `sight` of the surface
    size_t sight;
  };
  /// In place of a jump, over the time in which the edge passes the ray's cell. An edge that is too slow to be followed
  /// all over it does the rest of its way faster, at both ends: in steps all of that would happen at once.
  struct Ramp {
    double time;  // seconds, at which the ray itself jumps
    double jump;
    double rate, start;              // cells a second; cells past the middle, at `time`
    double near;                     // seconds: within so much of `time` the rate is the edge's own
    double rate_before, rate_after;  // before and after that
    double begin, end;               // seconds, in which it differs from the jump
    Coverage coverage;
    size_t turn;

    /// reach: seconds for which it may be followed, before and after `when`.
    Ramp(double when, double height, double own_rate, double begins_at, double reach, const Coverage& of, size_t by);

    /// How far the edge is past the cell's middle.
    double way(double now) const {
      const double since = now - time, outside = std::abs(since) - near;
      if (outside <= 0) return start + rate * since;
      return since < 0 ? start - rate * near - rate_before * outside : start + rate * near + rate_after * outside;
    }
    double when(double at_way) const;  ///< it is there
    double at(double now, bool jumped) const { return jump * (coverage.at(way(now)) - (jumped ? 1 : 0)); }
    double done(double now) const { return now < begin ? 0 : now > end ? jump : at(now, false); }
  };

  double light(const Vec3f& colour) const;
  void add_ray(const PixelRay& ray);
  void add_sight(const Segment& where, double begin, double end);
  void add_line(double begin, double end, double first, double last) {
    lines_.push_back({clock_.seconds(begin), clock_.seconds(end), first, last});
  }
  void add_parts(std::span<const SeenPart> layers, double begin, double end);
  void join(const PixelRay& ray, size_t sight);
  void cut();
  void add_cause(size_t front, uint32_t behind, bool edge, double change);
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
  std::vector<Sight> sights_;     // ray by ray, in order of time
  std::vector<Turn> turns_;
  std::vector<Cause> causes_;
  std::vector<uint8_t> is_ramp_;  // [turn]
  std::vector<Ramp> ramps_;       // by begin
  std::vector<size_t> active_;    // of ramps_
  std::vector<double> cuts_, knot_times_;
  std::vector<LightPiece> pieces_;
};

}  // namespace kairos
