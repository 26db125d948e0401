// A comparison of methods of rendering, from scenes to a page. docs/study.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <kairos/export.h>
#include <kairos/names.h>
#include <kairos/render.h>
#include <kairos/scene.h>

namespace kairos::study {

/// Each is a way to spend time; parameters say how much.
enum class Method { random, multi_jitter, owen_sobol, tc, mixed, automatic };

enum class Clock {
  cpu,   ///< processor time of the whole process, divided by its threads: other programs on the machine cost none
  wall,  ///< time that passes
};

struct StudyOptions {
  std::vector<std::string> scenes;  ///< files; each is an entry of its own
  LoadOptions load;
  ShotOptions shot;
  int rows = 0;        ///< of each frame, spread evenly over it, that are rendered; 0 (or more than there are): all
  std::string folder;  ///< where everything is written
  std::vector<ShadingKind> shadings{ShadingKind::normal};
  std::vector<Method> methods{Method::random, Method::multi_jitter, Method::owen_sobol,
                              Method::tc,     Method::mixed,        Method::automatic};
  std::vector<int> budgets{4, 8, 16, 32, 64, 128, 256};  ///< samples per pixel of qmc and auto
  std::vector<int> tc_rays{1, 2, 4, 8, 16, 32};          ///< per pixel, of tc and mixed
  std::vector<int> shading_samples{2, 8, 32, 128};       ///< per ray of tc
  std::vector<int> keys{0, 3, 5, 9};                     ///< RenderParams::discrete_keys to choose from
  int seeds = 5;
  int threads = 1;           ///< of what is measured; the reference takes all
  int reference_spp = 8192;  ///< at most, of each half of the reference
  Clock clock = Clock::cpu;
  bool force = false;  ///< a folder that holds another study is emptied of it
};

/// Where a study is.
struct Status {
  std::string doing;                   ///< "demo-normal: tc-4-8, seed 2"
  double fraction = 0;                 ///< of the whole study, as far as is known, 0 to 1
  std::optional<double> seconds_left;  ///< unset while nothing has been measured
};
/// Told often. Returning false stops the study.
using Tell = std::function<bool(const Status&)>;
/// Takes a line for the log.
using Log = std::function<void(const std::string&)>;

/// Measures what the folder does not hold yet, then writes the summary and the page. command_line: for the page.
/// Throws Error(cancelled) when `tell` says so: the same call goes on from there. Other errors as load_scene,
/// make_shot and Renderer, and Error(io) or Error(bad_input) for a folder that holds something else.
KAIROS_API void run_study(const StudyOptions& options, const std::string& command_line, const Tell& tell,
                          const Log& log);

}  // namespace kairos::study

namespace kairos {

template <>
inline constexpr auto kNames<study::Method> =
    std::to_array<Named<study::Method>>({{"random", study::Method::random},
                                         {"multi-jitter", study::Method::multi_jitter},
                                         {"owen-sobol", study::Method::owen_sobol},
                                         {"tc", study::Method::tc},
                                         {"mixed", study::Method::mixed},
                                         {"auto", study::Method::automatic}});
template <>
inline constexpr auto kNames<study::Clock> = std::to_array<Named<study::Clock>>({{"cpu", study::Clock::cpu},
                                                                                 {"wall", study::Clock::wall}});

}  // namespace kairos
