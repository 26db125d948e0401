// KHR_draco_mesh_compression, on a mesh that libdraco itself has compressed.
#include <algorithm>
#include <set>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>

#include "gltf_builder.h"

namespace kairos {
namespace {

// A square of two triangles with normals and joints, unquantised.
struct Compressed {
  std::vector<uint8_t> bytes;
  uint32_t points = 0, position_id = 0, joints_id = 0;
};

Compressed compress() {
  const Vec3f corners[2][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int joints = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
  for (uint32_t f = 0; f < 2; ++f) {
    std::array<std::array<uint8_t, 4>, 3> bones{};
    for (size_t c = 0; c < 3; ++c) bones[c][0] = static_cast<uint8_t>(corners[f][c].x);  // the joint is x
    const draco::FaceIndex face(f);
    builder.SetAttributeValuesForFace(position, face, &corners[f][0], &corners[f][1], &corners[f][2]);
    builder.SetAttributeValuesForFace(joints, face, &bones[0], &bones[1], &bones[2]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {{buffer.data(), buffer.data() + buffer.size()},
          mesh->num_points(),
          mesh->attribute(position)->unique_id(),
          mesh->attribute(joints)->unique_id()};
}

GltfBuilder square(const Compressed& compressed) {
  GltfBuilder gltf;
  const int view = gltf.view(compressed.bytes);
  // As the extension has it: accessors that give types and counts, without buffer views.
  const int position =
      gltf.push("accessors", {{"componentType", 5126}, {"count", compressed.points}, {"type", "VEC3"}});
  const int joints = gltf.push("accessors", {{"componentType", 5121}, {"count", compressed.points}, {"type", "VEC4"}});
  const int indices = gltf.push("accessors", {{"componentType", 5121}, {"count", 6}, {"type", "SCALAR"}});
  std::vector<float> weights;
  for (uint32_t p = 0; p < compressed.points; ++p) weights.insert(weights.end(), {1, 0, 0, 0});
  gltf.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  gltf.mesh_node(
      {{"attributes", {{"POSITION", position}, {"JOINTS_0", joints}, {"WEIGHTS_0", gltf.accessor(weights, "VEC4")}}},
       {"indices", indices},
       {"extensions",
        {{"KHR_draco_mesh_compression",
          {{"bufferView", view},
           {"attributes", {{"POSITION", compressed.position_id}, {"JOINTS_0", compressed.joints_id}}}}}}}},
      {{"skin", 0}});
  gltf.push("nodes", {{"translation", {0, 0, 0}}});
  gltf.push("nodes", {{"translation", {0, 0, 5}}});  // moves what has joint 1, that is x = 1
  gltf.push("skins", {{"joints", {1, 2}}});
  return gltf;
}

TEST(GltfDraco, DecodesPositionsJointsAndTriangles) {
  const Scene scene = square(compress()).parse();
  ASSERT_EQ(scene.meshes.size(), 1u);
  const auto p = positions_at(scene, 0);
  std::set<std::array<double, 3>> found;
  double area = 0;
  for (const Triangle& t : scene.meshes[0].triangles) {
    area += cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z / 2;
    for (uint32_t v : t) found.insert({p[v].x, p[v].y, p[v].z});
  }
  EXPECT_EQ(area, 1) << "two triangles, both facing +z";
  EXPECT_EQ(found, (std::set<std::array<double, 3>>{{0, 0, 0}, {1, 0, 5}, {0, 1, 0}, {1, 1, 5}}));
}

TEST(GltfDraco, RefusesCountsThatDisagreeWithTheAccessors) {
  const Compressed compressed = compress();
  for (const size_t accessor : {0u, 2u}) {
    GltfBuilder gltf = square(compressed);
    gltf.root["accessors"][accessor]["count"] = 300;
    EXPECT_THROW(gltf.parse(), Error);
  }
  GltfBuilder absurd = square(compressed);
  absurd.root["accessors"][0]["count"] = 4'000'000'000u;
  EXPECT_THROW(absurd.parse(), Error);
}

TEST(GltfDraco, RefusesBrokenData) {
  const Compressed compressed = compress();
  for (size_t length = 0; length + 1 < compressed.bytes.size(); ++length) {
    Compressed cut = compressed;
    cut.bytes.resize(length + 1);
    std::fill(cut.bytes.begin() + static_cast<std::ptrdiff_t>(length), cut.bytes.end(), uint8_t{0});
    try {
      square(cut).parse();
      // A few of the last bytes may not matter to Draco; the first ones, its header, do.
      EXPECT_GT(length, 10u);
    } catch (const Error&) {
    }
  }
  GltfBuilder missing = square(compressed);
  missing.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 77;
  EXPECT_THROW(missing.parse(), Error);
}

}  // namespace
}  // namespace kairos
