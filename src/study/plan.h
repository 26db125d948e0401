// What a study measures: which methods, with which parameters, in which order.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <kairos/render.h>
#include <kairos/scene.h>

namespace kairos::study {

/// Each is a way to spend time; parameters say how much.
enum class Method { random, multi_jitter, owen_sobol, tc, mixed, automatic };

inline constexpr std::pair<std::string_view, Method> kMethodNames[] = {
    {"random", Method::random},         {"multi-jitter", Method::multi_jitter},
    {"owen-sobol", Method::owen_sobol}, {"tc", Method::tc},
    {"mixed", Method::mixed},           {"auto", Method::automatic}};

enum class Clock {
  cpu,   ///< processor time of the whole process, divided by its threads: other programs on the machine cost none
  wall,  ///< time that passes
};
inline constexpr std::pair<std::string_view, Clock> kClockNames[] = {{"cpu", Clock::cpu}, {"wall", Clock::wall}};

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

/// One setting of one method.
struct Setting {
  Method method = Method::owen_sobol;
  int spp = 0, tc_rays = 0, shading_samples = 0;  ///< 0: the method has none

  bool operator==(const Setting&) const = default;
};

/// Names a setting in tables and files: "owen-sobol-64", "tc-4-8" (rays, shading samples), "mixed-4-16", "auto-64".
std::string name_of(const Setting& setting);
/// The same to read: "64 spp", "4 rays, N = 8".
std::string label_of(const Setting& setting);
/// With box filter and nothing but colour; seed, shading, keys and threads remain to be filled in.
RenderParams params_of(const Setting& setting);

/// Settings of one method that make a curve, from cheap to dear.
struct Series {
  std::string name, label;
  std::vector<Setting> settings;
};

/// For tc: one series over growing rays, with kLadderSamples shading samples each (or what comes closest in the list);
/// and for each number of rays up to kMostDetailRays one over growing shading samples.
std::vector<Series> series_of(const StudyOptions& options);
inline constexpr int kLadderSamples = 8, kMostDetailRays = 4;
inline constexpr std::string_view kTcLadder = "tc";  ///< name of the former

/// Every setting of these series once, those of about the same cost next to each other, so that no method has a part of
/// the study to itself.
std::vector<Setting> settings_of(const std::vector<Series>& all);

/// Roughly how long a setting takes, in units of one discrete sample per pixel: to say how much time is left.
double rough_cost(const Setting& setting);

}  // namespace kairos::study
