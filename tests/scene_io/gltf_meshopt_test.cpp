// Buffer views compressed by meshoptimizer: what its own encoder writes comes out as it went in.
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <kairos/error.h>

#include "gltf_builder.h"
#include "seed.h"

namespace kairos {
namespace {

using testing::HasSubstr;

constexpr const char* kExtension = "EXT_meshopt_compression";

/// Index of a view of `count` elements of `stride` bytes, packed as `packed`; its plain place is a buffer that is not
/// there.
int packed_view(GltfBuilder& gltf, const std::vector<uint8_t>& packed, size_t count, size_t stride,
                const std::string& mode, const std::string& filter = "NONE") {
  const int inner = gltf.view(packed);
  const nlohmann::json bytes = gltf.root["bufferViews"][static_cast<size_t>(inner)];
  gltf.root["bufferViews"][static_cast<size_t>(inner)] = {{"buffer", 1},
                                                          {"byteLength", count * stride},
                                                          {"extensions",
                                                           {{kExtension,
                                                             {{"buffer", 0},
                                                              {"byteOffset", bytes["byteOffset"]},
                                                              {"byteLength", bytes["byteLength"]},
                                                              {"byteStride", stride},
                                                              {"count", count},
                                                              {"mode", mode},
                                                              {"filter", filter}}}}}};
  return inner;
}

std::vector<uint8_t> packed_vertices(const void* data, size_t count, size_t stride) {
  std::vector<uint8_t> packed(meshopt_encodeVertexBufferBound(count, stride));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), data, count, stride));
  return packed;
}

std::string text_of(GltfBuilder& gltf) {
  nlohmann::json full = nlohmann::json::parse(gltf.text());
  full["buffers"].push_back({{"byteLength", 1 << 20}, {"extensions", {{kExtension, {{"fallback", true}}}}}});
  full["extensionsRequired"] = {kExtension};
  return full.dump();
}

int accessor(GltfBuilder& gltf, int view, int type, size_t count, const char* kind, bool normalized = false) {
  return gltf.push(
      "accessors",
      {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", kind}, {"normalized", normalized}});
}

TEST(GltfMeshopt, VerticesAndTrianglesComeOutAsTheyWentIn) {
  std::mt19937 random(test::seed());
  std::uniform_real_distribution<float> anywhere(-10, 10);
  const size_t vertices = 3 + random() % 500, triangles = 1 + random() % 1000;
  std::vector<float> positions(3 * vertices);
  for (float& p : positions) p = anywhere(random);
  std::vector<uint32_t> corners(3 * triangles);
  for (uint32_t& c : corners) c = static_cast<uint32_t>(random() % vertices);
  std::vector<uint8_t> list(meshopt_encodeIndexBufferBound(corners.size(), vertices));
  list.resize(meshopt_encodeIndexBuffer(list.data(), list.size(), corners.data(), corners.size()));
  std::vector<uint8_t> sequence(meshopt_encodeIndexSequenceBound(corners.size(), vertices));
  sequence.resize(meshopt_encodeIndexSequence(sequence.data(), sequence.size(), corners.data(), corners.size()));

  GltfBuilder gltf;
  const int position =
      accessor(gltf, packed_view(gltf, packed_vertices(positions.data(), vertices, 12), vertices, 12, "ATTRIBUTES"),
               5126, vertices, "VEC3");
  const int as_list =
      accessor(gltf, packed_view(gltf, list, corners.size(), 4, "TRIANGLES"), 5125, corners.size(), "SCALAR");
  const int as_sequence =
      accessor(gltf, packed_view(gltf, sequence, corners.size(), 4, "INDICES"), 5125, corners.size(), "SCALAR");
  gltf.mesh_node({{"attributes", {{"POSITION", position}}}, {"indices", as_list}});
  gltf.mesh_node({{"attributes", {{"POSITION", position}}}, {"indices", as_sequence}});
  const Scene scene = GltfBuilder::parse_text(text_of(gltf));
  EXPECT_TRUE(scene.warnings.empty());
  const std::vector<Vec3d> read = positions_at(scene, 0);
  ASSERT_EQ(read.size(), vertices);
  for (size_t v = 0; v < vertices; ++v)
    EXPECT_EQ(to_float(read[v]), (Vec3f{positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]}));
  ASSERT_EQ(scene.meshes[0].triangles.size(), triangles);
  for (size_t t = 0; t < triangles; ++t) {
    EXPECT_EQ(scene.meshes[1].triangles[t], (Triangle{corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]}));
    // A list may begin each triangle at another of its corners.
    Triangle turned = scene.meshes[0].triangles[t];
    for (int i = 0; i < 3 && turned != scene.meshes[1].triangles[t]; ++i)
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
    EXPECT_EQ(turned, scene.meshes[1].triangles[t]);
  }
}

