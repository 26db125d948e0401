#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include <kairos/error.h>
#include <kairos/study.h>

#include "base/parallel.h"
#include "image/encode.h"
#include "image/read_exr.h"
#include "study/countdown.h"
#include "study/measure.h"
#include "study/page.h"
#include "study/study_folder.h"
#include "study/summary.h"

namespace kairos::study {

namespace {

constexpr int kFirstReferenceSpp = 512;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

SceneFacts facts_of(const std::string& name, const Shot& shot, size_t parts, int keys) {
  const int height = parts > 0 ? static_cast<int>(parts) : shot.projection.height;  // a row each
  SceneFacts facts{name, shot.projection.width, height, 0, 0, keys};
  for (const Mesh& mesh : shot.meshes) {
    facts.triangles += mesh.triangle_count();
    if (!mesh.is_static()) facts.moving_triangles += mesh.triangle_count();
  }
  return facts;
}

class Study {
 public:
  Study(const StudyOptions& options, const Tell& tell, const Log& log)
      : options_(options),
        tell_(tell),
        log_(log),
        folder_(options),
        names_(scene_names(options.scenes)),
        settings_(settings_of(series_of(options))),
        countdown_(total_work()) {}

  void measure_all() {
    for (size_t i = 0; i < options_.scenes.size(); ++i) measure_scene(options_.scenes[i], names_[i]);
  }

