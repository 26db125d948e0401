#include "study/page.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/web_page.h"
#include "study/machine.h"
#include "study/pictures.h"
#include "study/summary.h"

namespace kairos::study {

// Files of src/study/page, put into the program when it is built.
extern const char* const page_html;
extern const char* const style_css;
extern const char* const format_js;
extern const char* const plot_js;
extern const char* const tables_js;
extern const char* const pictures_js;
extern const char* const main_js;
extern const char* const self_test_js;

using Json = nlohmann::ordered_json;

namespace {

/// JSON has no infinity and no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json json_of(const Estimate& e) { return Json::array({number(e.median), number(e.low), number(e.high)}); }
Json json_of(const std::optional<Estimate>& e) { return e ? json_of(*e) : Json(); }

Json json_of(const SeriesSummary& series) {
  Json points = Json::array();
  for (const PointSummary& p : series.points) {
    Json json;
    json["name"] = name_of(p.setting);
    json["label"] = label_of(p.setting);
    json["spp"] = p.setting.spp;
    json["seconds"] = json_of(p.seconds);
    json["build"] = number(p.build_seconds.median);
    json["psnr"] = json_of(p.psnr);
    json["relative_mse"] = json_of(p.relative_mse);
    json["near_reference"] = p.near_reference;
    json["rays"] = p.first.rays;
    json["segments"] = p.first.segments;
    json["shaded"] = p.first.shaded;
    json["nodes"] = p.first.nodes;
    json["triangles"] = p.first.triangles;
    json["root_solves"] = p.first.root_solves;
    points.push_back(json);
  }
  Json json;
  json["name"] = series.series.name;
  json["label"] = series.series.label;
  json["points"] = points;
  return json;
}

Json json_of(const Comparison& c) {
  Json json;
  json["series"] = c.series;
  json["baseline"] = c.baseline;
  json["at"] = to_string(c.at);
  json["value"] = c.value;
  json["seconds"] = number(c.seconds);
  json["baseline_psnr"] = number(c.baseline_psnr);
  json["gain"] = json_of(c.gain);
  json["speed"] = json_of(c.speed);
  return json;
}

Json json_of(const Crop& crop) {
  Json views = Json::array();
  for (const Crop::View& view : crop.views) {
    Json json;
    json["label"] = view.label;
    json["psnr"] = number(view.psnr);
    json["image"] = view.image;
    views.push_back(json);
  }
  Json json;
  json["box"] = Json::array({crop.box.x, crop.box.y, crop.box.width, crop.box.height});
  json["gain"] = crop.gain;
  json["views"] = views;
  return json;
}

Json json_of(const PagePictures& page) {
  Json pictures = Json::array(), pairs = Json::array();
  for (const Picture& p : page.pictures) {
    Json json;
    json["name"] = name_of(p.setting);
    json["label"] = label_of(p.setting);
    json["series"] = p.series;
    json["seconds"] = number(p.seconds);
    json["psnr"] = number(p.psnr);
    json["image"] = p.image;
    json["error"] = p.error;
    pictures.push_back(json);
  }
  for (const EqualTime& pair : page.pairs) {
    Json crops = Json::array();
    for (const Crop& crop : pair.crops) crops.push_back(json_of(crop));
    Json json;
    json["series"] = pair.series;
    json["spp"] = pair.spp;
    json["seconds"] = number(pair.seconds);
    json["name"] = name_of(pair.setting);
    json["crops"] = crops;
    pairs.push_back(json);
  }
  Json json;
  json["width"] = page.width;
  json["height"] = page.height;
  json["reference"] = page.reference;
  json["list"] = pictures;
  json["pairs"] = pairs;
  return json;
}

Json json_of(const EntrySummary& summary, const SceneFacts& facts, const PagePictures& pictures) {
  Json json;
  json["name"] = name_of(summary.entry);
  json["scene"] = summary.entry.scene;
  json["shading"] = std::string(to_string(summary.entry.shading));
  json["width"] = facts.width;
  json["height"] = facts.height;
  json["triangles"] = facts.triangles;
  json["moving_triangles"] = facts.moving_triangles;
  json["keys"] = facts.keys;
  json["reference_spp"] = summary.reference->spp;
  json["reference_psnr"] = number(summary.reference->error.psnr);
  json["reference_seconds"] = number(summary.reference->seconds);
  json["series"] = Json::array();
  for (const SeriesSummary& series : summary.series) json["series"].push_back(json_of(series));
  json["comparisons"] = Json::array();
  for (const Comparison& comparison : summary.comparisons) json["comparisons"].push_back(json_of(comparison));
  json["pictures"] = json_of(pictures);
  return json;
}

Json machine_json() {
  const Machine machine = this_machine();
  Json json;
  json["processor"] = machine.processor;
  json["cores"] = machine.cores;
  json["instruction set"] = machine.instruction_set;
  json["compiler"] = machine.compiler;
  json["version"] = machine.version;
  json["commit"] = machine.commit;
  return json;
}

}  // namespace

std::string page_of(const std::string& data) {
  std::string script;
  for (const char* part : {format_js, plot_js, tables_js, pictures_js, self_test_js, main_js}) script += part;
  return web_page(page_html, style_css, script, data);
}

void write_results(const StudyOptions& options, const StudyFolder& folder, const std::string& command_line) {
  std::vector<EntrySummary> summaries;
  Json json;
  json["command"] = command_line;
  json["machine"] = machine_json();
  json["parameters"] = Json::parse(parameters_text(options));
  json["entries"] = Json::array();
  for (const std::string& scene : scene_names(options.scenes))
    for (const ShadingKind shading : options.shadings) {
      const Entry entry{scene, shading};
      summaries.push_back(summarize(entry, series_of(options), folder.runs(), *folder.find_reference(entry)));
      json["entries"].push_back(
          json_of(summaries.back(), *folder.find_scene(scene), pictures_of(summaries.back(), folder)));
    }
  write_file(folder.file("curves.csv"), curves_csv(summaries));
  write_file(folder.file("comparisons.csv"), comparisons_csv(summaries));
  write_file(folder.file("index.html"), page_of(json.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

}  // namespace kairos::study
