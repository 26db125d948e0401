// kairos/kairos.h: what C gets is what C++ gets, and nothing that C does is the end of the process.
#include <cstring>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/kairos.h>
#include <kairos/make_scene.h>
#include <kairos/names.h>
#include <kairos/render.h>

namespace kairos {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr uint32_t kCorners[3] = {0, 1, 2};
constexpr float kTimes[2] = {0, 1};
constexpr float kBefore[9] = {-5, -1, 0, -3, -1, 0, -4, 1, 0}, kAfter[9] = {3, -1, 0, 5, -1, 0, 4, 1, 0};
constexpr const float* kKeys[2] = {kBefore, kAfter};
constexpr kairos_ray kAhead{{0, 0, 2}, {0, 0, -1}};

/// Flies past kAhead, which sees it from 0.4375 to 0.5625.
kairos_mesh flying() {
  kairos_mesh mesh{};
  mesh.struct_size = sizeof(mesh);
  mesh.triangles = kCorners;
  mesh.triangle_count = 1;
  mesh.vertex_count = 3;
  mesh.key_count = 2;
  mesh.key_times = kTimes;
  mesh.positions = kKeys;
  return mesh;
}

using TracerHandle = std::unique_ptr<kairos_tracer, decltype(&kairos_tracer_release)>;
TracerHandle tracer_of(const kairos_mesh& mesh, const kairos_tracer_options* options = nullptr) {
  kairos_tracer* tracer = nullptr;
  EXPECT_EQ(kairos_make_tracer(&mesh, 1, options, &tracer), KAIROS_OK) << kairos_last_error();
  return {tracer, &kairos_tracer_release};
}
using WorkspaceHandle = std::unique_ptr<kairos_workspace, decltype(&kairos_workspace_release)>;
WorkspaceHandle workspace() {
  kairos_workspace* made = nullptr;
  EXPECT_EQ(kairos_make_workspace(&made), KAIROS_OK);
  return {made, &kairos_workspace_release};
}

std::vector<std::array<float, 2>> seen(const kairos_tracer* tracer, const kairos_limits* limits = nullptr) {
  const auto space = workspace();
  const kairos_segment* segments = nullptr;
  size_t count = 0;
  EXPECT_EQ(kairos_trace(tracer, space.get(), &kAhead, KAIROS_VISIBLE, limits, &segments, &count), KAIROS_OK);
  std::vector<std::array<float, 2>> times;
  for (size_t i = 0; i < count; ++i) times.push_back({segments[i].begin, segments[i].end});
  return times;
}
using Times = std::array<float, 2>;

TEST(CInterface, OneRayPacketsAndManySayTheSame) {
  kairos_tracer_options options{};
  options.struct_size = sizeof(options);
  options.fast = 1;
  const auto tracer = tracer_of(flying(), &options);
  EXPECT_THAT(seen(tracer.get()), ElementsAre(Times{0.4375f, 0.5625f}));
  const kairos_limits late{0.5f, 1, 10};
  EXPECT_THAT(seen(tracer.get(), &late), ElementsAre(Times{0.5f, 0.5625f}));

  const auto space = workspace();
  const kairos_ray rays[2] = {{{9, 9, 2}, {0, 0, -1}}, kAhead};
  const kairos_segment* of_packet[2];
  size_t counts[2];
  ASSERT_EQ(kairos_trace_packet(tracer.get(), space.get(), rays, 2, KAIROS_VISIBLE, nullptr, of_packet, counts),
            KAIROS_OK);
  EXPECT_THAT(counts, ElementsAre(0, 1));
  EXPECT_FLOAT_EQ(of_packet[1]->begin, 0.4375f);
  EXPECT_EQ(kairos_trace_packet(tracer.get(), space.get(), rays, 17, KAIROS_VISIBLE, nullptr, of_packet, counts),
            KAIROS_BAD_USAGE);

  const kairos_time_range* ranges = nullptr;
  size_t count = 0;
  ASSERT_EQ(kairos_occluded(tracer.get(), space.get(), &kAhead, nullptr, &ranges, &count), KAIROS_OK);
  ASSERT_EQ(count, 1u);
  EXPECT_FLOAT_EQ(ranges[0].end, 0.5625f);

  kairos_hits* hits = nullptr;
  ASSERT_EQ(kairos_query(tracer.get(), rays, 2, KAIROS_ALL, nullptr, &hits), KAIROS_OK);
  const kairos_segment* segments = nullptr;
  const size_t* offsets = nullptr;
  size_t ray_count = 0;
  ASSERT_EQ(kairos_hits_data(hits, &segments, &count, &offsets, &ray_count), KAIROS_OK);
  EXPECT_THAT(std::vector(offsets, offsets + ray_count + 1), ElementsAre(0u, 0u, 1u));
  EXPECT_FLOAT_EQ(segments[0].end, 0.5625f);
  EXPECT_EQ(segments[0].front, 1);
  kairos_hits_release(hits);
}

TEST(CInterface, CutOutsAreAsked) {
  kairos_cut_outs cut_outs{};
  cut_outs.struct_size = sizeof(cut_outs);
  int asked = 0;
  cut_outs.user = &asked;
  cut_outs.has = [](void*, uint32_t) { return 1; };
  // There in 20 short stretches: more than there is room for at first.
  cut_outs.solid_times = [](void* user, const kairos_ray*, const kairos_segment* hit, float* times,
                            size_t capacity) -> size_t {
    ++*static_cast<int*>(user);
    for (size_t i = 0; i < 40 && i < capacity; ++i)
      times[i] = hit->begin + (hit->end - hit->begin) * static_cast<float>(i) / 40;
    return 40;
  };
  cut_outs.solid = [](void*, const kairos_ray*, uint32_t, uint32_t, float) { return 0; };
  kairos_tracer_options options{};
  options.struct_size = sizeof(options);
  options.cut_outs = &cut_outs;
  const auto tracer = tracer_of(flying(), &options);
  EXPECT_EQ(seen(tracer.get()).size(), 20u);
  EXPECT_EQ(asked, 2);
  kairos_mesh still = flying();
  const float* one_key[1] = {kBefore};
  still.key_count = 1;
  still.positions = one_key;
  const auto none = tracer_of(still, &options);
  const auto space = workspace();
  const kairos_ray ray{{-4, 0, 2}, {0, 0, -1}};
  const kairos_segment* segments = nullptr;
  size_t count = 1;
  ASSERT_EQ(kairos_trace(none.get(), space.get(), &ray, KAIROS_VISIBLE, nullptr, &segments, &count), KAIROS_OK);
  EXPECT_EQ(count, 0u);
}

// A program keeps running with a library that was made for a shorter or a longer struct.
TEST(CInterface, StructsOfOtherLengths) {
  struct {
    kairos_tracer_options known;
    char future[64];
  } longer{};
  std::memset(&longer, 0x5a, sizeof(longer));
  longer.known = {};
  longer.known.struct_size = sizeof(longer);
  EXPECT_EQ(seen(tracer_of(flying(), &longer.known).get()).size(), 1u);

  kairos_tracer_options shorter{};
  shorter.struct_size = offsetof(kairos_tracer_options, instruction_set);
  shorter.instruction_set = "not read";
  EXPECT_EQ(seen(tracer_of(flying(), &shorter).get()).size(), 1u);

  kairos_tracer_options unset{};
  kairos_tracer* none = nullptr;
  const kairos_mesh mesh = flying();
  EXPECT_EQ(kairos_make_tracer(&mesh, 1, &unset, &none), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("struct_size"));
}

// What programs were compiled with. Members are added at the end; whoever changes a line of this breaks them.
TEST(CInterface, LayoutsStay) {
  EXPECT_THAT((std::vector<size_t>{offsetof(kairos_mesh, triangles), offsetof(kairos_mesh, stride),
                                   offsetof(kairos_mesh, one_sided), offsetof(kairos_mesh, uvs)}),
              ElementsAre(40, 64, 72, 88));
  EXPECT_THAT((std::vector<size_t>{offsetof(kairos_cut_outs, user), offsetof(kairos_cut_outs, solid)}),
              ElementsAre(8, 32));
  EXPECT_THAT(
      (std::vector<size_t>{offsetof(kairos_tracer_options, cut_outs), offsetof(kairos_tracer_options, threads)}),
      ElementsAre(16, 24));
  EXPECT_THAT(
      (std::vector<size_t>{offsetof(kairos_load_options, memory_budget), offsetof(kairos_load_options, threads)}),
      ElementsAre(32, 40));
  EXPECT_THAT((std::vector<size_t>{offsetof(kairos_shot_options, frame), offsetof(kairos_shot_options, threads)}),
              ElementsAre(24, 84));
  EXPECT_THAT((std::vector<size_t>{offsetof(kairos_render_params, seed), offsetof(kairos_render_params, threads)}),
              ElementsAre(64, 88));
  EXPECT_THAT((std::vector<size_t>{sizeof(kairos_ray), sizeof(kairos_segment), sizeof(kairos_limits)}),
              ElementsAre(24, 28, 12));
}

/// The camera's placement: at z = 5, looking along -z.
constexpr double kToWorld[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5, 0, 0, 0, 1};

TEST(CInterface, ScenesFromMemoryAreThoseOfCpp) {
  const float left[9] = {-2, -1, 0, 0, -1, 0, -1, 1, 0}, right[9] = {0, -1, 0, 2, -1, 0, 1, 1, 0};
  const float* const keys[2] = {left, right};
  const float normals[9] = {0, 0, 1, 0, 1, 1, 1, 0, 1};
  const float* const normal_keys[2] = {normals, normals};
  const float times[2] = {0.5f, 2}, uvs[6] = {0, 0, 1, 0, 0, 1};
  const uint32_t corners[3] = {0, 1, 2};
  // As a program of tomorrow has them: with members that nobody knows yet.
  struct Longer {
    kairos_mesh known;
    char future[8];
  } meshes[2]{};
  for (Longer& mesh : meshes) {
    mesh.known.struct_size = sizeof(Longer);
    mesh.known.triangle_count = 1;
    mesh.known.vertex_count = 3;
    mesh.known.triangles = corners;
    mesh.known.key_count = 2;
    mesh.known.key_times = times;
    mesh.known.positions = keys;
    mesh.known.normals = normal_keys;
    mesh.known.uvs = uvs;
  }
  meshes[1].known.material = 1;
  kairos_material materials[2];
  for (kairos_material& material : materials) ASSERT_EQ(kairos_material_init(&material, sizeof(material)), KAIROS_OK);
  materials[1].base_color[0] = 1;
  materials[1].emission[2] = 0.5f;
  kairos_camera camera{};
  camera.struct_size = sizeof(camera);
  camera.to_world = kToWorld;
  camera.vfov_degrees = 40;
  kairos_light lights[2]{};
  for (kairos_light& light : lights) light.struct_size = sizeof(light);
  lights[0].kind = KAIROS_DIRECTIONAL_LIGHT;
  lights[1].kind = KAIROS_POINT_LIGHT;
  for (int i = 0; i < 3; ++i) {
    lights[0].direction[i] = -1;
    lights[0].brightness[i] = 2;
    lights[1].position[i] = 3;
    lights[1].brightness[i] = 20;
  }
  kairos_scene_description description{};
  description.struct_size = sizeof(description);
  description.meshes = &meshes[0].known;
  description.mesh_count = 2;
  description.materials = materials;
  description.material_count = 2;
  description.cameras = &camera;
  description.camera_count = 1;
  description.lights = lights;
  description.light_count = 2;
  description.background[1] = 0.25f;
  description.fps = 1;

  SceneDescription same;
  for (uint32_t i = 0; i < 2; ++i)
    same.meshes.push_back({"",
                           {{0, 1, 2}},
                           {0.5, 2},
                           {{{-2, -1, 0}, {0, -1, 0}, {-1, 1, 0}}, {{0, -1, 0}, {2, -1, 0}, {1, 1, 0}}},
                           {2, {{0, 0, 1}, {0, 1, 1}, {1, 0, 1}}},
                           {{0, 0}, {1, 0}, {0, 1}},
                           {},
                           {},
                           i});
  same.materials.resize(2);
  same.materials[1].base_color.x = 1;
  same.materials[1].emission.z = 0.5f;
  same.cameras.resize(1);
  same.cameras[0].vfov = 40 * 3.14159265358979323846 / 180;
  same.cameras[0].keys = {{0, {0, 0, 5}, {0, 0, 4}, {0, 1, 0}}};
  same.lights = {DirectionalLight{{-1, -1, -1}, {2, 2, 2}}, PointLight{{3, 3, 3}, {20, 20, 20}}};
  same.background = {0, 0.25f, 0};
  same.fps = 1;

  kairos_scene* scene = nullptr;
  ASSERT_EQ(kairos_make_scene(&description, &scene), KAIROS_OK) << kairos_last_error();
  for (const bool transparent : {false, true}) {
    kairos_shot_options options{};
    options.struct_size = sizeof(options);
    options.width = options.height = 24;
    options.has_frame = options.has_shutter = 1;
    options.shutter_close = 2;
    options.transparent = transparent;
    options.has_background = !transparent;
    options.background[2] = 0.75f;
    kairos_shot* shot = nullptr;
    kairos_renderer* renderer = nullptr;
    kairos_image* image = nullptr;
    ASSERT_EQ(kairos_make_shot(scene, &options, &shot), KAIROS_OK) << kairos_last_error();
    ASSERT_EQ(kairos_make_renderer(shot, &renderer), KAIROS_OK);
    kairos_render_params params{};
    params.struct_size = sizeof(params);
    params.spp = 4;
    ASSERT_EQ(kairos_render(renderer, &params, nullptr, nullptr, &image), KAIROS_OK) << kairos_last_error();

    ShotOptions of_shot;
    of_shot.width = of_shot.height = 24;
    of_shot.frame = 0;
    of_shot.shutter = {0, 2};
    of_shot.lights = LightChoice::automatic;
    Shot expected = make_shot(*make_scene(same), of_shot);
    expected.backdrop = transparent ? Vec3f{} : Vec3f{0, 0, 0.75f};
    RenderParams with;
    with.spp = 4;
    with.shading = ShadingKind::whitted;
    with.alpha = transparent;
    const Image picture = render(expected, with);
    EXPECT_EQ(picture.channels.size(), transparent ? 4u : 3u);
    for (const Channel& channel : picture.channels) {
      const float* values = nullptr;
      ASSERT_EQ(kairos_image_channel(image, channel.name.c_str(), &values), KAIROS_OK) << channel.name;
      EXPECT_EQ(std::vector(values, values + 24 * 24), channel.values) << channel.name;
    }
    kairos_image_release(image);
    kairos_renderer_release(renderer);
    kairos_shot_release(shot);
  }
  kairos_scene_release(scene);

  lights[1].kind = 9;
  EXPECT_EQ(kairos_make_scene(&description, &scene), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("KAIROS_POINT_LIGHT"));
  lights[1].kind = KAIROS_POINT_LIGHT;
  meshes[1].known.material = 2;
  EXPECT_EQ(kairos_make_scene(&description, &scene), KAIROS_BAD_INPUT);
  camera.to_world = nullptr;
  EXPECT_EQ(kairos_make_scene(&description, &scene), KAIROS_BAD_USAGE);
  EXPECT_EQ(kairos_make_scene(nullptr, &scene), KAIROS_BAD_USAGE);
  EXPECT_EQ(kairos_material_init(materials, 4096), KAIROS_BAD_USAGE);
}

TEST(CInterface, ErrorsAreStatusesAndALineOfTheThread) {
  const char* nowhere = "nowhere.glb";
  kairos_scene* scene = nullptr;
  EXPECT_EQ(kairos_load(&nowhere, 1, nullptr, &scene), KAIROS_IO);
  EXPECT_THAT(kairos_last_error(), HasSubstr("nowhere.glb"));
  std::thread([] { EXPECT_STREQ(kairos_last_error(), ""); }).join();
  EXPECT_EQ(kairos_load(&nowhere, 1, nullptr, nullptr), KAIROS_BAD_USAGE);
  EXPECT_EQ(kairos_load(nullptr, 1, nullptr, &scene), KAIROS_BAD_USAGE);
  EXPECT_EQ(kairos_make_shot(nullptr, nullptr, nullptr), KAIROS_BAD_USAGE);
  kairos_mesh mesh = flying();
  mesh.vertex_count = 2;
  kairos_tracer* tracer = nullptr;
  EXPECT_EQ(kairos_make_tracer(&mesh, 1, nullptr, &tracer), KAIROS_BAD_INPUT);
  mesh = flying();
  mesh.positions = nullptr;
  EXPECT_EQ(kairos_make_tracer(&mesh, 1, nullptr, &tracer), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("positions"));
  mesh = flying();
  mesh.stride = 6;
  EXPECT_EQ(kairos_make_tracer(&mesh, 1, nullptr, &tracer), KAIROS_BAD_USAGE);
  kairos_tracer_options options{};
  options.struct_size = sizeof(options);
  options.instruction_set = "mmx";
  mesh = flying();
  EXPECT_EQ(kairos_make_tracer(&mesh, 1, &options, &tracer), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("'mmx' is not one of"));
  EXPECT_EQ(tracer, nullptr);
  kairos_tracer_release(nullptr);
}

TEST(CInterface, PicturesAreTheSame) {
  const std::string path = KAIROS_SOURCE_DIR "/scenes/star/star.json";
  const char* name = path.c_str();
  kairos_scene* scene = nullptr;
  kairos_shot* shot = nullptr;
  kairos_renderer* renderer = nullptr;
  ASSERT_EQ(kairos_load(&name, 1, nullptr, &scene), KAIROS_OK);
  kairos_shot_options options{};
  options.struct_size = sizeof(options);
  options.width = options.height = 24;
  ASSERT_EQ(kairos_make_shot(scene, &options, &shot), KAIROS_OK) << kairos_last_error();
  ASSERT_EQ(kairos_make_renderer(shot, &renderer), KAIROS_OK);
  kairos_scene_release(scene);
  kairos_shot_release(shot);

  for (const auto shading : {ShadingKind::whitted, ShadingKind::path, ShadingKind::flat}) {
    kairos_render_params params{};
    params.struct_size = sizeof(params);
    params.spp = 4;
    params.max_depth = shading == ShadingKind::path ? -1 : 0;
    params.clamp = 0.25f;
    params.shading = to_string(shading).data();
    params.shadows = "sampled";
    params.cells = "on";
    params.aovs = "depth,coverage";
    kairos_image* image = nullptr;
    ASSERT_EQ(kairos_render(renderer, &params, nullptr, nullptr, &image), KAIROS_OK) << kairos_last_error();

    ShotOptions of_shot;
    of_shot.width = of_shot.height = 24;
    of_shot.lights = shading != ShadingKind::flat ? LightChoice::automatic : LightChoice::file;
    RenderParams with;
    with.spp = 4;
    if (shading == ShadingKind::path) with.max_depth = 0;
    with.clamp = 0.25f;
    with.shading = shading;
    with.shadows = Shadows::sampled;
    with.cells = Cells::on;
    with.aovs = {Aov::depth, Aov::coverage};
    const Image expected = render(make_shot(*load_scene({path}), of_shot), with);
    for (const Channel& channel : expected.channels) {
      const float* values = nullptr;
      ASSERT_EQ(kairos_image_channel(image, channel.name.c_str(), &values), KAIROS_OK) << channel.name;
      EXPECT_EQ(std::vector(values, values + 24 * 24), channel.values) << channel.name;
    }
    const float* none = nullptr;
    EXPECT_EQ(kairos_image_channel(image, "nobody's", &none), KAIROS_BAD_USAGE);
    kairos_image_release(image);
  }
  kairos_image* image = nullptr;
  kairos_render_params wrong{};
  wrong.struct_size = sizeof(wrong);
  wrong.cells = "some";
  EXPECT_EQ(kairos_render(renderer, &wrong, nullptr, nullptr, &image), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("cells: 'some' is not one of"));
  wrong.cells = nullptr;
  wrong.mirrors = "bent";
  EXPECT_EQ(kairos_render(renderer, &wrong, nullptr, nullptr, &image), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("mirrors: 'bent' is not one of"));
  wrong.mirrors = nullptr;
  wrong.shadows = "soft";
  EXPECT_EQ(kairos_render(renderer, &wrong, nullptr, nullptr, &image), KAIROS_BAD_USAGE);
  EXPECT_THAT(kairos_last_error(), HasSubstr("shadows: 'soft' is not one of"));
  EXPECT_EQ(kairos_render(
                renderer, nullptr, [](void*, double) { return 0; }, nullptr, &image),
            KAIROS_CANCELLED);
  kairos_renderer_release(renderer);
}

}  // namespace
}  // namespace kairos
