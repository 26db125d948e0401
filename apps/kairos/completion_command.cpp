// kairos completion: what shells complete the command line by, made from the options that there are.
#include <algorithm>
#include <memory>

#include "arguments.h"
#include "commands.h"

namespace kairos::cli {

namespace {

struct OptionWords {
  std::string name;     ///< --name
  std::string help;     ///< one line
  std::string choices;  ///< separated by blanks; empty: files
  bool takes_value = false;
};

struct CommandWords {
  std::string name, help;
  std::vector<OptionWords> options;
};

/// Of a type that lists what may be given, as "box|gaussian".
std::string choices_of(std::string type) {
  const bool listed = type.find('|') != std::string::npos &&
                      type.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-|") == std::string::npos;
  if (!listed) return "";
  std::replace(type.begin(), type.end(), '|', ' ');
  return type;
}

/// Without what shells would take for their own.
std::string plain(std::string text) {
  constexpr std::string_view kSpecial = "'\"`$\\[]:\n";
  std::replace_if(
      text.begin(), text.end(), [&](char c) { return kSpecial.find(c) != kSpecial.npos; }, ' ');
  return text;
}

std::vector<CommandWords> words_of(const CLI::App& app) {
  std::vector<CommandWords> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    CommandWords words{command->get_name(), plain(command->get_description()), {}};
    for (const CLI::Option* option : command->get_options())
      if (!option->get_lnames().empty())
        words.options.push_back({"--" + option->get_lnames().front(), plain(option->get_description()),
                                 choices_of(option->get_type_name()), option->get_items_expected_max() > 0});
    commands.push_back(std::move(words));
  }
  return commands;
}

std::string bash(const std::vector<CommandWords>& commands) {
  std::string names, values, options;
  for (const CommandWords& command : commands) {
    names += " " + command.name;
    std::string all;
    for (const OptionWords& option : command.options) {
      all += " " + option.name;
      if (!option.choices.empty())
        values += fmt::format("    '{} {}') choices='{}' ;;\n", command.name, option.name, option.choices);
    }
    options += fmt::format("    {}) choices='{}' ;;\n", command.name, all.substr(1));
  }
  return fmt::format(R"(# bash completion for kairos
_kairos() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} choices=
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{} --help --version' -- "$word"))
    return
  fi
  case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}}" in
{}  esac
  if [[ -z $choices && $word == -* ]]; then case ${{COMP_WORDS[1]}} in
{}  esac; fi
  if [[ -n $choices ]]; then COMPREPLY=($(compgen -W "$choices" -- "$word")); fi
}}
complete -o default -F _kairos kairos
)",
                     names.substr(1), values, options);
}

std::string zsh(const std::vector<CommandWords>& commands) {
  std::string names, cases;
  for (const CommandWords& command : commands) {
    names += fmt::format("    '{}:{}'\n", command.name, command.help);
    cases += fmt::format("    {}) _arguments \\\n", command.name);
    for (const OptionWords& option : command.options)
      cases += fmt::format("      '{}[{}]{}' \\\n", option.name, option.help,
                           !option.takes_value      ? ""
                           : option.choices.empty() ? ":value:_files"
                                                    : ":value:(" + option.choices + ")");
    cases += "      '*:file:_files' ;;\n";
  }
  return fmt::format(R"(#compdef kairos
_kairos() {{
  local -a commands=(
{}  )
  if ((CURRENT == 2)); then _describe command commands; return; fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
compdef _kairos kairos
)",
                     names, cases);
}

std::string fish(const std::vector<CommandWords>& commands) {
  std::string text = "# fish completion for kairos\n";
  for (const CommandWords& command : commands) {
    text += fmt::format("complete -c kairos -n __fish_use_subcommand -fa {} -d '{}'\n", command.name, command.help);
    for (const OptionWords& option : command.options)
      text += fmt::format("complete -c kairos -n '__fish_seen_subcommand_from {}' -l {} -d '{}'{}\n", command.name,
                          option.name.substr(2), option.help,
                          !option.takes_value      ? ""
                          : option.choices.empty() ? " -r"
                                                   : " -xa '" + option.choices + "'");
  }
  return text;
}

}  // namespace

void add_completion_command(CLI::App& app, Action& chosen) {
  CLI::App& command = *app.add_subcommand("completion", "Print what a shell completes this command line by");
  const auto shell = std::make_shared<std::string>();
  command.add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command.callback([shell, &app, &chosen] {
    chosen = [shell, &app] {
      const auto words = words_of(app);
      fmt::print("{}", *shell == "bash" ? bash(words) : *shell == "zsh" ? zsh(words) : fish(words));
    };
  });
}

}  // namespace kairos::cli
