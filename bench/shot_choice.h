// Which shot a benchmark program measures: its options, as those of kairos render.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/scene.h>

namespace kairos::bench {

class ShotChoice {
 public:
  ShotChoice(CLI::App& app, std::string size) : size_(std::move(size)) {
    app.add_option("scene", scenes_)->required();
    app.add_option("--size", size_);
    frame_option_ = app.add_option("--frame", frame_);
    app.add_option("--shutter", shutter_);
    app.add_option("--camera", camera_);
    app.add_option("--instances", instances_)->check(CLI::IsMember({"auto", "never", "always"}));
  }

  /// textures: read all of them.
  Shot make(bool textures) const {
    ShotOptions options;
    options.textures = textures;
    options.camera = camera_;
    options.instances = *parse<ShotOptions::Instances>(instances_);
    if (std::sscanf(size_.c_str(), "%dx%d", &options.width, &options.height) != 2)
      throw Error(ErrorCode::bad_usage, "--size", "give it as WIDTHxHEIGHT");
    if (frame_option_->count() > 0) options.frame = frame_;
    double open = 0, close = 0;
    if (!shutter_.empty()) {
      if (std::sscanf(shutter_.c_str(), "%lf,%lf", &open, &close) != 2)
        throw Error(ErrorCode::bad_usage, "--shutter", "give it as OPEN,CLOSE");
      options.shutter = {open, close};
    }
    return make_shot(*load_scene(scenes_), options);
  }

 private:
  std::vector<std::string> scenes_;
  std::string size_, shutter_, camera_, instances_ = "auto";
  double frame_ = 0;
  const CLI::Option* frame_option_ = nullptr;
};

}  // namespace kairos::bench
