#include "study/study_folder.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/files.h>

#include "base/file.h"
#include "study/machine.h"

namespace kairos::study {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kSceneHeader = "scene,width,height,triangles,moving_triangles,keys";

/// FNV-1a over a file's bytes: says whether it is still the same, to nobody's harm.
std::string content_hash(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::io, path, "cannot be opened for reading; check the name");
  uint64_t sum = 0xcbf29ce484222325;
  char block[65536];
  do {
    file.read(block, sizeof(block));
    for (std::streamsize i = 0; i < file.gcount(); ++i)
      sum = (sum ^ static_cast<unsigned char>(block[i])) * 0x100000001b3;
  } while (file);
  return fmt::format("{:016x}", sum);
}

template <class Enum>
Json names(const std::vector<Enum>& values) {
  Json list = Json::array();
  for (const Enum value : values) list.push_back(std::string(to_string(value)));
  return list;
}

Json parameters(const StudyOptions& o) {
  Json json;
  Json scenes = Json::array();
  for (const std::string& path : o.scenes) scenes.push_back(path + " " + content_hash(path));
  json["scenes"] = scenes;
  json["animation"] = o.load.animation;
  json["gltf scene"] = o.load.gltf_scene;
  json["strict"] = o.load.strict;
  json["root"] = o.load.root;
  json["memory budget"] = o.load.memory_budget;
  json["camera"] = o.shot.camera;
  json["frame"] = o.shot.frame ? Json(*o.shot.frame) : Json();
  json["fps"] = o.shot.fps ? Json(*o.shot.fps) : Json();
  json["shutter"] = o.shot.shutter ? Json(*o.shot.shutter) : Json();
  json["size"] = fmt::format("{}x{}", o.shot.width, o.shot.height);
  json["rows"] = o.rows;
  json["motion tolerance"] = o.shot.motion_tolerance;
  json["shading"] = names(o.shadings);
  json["methods"] = names(o.methods);
  json["budgets"] = o.budgets;
  json["tc rays"] = o.tc_rays;
  json["shading samples"] = o.shading_samples;
  json["keys"] = o.keys;
  json["seeds"] = o.seeds;
  json["threads"] = o.threads;
  json["reference spp"] = o.reference_spp;
  json["clock"] = std::string(to_string(o.clock));
  const Machine machine = this_machine();
  json["processor"] = machine.processor;
  json["cores"] = machine.cores;
  json["compiler"] = machine.compiler;
  json["version"] = machine.version;
  json["commit"] = machine.commit;
  return json;
}

/// "" when both are the same.
std::string first_difference(const Json& there, const Json& here) {
  for (const auto& [name, value] : here.items()) {
    const Json other = there.is_object() && there.contains(name) ? there[name] : Json();
    if (other != value) return fmt::format("{}: {} there, {} here", name, other.dump(), value.dump());
  }
  return "";
}

void remove_study(const fs::path& folder) {
  std::error_code ec;
  for (const char* name :
       {"study.json", "runs.csv", "references.csv", "scenes.csv", "curves.csv", "comparisons.csv", "index.html"})
    fs::remove(folder / name, ec);
  fs::remove_all(folder / "pictures", ec);
}

std::string scene_line(const SceneFacts& f) {
  return fmt::format("{},{},{},{},{},{}", f.name, f.width, f.height, f.triangles, f.moving_triangles, f.keys);
}

SceneFacts parse_scene(const std::string& line, const std::string& place) {
  SceneFacts f;
  const size_t comma = line.find(',');
  f.name = line.substr(0, comma);
  unsigned long long triangles = 0, moving = 0;
  int end = 0;
  const bool whole = comma != std::string::npos &&
                     std::sscanf(line.c_str() + comma, ",%d,%d,%llu,%llu,%d%n", &f.width, &f.height, &triangles,
                                 &moving, &f.keys, &end) == 5 &&
                     comma + static_cast<size_t>(end) == line.size();
  if (!whole) throw Error(ErrorCode::bad_input, place, "is not a line of a study's log; start anew with --force");
  f.triangles = triangles;
  f.moving_triangles = moving;
  return f;
}

}  // namespace

