// Pictures of the bounds that the tracer works with: for how long a ray meets the box of a moving mesh.
//
// The box around a mesh at one key moves linearly to that at the next. The kernels' test says from when to when a ray
// meets it; what it says is shown from blue (an instant) to red (the whole shutter), the longest of all meshes' where
// several are met. Beside it stands the exact answer, so that one can see what the bound gives away.
#include <algorithm>

#include <kairos/error.h>

#include "accel/layout.h"
#include "accel/moving_box.h"
#include "integrators/integrator.h"
#include "integrators/shot_parts.h"
#include "kernels/dispatch.h"
#include "kernels/moving_box_test.h"

namespace kairos {

namespace {

constexpr Vec3f kShortest{0, 0, 1}, kLongest{1, 0, 0};

/// The boxes of up to eight key spans of one mesh.
struct BoxNode {
  Node<kMovingKeys> boxes;
  float length[kWidth];  ///< of the key spans, shutter time
  uint32_t mesh;
};

std::vector<BoxNode> make_boxes(const Shot& shot) {
  std::vector<BoxNode> nodes;
  for (uint32_t m = 0; m < shot.meshes.size(); ++m) {
    const Mesh& mesh = shot.meshes[m];
    if (mesh.triangle_count() == 0) continue;
    uint32_t slot = kWidth;
    for (size_t key = 0; key + 1 < mesh.key_count(); ++key) {
      const float length = mesh.key_times[key + 1] - mesh.key_times[key];
      if (!(length > 0)) continue;  // a jump takes no time
      MovingBox box = MovingBox::empty();
      for (const Triangle& triangle : mesh.shape().triangles)
        for (const uint32_t vertex : triangle)
          for (int end = 0; end < 2; ++end) box.include(end, mesh.position(key + static_cast<size_t>(end), vertex));
      if (slot == kWidth) {
        nodes.push_back({{}, {}, m});
        slot = 0;
      }
      BoxNode& node = nodes.back();
      node.boxes.count = slot + 1;
      node.length[slot] = length;
      for (uint32_t place = slot; place < (slot == 0 ? kWidth : slot + 1); ++place)  // empty slots repeat the first
        for (int end = 0; end < 2; ++end)
          for (int axis = 0; axis < 3; ++axis) {
            node.boxes.lower[end][axis][place] = box.lower(end, axis);
            node.boxes.upper[end][axis][place] = box.upper(end, axis);
          }
      ++slot;
    }
  }
  return nodes;
}

/// For how long, in shutter time, a ray meets the boxes of a node, and from which distance on.
struct Stay {
  double duration = 0;
  float dist = std::numeric_limits<float>::infinity();

  void add(double share, float length, double from) {
    duration += share * static_cast<double>(length);
    dist = std::min(dist, static_cast<float>(from));
  }
};

Stay stay_computed(const BoxNode& node, const Ray& ray, const Kernels& kernels) {
  NodeHits hits;
  kernels.test_node(node.boxes, ray, hits);
  Stay stay;
  for (uint32_t slot = 0; slot < node.boxes.count; ++slot)
    if ((hits.mask >> slot & 1) != 0)
      stay.add(static_cast<double>(hits.end[slot]) - static_cast<double>(hits.begin[slot]), node.length[slot],
               static_cast<double>(hits.dist[slot]));
  return stay;
}

Stay stay_exact(const BoxNode& node, const Ray& ray) {
  Stay stay;
  for (uint32_t slot = 0; slot < node.boxes.count; ++slot) {
    Vec3d lower[2], upper[2];
    for (int end = 0; end < 2; ++end)
      for (int axis = 0; axis < 3; ++axis) {
        lower[end][axis] = node.boxes.lower[end][axis][slot];
        upper[end][axis] = node.boxes.upper[end][axis][slot];
      }
    if (const auto met = intersect_moving_box(to_double(ray.origin), to_double(ray.direction), lower, upper))
      stay.add(met->end - met->begin, node.length[slot], met->dist);
  }
  return stay;
}

class BoundsIntegrator : public Integrator {
 public:
  /// kernels: null for the exact answer.
  BoundsIntegrator(const Shot& shot, const Kernels* kernels, const PixelContext& context)
      : kernels_(kernels), context_(context), nodes_(make_boxes(shot)) {}

