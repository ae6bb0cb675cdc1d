// `saltus completion SHELL`, `saltus schema`, and what they ask for: made of the same tables as the help.
#include <memory>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/version.hpp"
#include "saltus/cli/catalogue.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/io/check/model_schema.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::cli {
namespace {

/// A subcommand with its options, without those for the tool itself.
struct Shown {
  std::string name, about;
  std::vector<std::pair<std::string, std::string>> options;
};

std::vector<Shown> shown_commands(const CLI::App& app) {
  std::vector<Shown> commands;
  for (const auto* command : app.get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); })) {
    Shown shown{command->get_name(), command->get_description(), {}};
    for (const auto* option : command->get_options()) {
      for (const auto& name : option->get_lnames()) shown.options.emplace_back("--" + name, option->get_description());
    }
    commands.push_back(std::move(shown));
  }
  return commands;
}

std::string names_of(const std::vector<Shown>& commands) {
  std::vector<std::string> names;
  for (const auto& command : commands) names.push_back(command.name);
  return fmt::format("{}", fmt::join(names, " "));
}

std::string flags_of(const Shown& command) {
  std::vector<std::string> names;
  for (const auto& [name, about] : command.options) names.push_back(name);
  return fmt::format("{}", fmt::join(names, " "));
}

std::string bash_script(const std::vector<Shown>& commands) {
  std::string cases;
  for (const auto& command : commands)
    cases += fmt::format("    {}) words=\"{}\" ;;\n", command.name, flags_of(command));
  return fmt::format(R"SH(# Completion for bash: eval "$(saltus completion bash)"
_saltus() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" words=""
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{} help --help --version" -- "$current"))
    return
  fi
  if [ "$before" = "--set" ]; then
    COMPREPLY=($(compgen -S = -W "$(saltus complete-names "${{COMP_WORDS[2]}}" 2>/dev/null)" -- "$current"))
    compopt -o nospace 2>/dev/null
    return
  fi
  case "${{COMP_WORDS[1]}}" in
{}    help) words="{}" ;;
  esac
  if [ "${{current#-}}" = "$current" ]; then
    case "${{COMP_WORDS[1]}}" in
      simulate|optimize|compare|order|check|models) words="$(saltus complete-names 2>/dev/null)" ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current") $(compgen -f -- "$current"))
    return
  fi
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o filenames -F _saltus saltus
)SH",
                     names_of(commands), cases, names_of(commands));
}

std::string zsh_script(const std::vector<Shown>& commands) {
  std::string cases;
  for (const auto& command : commands)
    cases += fmt::format("    {}) options=({}) ;;\n", command.name, flags_of(command));
  return fmt::format(R"SH(#compdef saltus
# Completion for zsh: save as _saltus in a folder of $fpath, or: source <(saltus completion zsh)
_saltus() {{
  local -a options
  if (( CURRENT == 2 )); then
    compadd -- {} help
    return
  fi
  if [[ $words[CURRENT-1] == --set ]]; then
    compadd -S = -- $(saltus complete-names "$words[3]" 2>/dev/null)
    return
  fi
  case $words[2] in
{}    help) compadd -- {}; return ;;
  esac
  if [[ $PREFIX == -* ]]; then
    compadd -- $options
  else
    case $words[2] in
      simulate|optimize|compare|order|check|models) compadd -- $(saltus complete-names 2>/dev/null) ;;
    esac
    _files
  fi
}}
(( $+functions[compdef] )) && compdef _saltus saltus
)SH",
                     names_of(commands), cases, names_of(commands));
}

std::string in_single_quotes(std::string text) {
  for (std::size_t place = 0; (place = text.find('\'', place)) != std::string::npos; place += 2)
    text.insert(place, "\\");
  return "'" + text + "'";
}

std::string fish_script(const std::vector<Shown>& commands) {
  std::string text =
      "# Completion for fish: saltus completion fish > ~/.config/fish/completions/saltus.fish\n"
      "function __saltus_names\n  set -l words (commandline -opc)\n"
      "  saltus complete-names $words[3] 2>/dev/null | string replace -r '$' '='\nend\n";
  for (const auto& command : commands) {
    text += fmt::format("complete -c saltus -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
                        in_single_quotes(command.about));
    for (const auto& [name, about] : command.options) {
      const std::string values = name == "--set" ? " -x -a '(__saltus_names)'" : "";
      text += fmt::format("complete -c saltus -n '__fish_seen_subcommand_from {}' -l {}{} -d {}\n", command.name,
                          name.substr(2), values, in_single_quotes(about));
    }
  }
  return text +
         "complete -c saltus -n '__fish_seen_subcommand_from simulate optimize compare order check models' -a "
         "'(saltus complete-names 2>/dev/null)'\n";
}