  const StudyFolder& folder() const { return folder_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  double round_work() const {
    double work = 0;
    for (const Setting& setting : settings_) work += rough_cost(setting);
    return work;
  }
  double reference_work() const { return 2.0 * options_.reference_spp / std::max(1, thread_count()); }
  double total_work() const {
    return static_cast<double>(options_.scenes.size() * options_.shadings.size()) *
           (reference_work() + options_.seeds * round_work());
  }

  bool is_complete(const Entry& entry) const {
    if (folder_.find_reference(entry) == nullptr || folder_.find_scene(entry.scene) == nullptr) return false;
    for (int seed = 1; seed <= options_.seeds; ++seed)
      for (const Setting& setting : settings_)
        if (folder_.find(entry, setting, seed) == nullptr) return false;
    return true;
  }

  /// Progress of one rendering that is `work` of the whole.
  Progress progress(const std::string& doing, double work) const {
    return [this, doing, work](double fraction) {
      return tell_({doing, countdown_.fraction(work * fraction), countdown_.seconds_left(work * fraction)});
    };
  }

  void measure_scene(const std::string& path, const std::string& name) {
    std::vector<Entry> entries;
    for (const ShadingKind shading : options_.shadings) {
      const Entry entry{name, shading};
      if (is_complete(entry))
        countdown_.skip(reference_work() + options_.seeds * round_work());
      else
        entries.push_back(entry);
    }
    if (entries.empty()) return;
    progress(name + ": loading", 0)(0);
    const auto scene = load_scene({path}, options_.load);
    const Shot shot = make_shot(*scene, options_.shot);
    for (const std::string& warning : shot.warnings) log_(fmt::format("{}: warning: {}", name, warning));
    Renderer renderer(shot);
    const auto parts = row_parts(shot.projection.width, shot.projection.height, options_.rows);
    if (folder_.find_scene(name) == nullptr)
      folder_.add(facts_of(name, shot, parts.size(), best_keys(renderer, shot, parts, name)));
    for (const Entry& entry : entries) measure_entry(renderer, entry, parts);
  }

  int best_keys(Renderer& renderer, const Shot& shot, const std::vector<kairos::Crop>& parts, const std::string& name) {
    const bool moves =
        std::any_of(shot.meshes.begin(), shot.meshes.end(), [](const Mesh& m) { return !m.is_static(); });
    if (!moves || options_.keys.size() == 1) return options_.keys.front();
    const std::vector<KeysTime> times =
        time_keys(renderer, {ShadingKind::normal, 0, options_.threads, options_.clock, parts}, options_.keys,
                  progress(name + ": choosing keys", 0));
    std::string list;
    for (const KeysTime& one : times)
      list += fmt::format("{}{} keys {:.3g} s", list.empty() ? "" : ", ", one.keys, one.seconds);
    log_(fmt::format("{}: discrete rays with at least {}; the first is taken", name, list));
    return times.front().keys;
  }

  void measure_entry(Renderer& renderer, const Entry& entry, const std::vector<kairos::Crop>& parts) {
    const Conditions conditions{entry.shading, folder_.find_scene(entry.scene)->keys, options_.threads, options_.clock,
                                parts};
    const Image reference = reference_of(renderer, entry, conditions);
    for (int seed = 1; seed <= options_.seeds; ++seed) {
      // A B, then B A: whatever drifts hits all alike.
      std::vector<Setting> order = settings_;
      if (seed % 2 == 0) std::reverse(order.begin(), order.end());
      for (const Setting& setting : order) {
        const double work = rough_cost(setting);
        if (folder_.find(entry, setting, seed) != nullptr) {
          countdown_.skip(work);
          continue;
        }
        const auto start = std::chrono::steady_clock::now();
        measure_one(renderer, entry, conditions, reference, setting, seed,
                    progress(fmt::format("{}: {}, seed {}", name_of(entry), name_of(setting), seed), work));
        countdown_.finish(work, seconds_since(start));
      }
      log_(fmt::format("{}: seed {} of {} done", name_of(entry), seed, options_.seeds));
    }
  }

  void measure_one(Renderer& renderer, const Entry& entry, const Conditions& conditions, const Image& reference,
                   const Setting& setting, int seed, const Progress& told) {
    const Measured measured = measure(renderer, setting, conditions, static_cast<uint64_t>(seed), told);
    const RenderStats& stats = measured.stats;
    Run run{entry,
            setting,
            seed,
            measured.seconds,
            stats.render_seconds,
            stats.render_cpu_seconds,
            stats.build_seconds,
            error_of(reference, measured.image, name_of(setting)),
            stats.rays,
            stats.segments,
            stats.shading_samples,
            stats.counters.nodes,
            stats.counters.triangles,
            stats.counters.root_solves};
    if (seed == 1) {
      write_image(measured.image, folder_.picture(entry, name_of(setting), ".png"));
      const std::string path = folder_.picture(entry, name_of(setting) + "-error", ".png");
      write_file(path, encode_png(error_codes(reference, measured.image), reference.width, reference.height, 1, path));
    }
    folder_.add(run);
  }

  /// The best of each method, which also warms everything up.
  double best_psnr(Renderer& renderer, const Conditions& conditions, const Image& reference, const Progress& told) {
    double best = 0;
    for (const Method method : options_.methods) {
      const auto dearest = std::find_if(settings_.rbegin(), settings_.rend(),
                                        [&](const Setting& setting) { return setting.method == method; });
      if (dearest == settings_.rend()) continue;
      const Measured measured = measure(renderer, *dearest, conditions, 1, told);
      best = std::max(best, error_of(reference, measured.image, name_of(*dearest)).psnr);
    }
    return best;
  }

  Image reference_of(Renderer& renderer, const Entry& entry, const Conditions& conditions) {
    const std::string path = folder_.picture(entry, "reference", ".exr");
    if (folder_.find_reference(entry) != nullptr) {
      countdown_.skip(reference_work());
      warm_up(renderer, entry, conditions);
      return read_exr(path);
    }
    const auto start = std::chrono::steady_clock::now();
    const auto told = progress(name_of(entry) + ": reference", reference_work());
    int spp = std::min(kFirstReferenceSpp, options_.reference_spp);
    Reference reference = render_reference(renderer, conditions, spp, told);
    const auto check = progress(name_of(entry) + ": is the reference good enough?", reference_work());
    while (spp < options_.reference_spp &&
           reference.error.psnr < best_psnr(renderer, conditions, reference.image, check) + kReferenceMargin) {
      spp = static_cast<int>(std::min<int64_t>(int64_t{4} * spp, options_.reference_spp));
      reference = render_reference(renderer, conditions, spp, told);
    }
    write_image(reference.image, path);
    write_image(reference.image, folder_.picture(entry, "reference", ".png"));
    folder_.add(ReferenceRun{entry, spp, reference.error, reference.seconds});
    log_(fmt::format("{}: reference of 2 x {} samples, {:.1f} dB by its halves", name_of(entry), spp,
                     reference.error.psnr));
    countdown_.finish(reference_work(), seconds_since(start));
    warm_up(renderer, entry, conditions);
    return reference.image;
  }

  /// Everything is built, and every kind of code and data touched, before the first measurement.
  void warm_up(Renderer& renderer, const Entry& entry, const Conditions& conditions) {
    for (const Method method : options_.methods) {
      const auto cheapest = std::find_if(settings_.begin(), settings_.end(),
                                         [&](const Setting& setting) { return setting.method == method; });
      if (cheapest != settings_.end())
        measure(renderer, *cheapest, conditions, 0, progress(name_of(entry) + ": warming up", 0));
    }
  }

  const StudyOptions& options_;
  const Tell& tell_;
  const Log& log_;
  StudyFolder folder_;
  std::vector<std::string> names_;
  std::vector<Setting> settings_;
  Countdown countdown_;
};

}  // namespace

void run_study(const StudyOptions& options, const std::string& command_line, const Tell& tell, const Log& log) {
  Study study(options, tell, log);
  study.measure_all();
  tell({"writing the page", 1, 0});
  write_results(options, study.folder(), command_line);
}

}  // namespace kairos::study
