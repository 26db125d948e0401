// An eye that lies in a surface: rays begin beyond it, whatever their kind.
#include <gtest/gtest.h>

#include <kairos/render.h>
#include <kairos/scene.h>

namespace kairos {
namespace {

TEST(EyeInASurface, NoIntegratorSeesIt) {
  Shot shot;
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.positions = {{{-1, -1, 0}, {2, -1, 0}, {0, 2, 0}}, {{-1, -1, 0}, {2, -1, 0}, {0, 2, 0}}};
  mesh.key_times = {0, 1};
  shot.meshes = {mesh};
  mesh.positions.resize(1);
  mesh.key_times.clear();
  shot.meshes.push_back(mesh);
  shot.materials.resize(1);
  shot.projection.width = shot.projection.height = 8;
  shot.world_from_camera = [](double) { return std::array<Vec3d, 3>{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}; };
  shot.camera_position = [](double) { return Vec3d{}; };
  for (const IntegratorKind integrator :
       {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed, IntegratorKind::automatic}) {
    RenderParams params;
    params.integrator = integrator;
    params.spp = 4;
    params.tc_rays = 4;
    params.aovs = {Aov::coverage};
    const Image image = render(shot, params);
    for (const float coverage : image.find("coverage.A")->values)
      EXPECT_EQ(coverage, 0) << static_cast<int>(integrator);
  }
}

}  // namespace
}  // namespace kairos
