#include <algorithm>

#include <kairos/time_file.h>

namespace kairos {

Image TimeFile::flow(double from, double to, FlowOptions options) const {
  const TimeFrame& frame = picture_.frame();
  const auto recorded = [&](double seconds) {
    constexpr double kRounding = 1e-9;  // parts of the recorded time that sums of times may be off by
    const double time = frame.frame_time + seconds, slack = kRounding * (frame.close - frame.open);
    return time < frame.open && time >= frame.open - slack     ? frame.open
           : time > frame.close && time <= frame.close + slack ? frame.close
                                                               : time;
  };
  if (to < from) {
    options.backward = !options.backward;
    std::swap(from, to);
  }
  return kairos::flow(shot(recorded(from), recorded(to)), options);
}

}  // namespace kairos
