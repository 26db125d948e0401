// Surfaces in Whitted's shading, against what light must do, computed by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "shading/floor_scene.h"
#include "shading/reflectance.h"

namespace kairos {
namespace {

using test::expect_near;
using test::floor_shot;
using test::kDown;
using test::seen;

TEST(Whitted, InAWhiteWorldWhiteThingsCannotBeSeen) {
  Material metal = mirror({1, 1, 1}), rough_metal = metal, plastic = lambert({1, 1, 1});
  rough_metal.roughness = 0.5f;
  plastic.roughness = 0.1f;
  Material pane = glass(1.5f);
  pane.thin_walled = true;
  Material lacquered = rough_metal, dull = plastic;
  lacquered.clearcoat = 0.7f;
  lacquered.clearcoat_roughness = 0.1f;
  dull.specular = 0.25f;
  for (const Material& material :
       {lambert({1, 1, 1}), metal, rough_metal, plastic, glass(1.5f), pane, lacquered, dull}) {
    Shot shot;
    shot.materials = {material};
    shot.lights = {ConstantLight{{1, 2, 4}}};
    shot.meshes = {box({-1, -1, -5}, {1, 1, -3}, 0)};
    for (const Vec3f direction : {Vec3f{0, 0, -1}, Vec3f{0.2f, -0.15f, -1}, Vec3f{0.28f, 0.29f, -1}}) {
      const Vec3f colour = seen(shot, {{0, 0, 0}, direction}, 16, 64);
      expect_near(colour, {1, 2, 4}, 0.06);  // what is left out is below half a per cent of each reflection
    }
  }
}

TEST(Whitted, WhatIsUnlitHasItsColourInAnyLightAndGivesNone) {
  Shot shot = floor_shot();
  shot.lights = {ConstantLight{{3, 3, 3}}};
  const Vec3f lit = seen(shot, kDown);
  shot.materials[0].unlit = true;
  EXPECT_EQ(seen(shot, kDown), shot.materials[0].base_color);
  EXPECT_NE(lit, shot.materials[0].base_color);
  shot.lights = {ConstantLight{{0.25f, 0.25f, 0.25f}}};
  shot.materials.push_back(lambert({1, 1, 1}));
  shot.materials[1].unlit = true;
  shot.materials[1].emission = {9, 9, 9};
  shot.materials[0].unlit = false;
  Shot with_bulb = shot;
  with_bulb.meshes.push_back(box({-1, 2, -3}, {1, 3, -1}, 1));
  shot.materials[1].unlit = false;
  const Vec3f without = seen(with_bulb, kDown);
  with_bulb.meshes.pop_back();
  EXPECT_GT(without.x, 0);
  EXPECT_LE(without.x, seen(with_bulb, kDown).x + 1e-6f) << "the bulb may shade, and does not shine";
}

TEST(Whitted, ASpecularColourTintsWhatIsReflectedStraightOn) {
  Material tinted = lambert({0, 0, 0});
  tinted.roughness = 0;
  tinted.ior = 1.5f;
  const Reflectance plain = reflectance(tinted, {{0, 0, 0}, {}, 1, 0, 0}, 1, true);
  EXPECT_NEAR(plain.mirror.x, 0.04, 1e-6);
  tinted.specular = 0.5f;
  tinted.specular_color = {1, 0.5f, 0};
  const Reflectance straight = reflectance(tinted, {{0, 0, 0}, {}, 1, 0, 0}, 1, true);
  expect_near(straight.mirror, {0.02f, 0.01f, 0}, 1e-6);
  const Reflectance along = reflectance(tinted, {{0, 0, 0}, {}, 1, 0, 0}, 0, true);
  expect_near(along.mirror, {0.5f, 0.5f, 0.5f}, 1e-6);
  tinted.specular = 0;
  tinted.clearcoat = 0.5f;
  expect_near(reflectance(tinted, {{1, 1, 1}, {}, 1, 0, 1}, 1, true).mirror, {0.02f, 0.02f, 0.02f}, 1e-6);
  expect_near(reflectance(tinted, {{1, 1, 1}, {}, 1, 0, 1}, 1, true).diffuse, {0.98f, 0.98f, 0.98f}, 1e-6);
}

TEST(Whitted, AMirrorShowsWhatIsInFrontOfIt) {
  Shot shot;
  shot.materials = {mirror({0.5f, 1, 1}), lamp({3, 0, 0}), lamp({0, 5, 0})};
  // At 45 degrees behind z = -4; it turns rays along -z to +x. The lamp's halves meet at y = 0.
  shot.meshes = {parallelogram({-1, -1, -3}, {2, 0, -2}, {0, 2, 0}, 0),
                 parallelogram({3, 0, -6}, {0, 0, 4}, {0, 2, 0}, 1),
                 parallelogram({3, -2, -6}, {0, 0, 4}, {0, 2, 0}, 2)};
  const Ray up{{0, 0.1f, 0}, {0, 0, -1}}, down{{0, -0.1f, 0}, {0, 0, -1}};
  const float grazing = 0.5f * std::pow(1 - std::sqrt(0.5f), 5.0f);  // Schlick's whitening
  expect_near(seen(shot, up), {3 * (0.5f + grazing), 0, 0}, 1e-5);
  expect_near(seen(shot, down), {0, 5, 0}, 1e-5);
  EXPECT_EQ(seen(shot, up, 1, 0), Vec3f{}) << "no reflection is allowed";
  shot.meshes.resize(1);
  shot.materials[0].base_color.x = 1;
  shot.background = {0.25f, 0.5f, 1};
  shot.lights = {PointLight{{0, 0, 0}, {1, 1, 1}}};
  expect_near(seen(shot, up), {0.25f, 0.5f, 1}, 1e-5);
}

TEST(Whitted, GlassBendsRaysAsSnellSays) {
  const float ior = 1.5f;
  Shot shot;
  shot.materials = {glass(ior), lamp({1, 0, 0}), lamp({0, 1, 0})};
  // A slab from z = -2 to z = -3; a ray at 45 degrees leaves it at x = 2 + tan(refracted), and goes on at 45 degrees.
  const double inside = std::asin(std::sin(M_PI / 4) / ior), border = 2 + std::tan(inside) + 1;
  const auto x = static_cast<float>(border);
  shot.meshes = {box({-20, -20, -3}, {20, 20, -2}, 0), parallelogram({x, -5, -4}, {5, 0, 0}, {0, 10, 0}, 1),
                 parallelogram({x - 5, -5, -4}, {5, 0, 0}, {0, 10, 0}, 2)};
  const auto at = [&](float shift) { return seen(shot, {{shift, 0, 0}, {1, 0, -1}}); };
  const double r = [&] {  // both faces, unpolarised, at 45 degrees
    const double c = std::cos(M_PI / 4), i = std::cos(inside);
    return (std::pow((c - ior * i) / (c + ior * i), 2) + std::pow((ior * c - i) / (ior * c + i), 2)) / 2;
  }();
  EXPECT_NEAR(at(0.001f).x, (1 - r) * (1 - r), 0.01);
  EXPECT_LT(at(0.001f).y, 0.01);
  EXPECT_NEAR(at(-0.001f).y, (1 - r) * (1 - r), 0.01);
  shot.materials[0].thin_walled = true;
  EXPECT_GT(at(-0.9f + x - 4 + 1e-3f + 0.9f).x, 0.5f) << "a thin wall bends nothing: x = 4 there";
}

TEST(Whitted, LightGoesThroughGlassAndIsColouredByIt) {
  Shot shot = floor_shot({1, 1, 1});
  shot.lights = {DirectionalLight{{0, -1, 0}, {M_PI, M_PI, M_PI}}};
  shot.materials.push_back(glass(1.5f));
  shot.materials[1].thin_walled = true;
  shot.materials[1].base_color = {1, 0.5f, 0};
  shot.meshes.push_back(parallelogram({-5, 1, 5}, {10, 0, 0}, {0, 0, -10}, 1));
  const double through = 1 - 2 * 0.04 / 1.04;
  expect_near(seen(shot, kDown), to_float({through, through / 2, 0}), 1e-5);
}

TEST(Whitted, PicturesAreTheSameForAnyNumberOfThreadsAndAnyCrop) {
  Shot shot = floor_shot();
  shot.projection.width = 48;
  shot.projection.height = 32;
  shot.materials.push_back(lamp({3, 3, 3}));
  shot.materials.push_back(glass(1.5f));
  shot.meshes.push_back(parallelogram({0, 1, -3}, {2, 0, 0}, {0, 0, 2}, 1));
  shot.meshes.push_back(box({-1, -1, -5}, {0, 0, -4}, 2));
  shot.meshes[2].positions.push_back(shot.meshes[2].positions[0]);
  for (Vec3f& p : shot.meshes[2].positions[1]) p.x += 1;
  shot.meshes[2].key_times = {0, 1};
  for (const IntegratorKind kind : {IntegratorKind::tc, IntegratorKind::qmc, IntegratorKind::mixed}) {
    RenderParams params;
    params.integrator = kind;
    params.shading = kind == IntegratorKind::mixed ? ShadingKind::path : ShadingKind::whitted;
    params.tc_rays = 4;
    params.spp = 8;
    params.threads = 1;
    const Image one = render(shot, params);
    params.threads = 3;
    const Image three = render(shot, params);
    params.crop = Crop{20, 40, 10, 30};
    const Image part = render(shot, params);
    for (const char* name : {"R", "G", "B"}) {
      EXPECT_EQ(one.find(name)->values, three.find(name)->values);
      for (size_t y = 0; y < 20; ++y)
        for (size_t x = 0; x < 20; ++x)
          ASSERT_EQ(part.find(name)->values[y * 20 + x], one.find(name)->values[(y + 10) * 48 + x + 20]);
    }
  }
}

}  // namespace
}  // namespace kairos
