#include <kairos/cut_outs.h>

#include "shading/cut_outs.h"
#include "shading/looks.h"

namespace kairos {

namespace {

/// Cut-outs alone: who asks what a ray meets wants to be told of blended surfaces, too.
class ShotCutOuts : public CutOuts {
 public:
  explicit ShotCutOuts(const Shot& shot) : looks_(shot), alpha_(shot, looks_) {}

  bool has(uint32_t mesh) const override { return alpha_.has(mesh) && !alpha_.is_blended(mesh); }
  bool solid(const Ray& ray, uint32_t mesh, uint32_t triangle, float time) const override {
    return alpha_.solid(ray, mesh, triangle, time);
  }
  void solid_times(const Ray& ray, const Segment& hit, std::vector<float>& times) const override {
    alpha_.solid_times(ray, hit, times);
  }

 private:
  const Looks looks_;
  const AlphaCutOuts alpha_;
};

}  // namespace

std::shared_ptr<const CutOuts> cut_outs_of(const Shot& shot) { return std::make_shared<const ShotCutOuts>(shot); }

}  // namespace kairos
