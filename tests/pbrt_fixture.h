// Scenes written in pbrt's language, for tests.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_matchers.h"
#include "scene_io/pbrt/pbrt.h"
#include "temp_folder.h"

namespace kairos {

class PbrtTest : public testing::Test {
 protected:
  Scene load(std::string_view text, bool strict = false) const {
    LoadContext context;
    context.options.strict = strict;
    return load_pbrt(folder_.write("scene.pbrt", text), context);
  }
  /// A world that is right-handed: its coordinates come out as they are written.
  Scene load_world(const std::string& text, bool strict = false) const {
    return load("Scale -1 1 1\nCamera \"perspective\"\nWorldBegin\n" + text, strict);
  }
  void refuse(const std::string& text, const std::vector<std::string>& words, bool strict = false) const {
    expect_error([&] { load(text, strict); }, words);
  }

  static std::vector<Vec3d> positions(const SceneMesh& mesh, double time = 0, Side side = Side::after) {
    std::vector<Vec3d> out(mesh.motion->vertex_count());
    mesh.motion->positions(time, side, out);
    return out;
  }
  static std::vector<Vec3f> normals(const SceneMesh& mesh, double time = 0) {
    std::vector<Vec3f> out(mesh.motion->vertex_count());
    mesh.motion->normals(time, Side::after, out);
    return out;
  }
  static Vec3d geometric_normal(const SceneMesh& mesh, size_t triangle = 0) {
    const std::vector<Vec3d> p = positions(mesh);
    const Triangle& t = mesh.triangles.at(triangle);
    return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
  }
  static double area(const SceneMesh& mesh) {
    const std::vector<Vec3d> p = positions(mesh);
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) sum += length(cross(p[b] - p[a], p[c] - p[a])) / 2;
    return sum;
  }
  static void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-12) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance) << "axis " << axis;
  }

  /// A triangle whose first vertex is (1, 2, 3).
  static constexpr const char* kTriangle =
      "Shape \"trianglemesh\" \"point P\" [1 2 3  2 2 3  1 3 3] \"integer indices\" [0 1 2]\n";

  TempFolder folder_;
};

/// Two pictures, and what surfaces are made of.
class PbrtSurface : public PbrtTest {
 protected:
  PbrtSurface() {
    folder_.write("a.png", "");
    folder_.write("leaf.png", "");
  }
  const Material& material_of(const std::string& statements) {
    scene_ = load_world(statements + "\n" + kTextured);
    return scene_.materials.at(scene_.meshes.at(0).material);
  }
  static void expect_color(Vec3f a, Vec3d b) { expect_near(to_double(a), b, 1e-6); }

  static constexpr const char* kTextured =
      "Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"float uv\" [0 0 1 0 0 1]";
  Scene scene_;
};

}  // namespace kairos
