// How the benchmark programs measure: what they compare is interleaved, and every single measurement is written down.
#pragma once

#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <kairos/error.h>

namespace kairos::bench {

/// The processor's, of the whole process: other programs on the machine cost none. For work of one thread.
inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// Time that passes: for work of several threads.
inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

using Clock = double (*)();
/// Does something and returns how many seconds it took.
using Measurement = std::function<double()>;

template <class Work>
double seconds_of(Clock clock, const Work& work) {
  const double start = clock();
  work();
  return clock() - start;
}

/// [measurement][round] Seconds. A round runs A B ... B A, so that whatever drifts hits all alike, and takes the means.
inline std::vector<std::vector<double>> interleave(int rounds, const std::vector<Measurement>& measurements) {
  std::vector<std::vector<double>> times(measurements.size());
  for (int round = 0; round < rounds; ++round) {
    for (size_t i = 0; i < measurements.size(); ++i) times[i].push_back(measurements[i]() / 2);
    for (size_t i = measurements.size(); i-- > 0;) times[i].back() += measurements[i]() / 2;
  }
  return times;
}

/// Numbers as lines of CSV, "measure,rays,round,value", on standard output or in a file.
class Rows {
 public:
  /// path: empty for standard output. Throws Error(io).
  explicit Rows(const std::string& path) : path_(path) {
    if (!path.empty()) owned_.reset(std::fopen(path.c_str(), "w"));
    file_ = path.empty() ? stdout : owned_.get();
    if (file_ == nullptr) throw Error(ErrorCode::io, path, "cannot be written");
    fmt::print(file_, "measure,rays,round,value\n");
  }

  /// rays: per pixel; 0 where that means nothing.
  void add(const std::string& measure, int rays, int round, double value) {
    fmt::print(file_, "{},{},{},{:.6g}\n", measure, rays, round, value);
    if (std::fflush(file_) != 0) throw Error(ErrorCode::io, path_, "cannot be written");
  }
  void add(const std::string& measure, double value) { add(measure, 0, 0, value); }
  /// One line per round, each value times `scale`.
  void add(const std::string& measure, int rays, const std::vector<double>& values, double scale = 1) {
    for (size_t i = 0; i < values.size(); ++i) add(measure, rays, static_cast<int>(i), values[i] * scale);
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> owned_;
  std::FILE* file_ = nullptr;
};

}  // namespace kairos::bench
