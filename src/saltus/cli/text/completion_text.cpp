#include "saltus/cli/text/completion_text.hpp"

#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace saltus::cli {
namespace {

std::string names_of(const std::vector<ShownCommand>& commands) {
  std::vector<std::string> names;
  for (const auto& command : commands) names.push_back(command.name);
  return fmt::format("{}", fmt::join(names, " "));
}

std::string flags_of(const ShownCommand& command) {
  std::vector<std::string> names;
  for (const auto& [name, about] : command.options) names.push_back(name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// The commands that take a model, as "simulate|sweep".
std::string model_commands(const std::vector<ShownCommand>& commands, std::string_view between) {
  std::vector<std::string> names;
  for (const auto& command : commands) {
    if (command.takes_model) names.push_back(command.name);
  }
  return fmt::format("{}", fmt::join(names, between));
}

/// A branch for every word of a command behind which only some words may stand.
std::string value_cases(const std::vector<ShownCommand>& commands, std::string_view form) {
  std::string cases;
  for (const auto& command : commands) {
    for (const auto& [behind, words] : command.values)
      cases += fmt::format(fmt::runtime(form), fmt::format("{} {}", command.name, behind), words);
  }
  return cases;
}

std::string in_single_quotes(std::string text) {
  for (std::size_t place = 0; (place = text.find('\'', place)) != std::string::npos; place += 2)
    text.insert(place, "\\");
  return "'" + text + "'";
}

}  // namespace

std::string bash_script(const std::vector<ShownCommand>& commands) {
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
  if [ "$before" = "--set" ] || [ "$before" = "--over" ] || [ "$before" = "--sample" ]; then
    COMPREPLY=($(compgen -S = -W "$(saltus complete-names -- "${{COMP_WORDS[@]:2}}" 2>/dev/null)" -- "$current"))
    compopt -o nospace 2>/dev/null
    return
  fi
  case "${{COMP_WORDS[1]}} $before" in
{}  esac
  case "${{COMP_WORDS[1]}}" in
{}    help) COMPREPLY=($(compgen -W "{}" -- "$current")); return ;;
  esac
  if [ "${{current#-}}" = "$current" ]; then
    case "${{COMP_WORDS[1]}}" in
      {}) words="$(saltus complete-names 2>/dev/null)" ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current") $(compgen -f -- "$current"))
    return
  fi
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o filenames -F _saltus saltus
)SH",
                     names_of(commands),
                     value_cases(commands, "    \"{}\") COMPREPLY=($(compgen -W \"{}\" -- \"$current\")); return ;;\n"),
                     cases, names_of(commands), model_commands(commands, "|"));
}

std::string zsh_script(const std::vector<ShownCommand>& commands) {
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
  if [[ $words[CURRENT-1] == --(set|over|sample) ]]; then
    compadd -S = -- $(saltus complete-names -- $words[3,-1] 2>/dev/null)
    return
  fi
  case "$words[2] $words[CURRENT-1]" in
{}  esac
  case $words[2] in
{}    help) compadd -- {}; return ;;
  esac
  if [[ $PREFIX == -* ]]; then
    compadd -- $options
  else
    case $words[2] in
      {}) compadd -- $(saltus complete-names 2>/dev/null) ;;
    esac
    _files
  fi
}}
(( $+functions[compdef] )) && compdef _saltus saltus
)SH",
                     names_of(commands), value_cases(commands, "    \"{}\") compadd -- {}; return ;;\n"), cases,
                     names_of(commands), model_commands(commands, "|"));
}

std::string fish_script(const std::vector<ShownCommand>& commands) {
  std::string text =
      "# Completion for fish: saltus completion fish > ~/.config/fish/completions/saltus.fish\n"
      "function __saltus_names\n  set -l words (commandline -opc)\n"
      "  saltus complete-names -- $words[3..] 2>/dev/null | string replace -r '$' '='\nend\n";
  for (const auto& command : commands) {
    text += fmt::format("complete -c saltus -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
                        in_single_quotes(command.about));
    for (const auto& [name, about] : command.options) {
      std::string values = name == "--set" || name == "--over" || name == "--sample" ? " -x -a '(__saltus_names)'" : "";
      for (const auto& [behind, words] : command.values) {
        if (behind == name) values = fmt::format(" -x -a '{}'", words);
      }
      text += fmt::format("complete -c saltus -n '__fish_seen_subcommand_from {}' -l {}{} -d {}\n", command.name,
                          name.substr(2), values, in_single_quotes(about));
    }
    for (const auto& [behind, words] : command.values) {
      if (behind == command.name)
        text += fmt::format("complete -c saltus -n '__fish_seen_subcommand_from {}' -f -a '{}'\n", behind, words);
    }
  }
  return text + fmt::format(
                    "complete -c saltus -n '__fish_seen_subcommand_from {}' -a "
                    "'(saltus complete-names 2>/dev/null)'\n",
                    model_commands(commands, " "));
}

}  // namespace saltus::cli
