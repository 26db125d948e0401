// kairos jobs: what a scheduler is given so that it renders the parts of a job and merges them.
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "arguments.h"
#include "commands.h"
#include "quoted.h"

namespace kairos::cli {

namespace {

struct JobsArguments {
  std::string scheduler;
  int parts = 0;
  std::string command = "render";   ///< or events
  std::vector<std::string> render;  ///< its arguments
};

/// The value of an option among arguments, as "-o X", "--output X" or "--output=X"; empty where it is not given.
std::string value_of(const std::vector<std::string>& arguments, const std::vector<std::string>& names) {
  for (size_t i = 0; i < arguments.size(); ++i)
    for (const std::string& name : names) {
      if (arguments[i] == name && i + 1 < arguments.size()) return arguments[i + 1];
      if (arguments[i].starts_with(name + "=")) return arguments[i].substr(name.size() + 1);
    }
  return "";
}

/// The files that the parts are of.
std::vector<std::string> outs_of(const JobsArguments& arguments) {
  std::vector<std::string> outs;
  for (const auto& names : {std::vector<std::string>{"-o", "--output"}, {"--time"}})
    if (std::string out = value_of(arguments.render, names); !out.empty()) outs.push_back(std::move(out));
  return outs;
}

std::vector<std::string> part_arguments(const JobsArguments& arguments) {
  std::vector<std::string> words = {arguments.command};
  words.insert(words.end(), arguments.render.begin(), arguments.render.end());
  return words;
}

std::vector<std::string> merge_arguments(const JobsArguments& arguments) {
  const std::string frames = value_of(arguments.render, {"--frames"});
  std::vector<std::string> words = {"merge", "--clean"};
  const std::vector<std::string> outs = outs_of(arguments);
  words.insert(words.begin() + 1, outs.begin(), outs.end());
  const bool of_one_file = !value_of(arguments.render, {"--time"}).empty();  // of all frames
  if (!frames.empty() && !of_one_file) words.insert(words.end(), {"--frames", frames});
  return words;
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line = "kairos";
  for (const std::string& word : words) line += " " + quoted(word);
  return line;
}

std::string slurm_script(const JobsArguments& arguments) {
  std::vector<std::string> render = part_arguments(arguments);
  render.insert(render.end(), {"--part", "slurm"});
  const std::string folder = quoted(std::filesystem::current_path().string());
  std::string script = fmt::format(R"(#!/bin/sh
# Submits {0} parts of a rendering, and what merges them once all are there. Run it where sbatch is. A part that is there
# already takes no time: after a failure, run it again.
set -e
parts=$(sbatch --parsable --job-name=kairos --array=1-{0} --requeue --open-mode=append --chdir={1} <<'END_OF_PART'
#!/bin/sh
exec {2}
END_OF_PART
)
echo "parts: job $parts"
)",
                                   arguments.parts, folder, shell_line(render));
  script += fmt::format(
      R"(merged=$(sbatch --parsable --job-name=kairos-merge --dependency="afterok:$parts" --chdir={} <<'END_OF_MERGE'
#!/bin/sh
exec {}
END_OF_MERGE
)
echo "merge: job $merged"
)",
      folder, shell_line(merge_arguments(arguments)));
  return script;
}

/// YAML holds what JSON does.
std::string json_text(const std::string& text) { return nlohmann::json(text).dump(); }

std::string openjd_action(const std::vector<std::string>& words, bool of_part, int parts) {
  std::string text = "    actions:\n      onRun:\n        command: kairos\n        args:\n";
  for (const std::string& word : words) text += "        - " + json_text(word) + "\n";
  if (of_part) text += fmt::format("        - \"--part\"\n        - \"{{{{Task.Param.Part}}}}/{}\"\n", parts);
  return text;
}

std::string openjd_template(const JobsArguments& arguments) {
  std::vector<std::string> render = part_arguments(arguments);
  render.insert(render.end(), {"--progress", "openjd"});
  std::string text = fmt::format(R"(specificationVersion: jobtemplate-2023-09
name: kairos
steps:
- name: Render
  parameterSpace:
    taskParameterDefinitions:
    - name: Part
      type: INT
      range: "1-{}"
  script:
)",
                                 arguments.parts);
  text += openjd_action(render, true, arguments.parts);
  text += "- name: Merge\n  dependencies:\n  - dependsOn: Render\n  script:\n" +
          openjd_action(merge_arguments(arguments), false, arguments.parts);
  return text;
}

}  // namespace

void add_jobs_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("jobs", "Print what a scheduler needs to render a job in parts");
  const auto arguments = std::make_shared<JobsArguments>();
  command.add_option("SCHEDULER", arguments->scheduler, "slurm: a script that calls sbatch; openjd: a job template")
      ->type_name("slurm|openjd")
      ->required();
  add_count(command, "--parts", arguments->parts, 1, 65536, "How many parts")->required()->default_str("");
  command.allow_extras();
  command.footer(
      "Everything else is for kairos render: the scene, -o, ...; or, where it begins with 'events', for kairos events");
  command.callback([arguments, &chosen, &command] {
    arguments->render = command.remaining();
    if (!arguments->render.empty() && (arguments->render[0] == "events" || arguments->render[0] == "render")) {
      arguments->command = arguments->render[0];
      arguments->render.erase(arguments->render.begin());
    }
    if (arguments->scheduler != "slurm" && arguments->scheduler != "openjd")
      throw CLI::ValidationError("SCHEDULER",
                                 fmt::format("'{}' is not known; give slurm or openjd", arguments->scheduler));
    if (outs_of(*arguments).empty())
      throw CLI::ValidationError("--output", "give the file that is to be written: -o OUT.exr");
    if (!value_of(arguments->render, {"--part"}).empty())
      throw CLI::ValidationError("--part", "is what the scheduler decides; give --parts");
    chosen = [arguments] {
      const std::string text = arguments->scheduler == "slurm" ? slurm_script(*arguments) : openjd_template(*arguments);
      std::fwrite(text.data(), 1, text.size(), stdout);
    };
  });
}

}  // namespace kairos::cli
