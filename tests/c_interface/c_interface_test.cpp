// kairos/kairos.h: what C gets is what C++ gets, and nothing that C does is the end of the process.
#include <cstring>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kairos/kairos.h>
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
                                   offsetof(kairos_mesh, one_sided)}),
              ElementsAre(40, 64, 72));
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

  for (const auto shading : {ShadingKind::whitted, ShadingKind::flat}) {
    kairos_render_params params{};
    params.struct_size = sizeof(params);
    params.spp = 4;
    params.shading = to_string(shading).data();
    params.aovs = "depth,coverage";
    kairos_image* image = nullptr;
    ASSERT_EQ(kairos_render(renderer, &params, nullptr, nullptr, &image), KAIROS_OK) << kairos_last_error();

    ShotOptions of_shot;
    of_shot.width = of_shot.height = 24;
    of_shot.lights = shading == ShadingKind::whitted ? LightChoice::automatic : LightChoice::file;
    RenderParams with;
    with.spp = 4;
    with.shading = shading;
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
  EXPECT_EQ(kairos_render(
                renderer, nullptr, [](void*, double) { return 0; }, nullptr, &image),
            KAIROS_CANCELLED);
  kairos_renderer_release(renderer);
}

}  // namespace
}  // namespace kairos
