// What mirrors and panes show, exact in time, where they and the camera rest.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <kairos/tracer.h>

#include "discrete/discrete_scene.h"
#include "shading/shader.h"
#include "shading/step_sum.h"

namespace kairos {

/// A fixed ray that meets a mirror at rest goes on along a fixed ray, so that time-continuous rays tell what the mirror
/// shows, and when. docs/method.md, "Mirrors exact in time". Immutable.
class ExactMirrors {
 public:
  /// All of one shot. tracer: of the meshes that move, at least; scene: of all. meshes: [mesh], of
  /// Shader::resting_mirrors().
  ExactMirrors(const Shader& shader, const Tracer& tracer, const DiscreteScene& scene, std::vector<bool> meshes)
      : shader_(shader), tracer_(tracer), scene_(scene), meshes_(std::move(meshes)) {}

  bool on(uint32_t mesh) const { return meshes_[mesh]; }
  const Shader& shader() const { return shader_; }
  const Tracer& tracer() const { return tracer_; }
  const DiscreteScene& scene() const { return scene_; }
  const std::vector<bool>& meshes() const { return meshes_; }

 private:
  const Shader& shader_;
  const Tracer& tracer_;
  const DiscreteScene& scene_;
  std::vector<bool> meshes_;
};

/// What is seen by way of mirrors: the rays on which mirrors send a ray on, if they leave kLeastExact, and what these
/// see. Weaker reflections are left to shading samples, which follow discrete rays. One thread's memory.
class MirrorSights {
 public:
  /// Of a mirror's own light, so that some samples go there: it may be brighter than what the mirror shows.
  static constexpr float kLeastOwn = 1.0f / 16;

  struct Sight {
    Ray ray;
    Vec3f share;            ///< of the light along it, in what the camera sees
    float weight;           ///< the strongest component of that
    double width;           ///< of the ray's cone where it starts
    int depth;              ///< mirrors on its way
    float begin, end;       ///< shutter time in which it is looked along
    uint32_t first, count;  ///< of its segments
  };
  /// What a sight sees.
  struct Seen {
    Segment segment;
    float weight;  ///< in what the camera sees, of light that mirrors do not send on
  };

  void clear() {
    sights_.clear();
    seen_.clear();
  }
  /// Appends all sights of a mirror that a ray from the camera sees while `seen` lasts, in mirrors of mirrors, too.
  /// Returns the weight of the mirror's own light.
  float follow(const ExactMirrors& mirrors, const Ray& ray, const Segment& seen);

  std::span<const Sight> all() const { return sights_; }
  /// Valid until the next is followed.
  std::span<const Seen> seen_on(const Sight& sight) const { return std::span(seen_).subspan(sight.first, sight.count); }
  TraceCounters counters() const { return workspace_.counters(); }

 private:
  /// Returns the weight of what is not sent on.
  float follow_one(const ExactMirrors& mirrors, const ShadingQuery& query, Vec3f share, float begin, float end);

  Tracer::Workspace workspace_;
  std::vector<FollowedRay> onwards_;
  std::vector<Sight> sights_;
  std::vector<Seen> seen_;
};

/// What things that move change in mirrors, from what these would show if all of them were away: as
/// ShadingQuery::still_in has it. One thread's scratch memory.
class PassingInMirrors {
 public:
  /// Adds the differences, of what a ray from the camera sees of a mirror at `dist`, to `sum`. They are samples, right
  /// in the mean; where and when there are any is exact.
  void look(const ExactMirrors& mirrors, const Ray& ray, uint32_t mesh, uint32_t triangle, float dist, SampleKey key,
            const TimeRange& window, StepSum& sum);

  /// Did the last look find any?
  bool changes() const { return changes_; }
  uint64_t evaluations() const { return evaluations_; }
  TraceCounters counters() const { return workspace_.counters(); }

 private:
  struct Seen {
    ShadingQuery query;
    Vec3f share;
    float begin, end;
  };
  void follow(const ExactMirrors& mirrors, const Seen& seen, const FollowedRay& onwards, StepSum& sum);

  Tracer::Workspace workspace_;
  std::vector<FollowedRay> onwards_;
  std::vector<Seen> open_;  // mirrors to be followed
  bool changes_ = false;
  uint64_t evaluations_ = 0;
};

}  // namespace kairos
