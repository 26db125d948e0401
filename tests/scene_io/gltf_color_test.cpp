// Colours of vertices in glTF files: every kind that the format has.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class T>
Scene colored(const std::vector<T>& values, const std::string& type, bool normalized) {
  GltfBuilder gltf;
  gltf.triangle_node();
  gltf.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = gltf.accessor(values, type, normalized);
  return gltf.parse();
}

TEST(GltfColor, AllKindsOfNumbersSayTheSame) {
  const std::vector<float> floats{0, 0.2f, 1, 1, 1, 0, 0.4f, 0.6f, 0.8f};
  const auto expect = [&](const Scene& scene, float last_alpha) {
    EXPECT_THAT(scene.warnings, IsEmpty());
    const std::vector<Vec4f>& colors = scene.meshes.at(0).colors;
    ASSERT_EQ(colors.size(), 3u);
    for (size_t v = 0; v < 3; ++v) {
      EXPECT_FLOAT_EQ(colors[v].x, floats[3 * v]);
      EXPECT_FLOAT_EQ(colors[v].y, floats[3 * v + 1]);
      EXPECT_FLOAT_EQ(colors[v].z, floats[3 * v + 2]);
    }
    EXPECT_EQ(colors[0].w, 1);
    EXPECT_FLOAT_EQ(colors[2].w, last_alpha);
  };
  const auto as = [&](auto largest, bool alpha) {
    std::vector<decltype(largest)> values;
    for (size_t i = 0; i < floats.size(); ++i) {
      values.push_back(static_cast<decltype(largest)>(floats[i] * static_cast<float>(largest) + 0.01f));
      if (alpha && i % 3 == 2) values.push_back(i == 8 ? static_cast<decltype(largest)>(largest / 5) : largest);
    }
    return values;
  };
  expect(colored(floats, "VEC3", false), 1);
  expect(colored(as(uint8_t{255}, false), "VEC3", true), 1);
  expect(colored(as(uint8_t{255}, true), "VEC4", true), 0.2f);
  expect(colored(as(uint16_t{65535}, false), "VEC3", true), 1);
  expect(colored(as(uint16_t{65535}, true), "VEC4", true), 0.2f);
  expect(colored<float>({0, 0.2f, 1, 1, 1, 1, 0, 1, 0.4f, 0.6f, 0.8f, 0.2f}, "VEC4", false), 0.2f);
}

TEST(GltfColor, WhatIsAllWhiteIsNotKept) {
  EXPECT_THAT(colored<uint8_t>({255, 255, 255, 255, 255, 255, 255, 255, 255}, "VEC3", true).meshes[0].colors,
              IsEmpty());
  EXPECT_EQ(colored<uint8_t>({255, 255, 255, 255, 255, 255, 255, 255, 254}, "VEC3", true).meshes[0].colors.size(), 3u);
}

TEST(GltfColor, WhatIsNoColourIsNamed) {
  const Scene whole = colored<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 51}, "VEC3", false);
  EXPECT_THAT(whole.warnings, ElementsAre(HasSubstr("count as normalized")));
  EXPECT_FLOAT_EQ(whole.meshes[0].colors[2].z, 0.2f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Scene bad = colored<float>({nan, 0, 0, -1, 1, 0, 2, 0, nan}, "VEC3", false);
  EXPECT_THAT(bad.warnings, ElementsAre(HasSubstr("not finite count as 1 (2 times)")));
  EXPECT_EQ(bad.meshes[0].colors[0], (Vec4f{1, 0, 0, 1}));
  EXPECT_EQ(bad.meshes[0].colors[1], (Vec4f{0, 1, 0, 1}));
  EXPECT_EQ(bad.meshes[0].colors[2], (Vec4f{2, 0, 1, 1}));
}

}  // namespace
}  // namespace kairos
