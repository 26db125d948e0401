// Time-continuous rays: exact visibility over the shutter, sampled over the pixel, shaded at instants.
#include "integrators/integrator.h"
#include "integrators/segment_shading.h"

namespace kairos {

namespace {

class TcIntegrator : public Integrator {
 public:
  TcIntegrator(const Tracer& tracer, int shading_samples, const PixelContext& context)
      : context_(context), shading_samples_(shading_samples), tracer_(tracer) {}

  std::unique_ptr<Worker> make_worker() const override { return std::make_unique<TcWorker>(*this); }

 private:
  class TcWorker : public Worker {
   public:
    explicit TcWorker(const TcIntegrator& integrator)
        : integrator_(integrator),
          context_(integrator.context_),
          shading_(integrator.context_, integrator.shading_samples_) {}

    void render_pixel(int x, int y, RaySink& sink, Monitor& monitor) override {
      const Sampler::Pixel pixel = context_.sampler.pixel(x, y);
      for (uint32_t i = 0; i < context_.sampler.count(); ++i) {
        if (i % kRaysPerPoll == 0) monitor.poll();
        const SamplePoint point = context_.sampler.point(pixel, i);
        const Ray ray = context_.ray(x, y, point);
        const auto segments = integrator_.tracer_.trace(ray, Visibility::visible, workspace_);
        shaded_.clear();
        shading_.shade(ray, segments, workspace_.veils(), pixel.seed, i, point.time, shaded_);
        sink.add({ShadedRay::Kind::tc, shaded_, static_cast<uint32_t>(segments.size() + workspace_.veils().size())});
      }
    }

    void add_counts(RenderStats& stats) const override {
      stats.counters += workspace_.counters();
      stats.rays += workspace_.counters().rays;
      stats.segments += workspace_.counters().segments;
      stats.shading_samples += shading_.evaluations();
    }

   private:
    const TcIntegrator& integrator_;
    const PixelContext& context_;
    Tracer::Workspace workspace_;
    SegmentShading shading_;
    std::vector<ShadedSegment> shaded_;
  };

  const PixelContext& context_;
  int shading_samples_;
  const Tracer& tracer_;
};

}  // namespace

std::unique_ptr<Integrator> make_tc_integrator(ShotParts& parts, const RenderParams& params,
                                               const PixelContext& context, RenderStats& stats) {
  const Tracer& tracer = parts.tracer(params.instruction_set);
  stats.instruction_set = tracer.instruction_set();
  stats.accel_memory_bytes = tracer.memory_bytes();
  return std::make_unique<TcIntegrator>(tracer, params.shading_samples, context);
}

}  // namespace kairos
