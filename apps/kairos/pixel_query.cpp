#include "pixel_query.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/picture.h>

namespace kairos::cli {

namespace {

// Writes a record. "{}" of a float: the shortest text that reads back as the same number.
class RecordText : public PixelConsumer {
 public:
  RecordText(const Shot& shot, const std::optional<Exposure>& exposure) : shot_(shot), exposure_(exposure) {}

  RecordNeeds needs() const override {
    const bool constant = !exposure_ || exposure_->shutter().curve.is_box();
    return {constant ? RecordNeeds::Time::box : RecordNeeds::Time::curves, false, false};
  }

  void add(const PixelRecord& record) override {
    say("{{\n  \"pixel\": [{}, {}],\n  \"window\": [{}, {}],\n  \"moves\": {},\n  \"plan\": {{\"tc_rays\": {}, "
        "\"discrete\": {}}},\n",
        record.x, record.y, record.window.begin, record.window.end, record.moves, record.plan.tc_rays,
        record.plan.discrete);
    say("  \"background\": {},\n  \"colour\": {},\n  \"rays\": ", colour(record.background),
        colour(reduce(record, weight(record)).colour));
    rays(record, record.rays);
    say(",\n  \"still\": ");
    if (record.still.rays.empty()) {
      say("null");
    } else {
      say("{{\"share\": {}, \"own\": {}, \"rays\": ", record.still.share, record.still.own);
      rays(record, record.still.rays);
      say("}}");
    }
    say("\n}}\n");
  }

  TimeWeight weight(const PixelRecord& record) const {
    return exposure_ ? exposure_->weight(record.x, record.y) : TimeWeight();
  }

  std::string_view text() const { return {text_.data(), text_.size()}; }

 private:
  template <class... Values>
  void say(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), form, std::forward<Values>(values)...);
  }
  static std::string colour(const Vec3f& c) { return fmt::format("[{}, {}, {}]", c.x, c.y, c.z); }
  /// JSON knows no infinity.
  static std::string number(float value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

  void rays(const PixelRecord& record, std::span<const PixelRay> rays) {
    say("[");
    for (const PixelRay& ray : rays) {
      say("{}\n    {{\"film\": [{}, {}], \"weight\": {}, \"time\": {}, \"segments\": {}, \"parts\": [",
          &ray == rays.data() ? "" : ",", ray.film.x, ray.film.y, ray.weight, number(ray.time),
          ray.visibility_segments);
      bool first = true;
      for (const SeenPart& seen : record.parts_of(ray)) {
        part(record, seen, first);
        first = false;
      }
      say("]}}");
    }
    say("]");
  }

  void part(const PixelRecord& record, const SeenPart& part, bool first) {
    const Segment& where = part.where;
    const bool sky = where.mesh == kNoMesh;
    say("{}\n      {{\"begin\": {}, \"end\": {}, \"dist_begin\": {}, \"dist_end\": {}, \"mesh\": {}, \"prim\": {}, ",
        first ? "" : ",", where.begin, where.end, number(where.dist_begin), number(where.dist_end),
        sky ? "null" : name(where.mesh),
        sky ? "null" : fmt::format("{}", shot_.meshes[where.mesh].prim_id(where.triangle)));
    say("\"front\": {}, \"layer\": {}, \"opacity\": {}, \"knots\": [", where.front, part.layer, part.opacity);
    for (const Knot& knot : record.knots_of(part))
      say("{}{{\"time\": {}, \"colour\": {}}}", &knot == record.knots_of(part).data() ? "" : ", ", knot.time,
          colour(knot.colour));
    say("]}}");
  }

  std::string name(uint32_t mesh) const {
    return nlohmann::json(shot_.meshes[mesh].name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  const Shot& shot_;
  std::optional<Exposure> exposure_;
  fmt::memory_buffer text_;
};

}  // namespace

void run_pixel_query(const SceneArguments& scene_arguments, SamplingArguments sampling,
                     const BackgroundChoice& background, std::array<int, 2> pixel) {
  read_calibration_into(sampling);
  const auto scene = load_scene(scene_arguments.paths, scene_arguments.load);
  const ExposedShot exposed = exposed_shot(scene_arguments, sampling.exposure, *scene);
  Shot shot = make_shot(*scene, exposed.options);
  background.apply(shot);
  sampling.params.exposure = exposed.exposure(shot);
  const auto [x, y] = pixel;
  if (x >= shot.projection.width || y >= shot.projection.height)
    throw Error(ErrorCode::bad_usage, "--pixel",
                fmt::format("{},{} lies outside of the frame of {}x{} pixels", x, y, shot.projection.width,
                            shot.projection.height));
  sampling.params.crop = Crop{x, x + 1, y, y + 1};
  sampling.params.threads = scene_arguments.threads;
  RecordText text(shot, sampling.params.exposure);
  PixelConsumer* const consumer = &text;
  Renderer(shot).render(sampling.params, {&consumer, 1});
  const std::string_view said = text.text();
  if (std::fwrite(said.data(), 1, said.size(), stdout) != said.size() || std::fflush(stdout) != 0)
    throw Error(ErrorCode::io, "standard output", std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace kairos::cli
