// What tests of commands that make or read pictures over time have in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include <kairos/image.h>

#include "cli.h"

namespace kairos {

class CliTime : public CliTest {
 protected:
  void ok(const std::string& arguments) const {
    const CliResult result = run(arguments);
    ASSERT_EQ(result.status, 0) << arguments << "\n" << result.err;
  }
  std::string refusal(const std::string& arguments, int status) const {
    const CliResult result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_TRUE(result.one_line_error()) << result.err;
    return result.err;
  }
  /// Those of a .flo.
  std::vector<float> vectors_of(const std::string& name, const std::string& folder) const {
    const std::string flo = read(path(folder + name));
    std::vector<float> vectors((std::max<size_t>(12, flo.size()) - 12) / 4);
    std::memcpy(vectors.data(), flo.data() + 12, vectors.size() * 4);
    return vectors;
  }
  Image image(const std::string& name) const { return read_image(path(name)); }
  /// Largest difference of colours.
  double difference(const std::string& a, const std::string& b) const {
    const Image first = image(a), second = image(b);
    double most = 0;
    for (const char* channel : {"R", "G", "B"}) {
      const auto &x = first.find(channel)->values, &y = second.find(channel)->values;
      EXPECT_EQ(x.size(), y.size());
      for (size_t i = 0; i < x.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(x[i]) - static_cast<double>(y[i])));
    }
    return most;
  }
};

inline constexpr const char* kRenderTime = "render scene.json --quiet --shading flat --tc-rays 8 --fps 10 ";

}  // namespace kairos