std::vector<std::string> scene_names(const std::vector<std::string>& paths) {
  std::vector<std::string> all;
  for (const std::string& path : paths) {
    std::string name = fs::path(path).stem().string();
    // pbrt's own are often called scene.pbrt in a folder with a name.
    if (name == "scene" && fs::path(path).has_parent_path()) name = fs::path(path).parent_path().filename().string();
    for (char& c : name)
      if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '-';
    if (name.empty()) name = "scene";
    std::string unique = name;
    for (int i = 2; std::find(all.begin(), all.end(), unique) != all.end(); ++i) unique = fmt::format("{}-{}", name, i);
    all.push_back(unique);
  }
  return all;
}

std::string parameters_text(const StudyOptions& options) {
  return parameters(options).dump(1, ' ', false, Json::error_handler_t::replace);
}

void write_file(const std::string& path, std::span<const uint8_t> bytes) {
  kairos::write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}
void write_file(const std::string& path, const std::string& text) { kairos::write_file(path, text); }

StudyFolder::StudyFolder(const StudyOptions& options) : folder_(options.folder) {
  std::error_code ec;
  fs::create_directories(folder_, ec);
  if (ec || !fs::is_directory(folder_)) throw Error(ErrorCode::io, folder_, "is not a folder and cannot become one");
  lock_.emplace(folder_);
  const Json here = Json::parse(parameters_text(options));
  const std::string path = file("study.json");
  if (options.force && fs::exists(path)) remove_study(folder_);
  if (fs::exists(path)) {
    constexpr uint64_t kMostBytes = 1 << 24;
    const std::vector<uint8_t> bytes = read_file(path, kMostBytes);
    const Json there = Json::parse(bytes, nullptr, false);
    const std::string differs = first_difference(there, here);
    if (!differs.empty())
      throw Error(
          ErrorCode::bad_usage, folder_,
          fmt::format("holds a study with other parameters ({}); choose another folder, or --force to start anew",
                      differs));
  }
  fs::create_directories(fs::path(folder_) / "pictures", ec);
  if (ec) throw Error(ErrorCode::io, folder_, "cannot be written: " + ec.message());
  run_log_.emplace(file("runs.csv"), kRunHeader);
  for (const std::string& line : run_log_->lines()) runs_.push_back(parse_run(line, run_log_->path()));
  reference_log_.emplace(file("references.csv"), kReferenceHeader);
  for (const std::string& line : reference_log_->lines())
    references_.push_back(parse_reference(line, reference_log_->path()));
  scene_log_.emplace(file("scenes.csv"), kSceneHeader);
  for (const std::string& line : scene_log_->lines()) scenes_.push_back(parse_scene(line, scene_log_->path()));
  write_file(path, here.dump(1) + "\n");
}

const Run* StudyFolder::find(const Entry& entry, const Setting& setting, int seed) const {
  for (const Run& run : runs_)
    if (run.entry == entry && run.setting == setting && run.seed == seed) return &run;
  return nullptr;
}
const ReferenceRun* StudyFolder::find_reference(const Entry& entry) const {
  for (const ReferenceRun& run : references_)
    if (run.entry == entry) return &run;
  return nullptr;
}
const SceneFacts* StudyFolder::find_scene(const std::string& name) const {
  for (const SceneFacts& facts : scenes_)
    if (facts.name == name) return &facts;
  return nullptr;
}

void StudyFolder::add(const Run& run) {
  run_log_->append(to_line(run));
  runs_.push_back(run);
}
void StudyFolder::add(const ReferenceRun& run) {
  reference_log_->append(to_line(run));
  references_.push_back(run);
}
void StudyFolder::add(const SceneFacts& facts) {
  scene_log_->append(scene_line(facts));
  scenes_.push_back(facts);
}

std::string StudyFolder::file(const std::string& name) const { return (fs::path(folder_) / name).string(); }
std::string StudyFolder::picture(const Entry& entry, const std::string& what, const std::string& extension) const {
  return (fs::path(folder_) / "pictures" / (name_of(entry) + "-" + what + extension)).string();
}

}  // namespace kairos::study
