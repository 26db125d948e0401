// Shots that break what everything relies on: refused at the door, with one line, whatever renders them.
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/render.h>
#include <kairos/tracer.h>

namespace kairos {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Shot valid_shot() {
  Shot shot;
  Mesh& mesh = shot.meshes.emplace_back();
  mesh.name = "plate";
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = {0, 0.5f, 1};
  for (const float shift : {0.0f, 0.5f, 0.7f})
    mesh.positions.push_back({{shift - 1, -1, -3}, {shift + 1, -1, -3}, {shift, 1, -3}});
  mesh.normals = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  shot.materials.resize(1);
  shot.materials[0].name = "paint";
  shot.lights = {PointLight{{0, 0, 0}, {1, 1, 1}}, SpotLight{{0, 0, 0}, {0, 0, -1}, {1, 1, 1}},
                 DirectionalLight{{0, 0, -1}, {1, 1, 1}}, ConstantLight{{1, 1, 1}}, EnvironmentLight{}};
  shot.projection.width = 8;
  shot.projection.height = 6;
  return shot;
}

struct Flaw {
  const char* line;  ///< part of what the error says
  std::function<void(Shot&)> make;
};

const std::vector<Flaw>& flaws() {
  static const std::vector<Flaw> all{
      {"index 4000000000",
       [](Shot& s) {
         s.meshes[0].triangles.push_back({0, 1, 4000000000u});
       }},
      {"no positions", [](Shot& s) { s.meshes[0].positions.clear(); }},
      {"key times", [](Shot& s) { s.meshes[0].key_times.pop_back(); }},
      {"from 0 to 1",
       [](Shot& s) {
         s.meshes[0].key_times = {0, 0.5f, 0.9f};
       }},
      {"ascend",
       [](Shot& s) {
         s.meshes[0].key_times = {0, kNan, 1};
       }},
      {"number of vertices", [](Shot& s) { s.meshes[0].positions[1].pop_back(); }},
      {"position is not finite", [](Shot& s) { s.meshes[0].positions[2][0].y = kNan; }},
      {"one normal per vertex", [](Shot& s) { s.meshes[0].normals[0].pop_back(); }},
      {"normals need one key", [](Shot& s) { s.meshes[0].normals.resize(2, s.meshes[0].normals[0]); }},
      {"texture coordinate", [](Shot& s) { s.meshes[0].uvs.pop_back(); }},
      {"texture coordinate",
       [](Shot& s) {
         s.meshes[0].more_uvs = {{}, {{0, 0}}};
       }},
      {"one tangent per vertex",
       [](Shot& s) {
         s.meshes[0].tangents = {{{1, 0, 0, 1}}};
       }},
      {"tangents need one key",
       [](Shot& s) {
         s.meshes[0].tangents = {{}, {}};
       }},
      {"one colour per vertex", [](Shot& s) { s.meshes[0].colors.resize(2); }},
      {"colour is not finite",
       [](Shot& s) {
         s.meshes[0].colors = {{}, {0, 0, 0, kNan}, {}};
       }},
      {"material 'paint'", [](Shot& s) { s.materials[0].normal_texture.placement[1].z = kNan; }},
      {"material 'paint'", [](Shot& s) { s.materials[0].normal_scale = kInfinity; }},
      {"one number per triangle",
       [](Shot& s) {
         s.meshes[0].prim_ids = {1, 2};
       }},
      {"material 7", [](Shot& s) { s.meshes[0].material = 7; }},
      {"material 'paint'", [](Shot& s) { s.materials[0].emission.y = kInfinity; }},
      {"material 'paint'", [](Shot& s) { s.materials[0].ior = kNan; }},
      {"textures", [](Shot& s) { s.textures.resize(3); }},
      {"light textures", [](Shot& s) { s.light_textures.resize(1); }},
      {"light 0", [](Shot& s) { std::get<PointLight>(s.lights[0]).position.x = kNan; }},
      {"light 1", [](Shot& s) { std::get<SpotLight>(s.lights[1]).cos_outer = kNan; }},
      {"light 2", [](Shot& s) { std::get<DirectionalLight>(s.lights[2]).irradiance.z = kInfinity; }},
      {"light 3", [](Shot& s) { std::get<ConstantLight>(s.lights[3]).radiance.x = kNan; }},
      {"light 4", [](Shot& s) { std::get<EnvironmentLight>(s.lights[4]).axes[1].y = std::nan(""); }},
      {"background", [](Shot& s) { s.background.x = kNan; }},
      {"backdrop",
       [](Shot& s) {
         s.backdrop = Vec3f{0, kNan, 0};
       }},
      {"moving lights", [](Shot& s) { s.moving_lights.resize(s.lights.size() + 1); }},
      {"projection", [](Shot& s) { s.projection.vfov = 0; }},
      {"projection", [](Shot& s) { s.projection.vfov = std::nan(""); }},
      {"projection", [](Shot& s) { s.projection.width = 0; }},
      {"projection",
       [](Shot& s) {
         s.projection.orthographic = true;
         s.projection.view_height = -1;
       }},
  };
  return all;
}

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    return error.what();
  }
  return "no error";
}

TEST(InvalidShots, AreRefusedAtTheDoor) {
  EXPECT_NO_THROW(validate_shot(valid_shot()));
  EXPECT_NO_THROW(validate_shot(Shot{}));
  for (const Flaw& flaw : flaws()) {
    Shot shot = valid_shot();
    flaw.make(shot);
    const auto says_so = AllOf(HasSubstr(flaw.line), Not(HasSubstr("\n")));
    EXPECT_THAT(message_of([&] { const Renderer renderer(shot); }), says_so);
    EXPECT_THAT(message_of([&] { render(shot); }), says_so);
  }
}

TEST(InvalidShots, ValidOnesRenderWithEverything) {
  const Shot shot = valid_shot();
  Renderer renderer(shot);
  for (const auto integrator :
       {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed, IntegratorKind::automatic})
    for (const auto shading : {ShadingKind::normal, ShadingKind::flat, ShadingKind::whitted, ShadingKind::bounds}) {
      RenderParams params;
      params.integrator = integrator;
      params.shading = shading;
      params.tc_rays = params.spp = 2;
      EXPECT_NO_THROW(renderer.render(params));
    }
}

TEST(InvalidShots, ATracerRefusesBadMeshesItself) {
  for (size_t i = 0; i < 11; ++i) {  // flaws of meshes alone
    Shot shot = valid_shot();
    flaws()[i].make(shot);
    EXPECT_THAT(message_of([&] { const Tracer tracer(shot.meshes); }), HasSubstr(flaws()[i].line));
  }
}

}  // namespace
}  // namespace kairos