/// Text as troff takes it.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else if ((c == '.' || c == '\'') && (safe.empty() || safe.back() == '\n')) {
      safe += std::string("\\&") + c;
    } else {
      safe += c;
    }
  }
  return safe;
}

/// saltus(1): every command with its options.
std::string man_page(const std::vector<Shown>& commands) {
  std::string text = fmt::format(
      ".TH SALTUS 1 \"\" \"saltus {}\"\n.SH NAME\nsaltus \\- simulates and optimises nonsmooth dynamical systems\n"
      ".SH SYNOPSIS\n.B saltus\n.I command\n[\\fIarguments\\fR]\n.SH COMMANDS\n",
      version);
  for (const auto& command : commands) {
    text += fmt::format(".SS {}\n{}\n", roff(command.name), roff(command.about));
    for (const auto& [name, about] : command.options) {
      text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(name), roff(about));
    }
  }
  return text +
         ".SH EXIT STATUS\n0 done; 1 diff found a difference, or an internal error; 2 bad input, nothing was written; "
         "3 the "
         "numerics stopped early.\n.SH ENVIRONMENT\n.TP\nSALTUS_MODELS\na folder of models before those of the "
         "catalogue\n.TP\nSALTUS_CACHE\nwhere compiled model functions are kept, else $XDG_CACHE_HOME/saltus or "
         "~/.cache/saltus\n.TP\nSALTUS_PLOTLY\na plotly.min.js for reports\n.TP\nCC\nthe compiler of model "
         "functions\n.TP\nNO_COLOR\nno colours on terminals\n";
}

ExitCode print_completion(const CLI::App& app, const std::string& shell) {
  const auto commands = shown_commands(app);
  if (shell == "bash") {
    print(bash_script(commands));
  } else if (shell == "zsh") {
    print(zsh_script(commands));
  } else if (shell == "fish") {
    print(fish_script(commands));
  } else {
    return refuse({ErrorCode::unknown_name,
                   fmt::format("there is no completion for '{}'", shell),
                   suggest(shell, {"bash", "zsh", "fish"}),
                   {},
                   {}});
  }
  return ExitCode::done;
}

/// Names that --set of a model takes, or those of the catalogue; of a model with mistakes those that can be read.
ExitCode print_names(const std::string& model) {
  std::set<std::string> names;
  if (model.empty()) {
    for (const auto& entry : catalogue()) names.insert(entry.name);
  } else if (const auto path = find_model(model); path && *path != "-") {
    if (const auto text = io::read_model_text(*path)) {
      const auto described = io::diagnose_model(text->text, text->name).model.description;
      for (const auto& entry : described.parameters) names.insert(entry.name);
      for (const auto& entry : described.states) names.insert(entry.name);
      for (const auto& entry : described.controls) names.insert(entry.name);
    }
  }
  for (const auto& name : names) print(name + "\n");
  return ExitCode::done;
}

}  // namespace

Command add_completion(CLI::App& app) {
  auto* command = app.add_subcommand("completion", "print completion for a shell: bash, zsh or fish");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required();
  command->footer("Example:\n  saltus completion bash > ~/.local/share/bash-completion/completions/saltus");
  return {"completion", [&app, shell] { return print_completion(app, *shell); }};
}

Command add_complete_names(CLI::App& app) {
  auto* command = app.add_subcommand("complete-names", "names for completion")->group("");
  auto model = std::make_shared<std::string>();
  command->add_option("MODEL", *model, "a model; without one the catalogue");
  return {"complete-names", [model] { return print_names(*model); }};
}

Command add_man_page(CLI::App& app) {
  app.add_subcommand("man-page", "the manual page")->group("");
  return {"man-page", [&app] {
            print(man_page(shown_commands(app)));
            return ExitCode::done;
          }};
}

Command add_schema(CLI::App& app) {
  auto* command = app.add_subcommand("schema", "print the JSON schema of model files, for editors");
  command->footer(
      "An editor with TOML support (taplo, Even Better TOML) reads it where a model begins with\n"
      "#:schema ./saltus.schema.json\n"
      "\nExample:\n  saltus schema > saltus.schema.json");
  return {"schema", [] {
            print(io::model_schema());
            return ExitCode::done;
          }};
}

}  // namespace saltus::cli