TEST(GltfMeshopt, FiltersAreUndone) {
  const std::vector<float> normals{0, 0, 1, 0, 0.6f, 0, 0.8f, 0, 0, -1, 0, 0};  // of 4 numbers each
  const std::vector<float> shifts{0.5f, -3, 100, 0.125f, 2, 7, 0, 0, 0};
  std::vector<uint8_t> octahedral(3 * 4), exponential(3 * 12);
  meshopt_encodeFilterOct(octahedral.data(), 3, 4, 8, normals.data());
  meshopt_encodeFilterExp(exponential.data(), 3, 12, 20, shifts.data());
  GltfBuilder gltf;
  const int normal =
      accessor(gltf, packed_view(gltf, packed_vertices(octahedral.data(), 3, 4), 3, 4, "ATTRIBUTES", "OCTAHEDRAL"),
               5120, 3, "VEC3", true);
  const int position =
      accessor(gltf, packed_view(gltf, packed_vertices(exponential.data(), 3, 12), 3, 12, "ATTRIBUTES", "EXPONENTIAL"),
               5126, 3, "VEC3");
  gltf.root["bufferViews"][static_cast<size_t>(gltf.root["accessors"][static_cast<size_t>(normal)]["bufferView"])]
           ["byteStride"] = 4;
  gltf.mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}});
  const Scene scene = GltfBuilder::parse_text(text_of(gltf));
  const std::vector<Vec3d> read = positions_at(scene, 0);
  const std::vector<Vec3f> seen = normals_at(scene, 0);
  for (size_t v = 0; v < 3; ++v)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(read[v][c], shifts[3 * v + static_cast<size_t>(c)], 1e-3);
      EXPECT_NEAR(seen[v][c], normals[4 * v + static_cast<size_t>(c)], 0.03);
    }
}

TEST(GltfMeshopt, WhatIsNoStreamIsRefusedInOneLine) {
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
  const auto refusal = [&](const char* key, const nlohmann::json& value, bool spoil = false) -> std::string {
    GltfBuilder gltf;
    const int view = packed_view(gltf, packed_vertices(positions.data(), 3, 12), 3, 12, "ATTRIBUTES");
    gltf.mesh_node({{"attributes", {{"POSITION", accessor(gltf, view, 5126, 3, "VEC3")}}}});
    auto& said = gltf.root["bufferViews"][0]["extensions"][kExtension];
    if (value.is_discarded())
      said.erase(key);
    else
      said[key] = value;
    if (spoil) gltf.bytes[0] ^= 0xff;
    try {
      GltfBuilder::parse_text(text_of(gltf));
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal("filter", "NONE"), "");
  EXPECT_THAT(refusal("filter", "NONE", true), HasSubstr("bufferViews[0]: its compressed data is broken"));
  EXPECT_THAT(refusal("byteLength", 5), HasSubstr("broken"));
  EXPECT_THAT(refusal("byteLength", 5000), HasSubstr("reaches beyond"));
  EXPECT_THAT(refusal("byteStride", 10), HasSubstr("byteStride of 10"));
  EXPECT_THAT(refusal("byteStride", 260), HasSubstr("byteStride of 260"));
  EXPECT_THAT(refusal("byteStride", 0), HasSubstr("byteStride of 0"));
  EXPECT_THAT(refusal("mode", "POINTS"), HasSubstr("unknown mode 'POINTS'"));
  EXPECT_THAT(refusal("mode", "TRIANGLES"), HasSubstr("indices of 12 bytes"));
  EXPECT_THAT(refusal("filter", "OCTAHEDRAL"), HasSubstr("OCTAHEDRAL"));
  EXPECT_THAT(refusal("filter", "COLOR"), HasSubstr("'COLOR'"));
  EXPECT_THAT(refusal("count", 4'000'000'000u), HasSubstr("memory"));
  EXPECT_THAT(refusal("buffer", 7), HasSubstr("names buffer 7"));
  EXPECT_THAT(refusal("mode", nlohmann::json(nlohmann::json::value_t::discarded)), HasSubstr("mode is missing"));
}

}  // namespace
}  // namespace kairos