  std::unique_ptr<Worker> make_worker() const override { return std::make_unique<BoundsWorker>(*this); }

 private:
  class BoundsWorker : public Worker {
   public:
    explicit BoundsWorker(const BoundsIntegrator& integrator)
        : integrator_(integrator), record_(integrator.context_.needs.surfaces()) {}

    const PixelRecord& render_pixel(int x, int y, Monitor& monitor) override {
      record_.begin_pixel(x, y, integrator_.context_.background);
      const Sampler& sampler = integrator_.context_.sampler;
      const Sampler::Pixel pixel = sampler.pixel(x, y);
      for (uint32_t i = 0; i < sampler.count(); ++i) {
        if (i % kRaysPerPoll == 0) monitor.poll();
        const SamplePoint point = sampler.point(pixel, i);
        add(integrator_.context_.ray(x, y, point), integrator_.context_.film(point));
      }
      rays_ += sampler.count();
      return record_.finish();
    }
    void add_counts(RenderStats& stats) const override { stats.rays += rays_; }

   private:
    void add(const Ray& ray, Vec2f film) {
      Stay longest, stay;  // of all meshes; of the current one
      uint32_t mesh = kNoMesh;
      const auto& nodes = integrator_.nodes_;
      for (size_t n = 0; n < nodes.size(); ++n) {
        const Stay some = integrator_.kernels_ != nullptr ? stay_computed(nodes[n], ray, *integrator_.kernels_)
                                                          : stay_exact(nodes[n], ray);
        stay.duration += some.duration;
        stay.dist = std::min(stay.dist, some.dist);
        if (n + 1 < nodes.size() && nodes[n + 1].mesh == nodes[n].mesh) continue;
        if (stay.duration > longest.duration) {
          longest = stay;
          mesh = nodes[n].mesh;
        }
        stay = {};
      }
      const uint32_t first = record_.part_count();
      if (mesh != kNoMesh) {
        const auto share = static_cast<float>(std::min(longest.duration, 1.0));
        const Vec3f colour = lerp(kShortest, kLongest, share);
        const uint32_t knot = record_.add_knot(0, colour, {}, colour);
        record_.add_part({{0, 0, longest.dist, longest.dist, mesh, 0, false}, knot});
      }
      const uint32_t parts = record_.part_count() - first;
      record_.add_ray({film, 1, 0, first, parts, parts});
    }

    const BoundsIntegrator& integrator_;
    RecordBuilder record_;
    uint64_t rays_ = 0;
  };

  const Kernels* kernels_;
  const PixelContext& context_;
  std::vector<BoxNode> nodes_;  // a mesh's own beside each other
};

}  // namespace

std::unique_ptr<Integrator> make_bounds_integrator(const Shot& shot, const RenderParams& params,
                                                   const PixelContext& context, RenderStats& stats) {
  if (params.shading == ShadingKind::bounds_exact) return std::make_unique<BoundsIntegrator>(shot, nullptr, context);
  const InstructionSet set = params.instruction_set.value_or(supported_instruction_sets().back());
  const Kernels* kernels = find_kernels(set);
  if (kernels == nullptr)
    throw Error(ErrorCode::bad_usage, "instruction set",
                std::string(to_string(set)) + " is not there on this machine; leave it out for the best one");
  stats.instruction_set = set;
  // The scalar kernels have the exact test and no other.
  return std::make_unique<BoundsIntegrator>(shot, kernels->test_node != nullptr ? kernels : nullptr, context);
}

}  // namespace kairos
