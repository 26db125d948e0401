// The sum of colours that each last for a stretch of time.
#pragma once

#include <algorithm>
#include <vector>

#include <kairos/vec.h>

namespace kairos {

/// One thread's memory.
class StepSum {
 public:
  void clear() { steps_.clear(); }
  /// An empty stretch adds nothing.
  void add(float begin, float end, Vec3f colour) {
    if (begin < end) steps_.push_back({begin, end, colour});
  }

  /// Calls use(begin, end, sum) for the stretches of [begin, end) between which the sum changes, in order of time; they
  /// cover it.
  template <class Use>
  void visit(float begin, float end, const Use& use) {
    std::stable_sort(steps_.begin(), steps_.end(), [](const Step& a, const Step& b) { return a.begin < b.begin; });
    active_.clear();
    size_t next = 0;
    for (float time = begin; time < end;) {
      for (; next < steps_.size() && steps_[next].begin <= time; ++next) active_.push_back(steps_[next]);
      std::erase_if(active_, [&](const Step& step) { return !(step.end > time); });
      float until = next < steps_.size() ? std::min(end, steps_[next].begin) : end;
      Vec3f sum{};
      for (const Step& step : active_) {
        sum += step.colour;
        until = std::min(until, step.end);
      }
      use(time, until, sum);
      time = until;
    }
  }

 private:
  struct Step {
    float begin, end;
    Vec3f colour;
  };
  std::vector<Step> steps_, active_;
};

}  // namespace kairos
