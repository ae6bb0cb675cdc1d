// Scripts that complete the command line of the tool in a shell.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace saltus::cli {

/// Holds a subcommand with its options, without those for the tool itself.
struct ShownCommand {
  std::string name, about;
  std::vector<std::pair<std::string, std::string>> options{};
  /// What may stand behind a word, where the help lists it as a|b|c: behind an option, or behind the command itself.
  std::vector<std::pair<std::string, std::string>> values{};
  bool takes_model = false;
};

[[nodiscard]] std::string bash_script(const std::vector<ShownCommand>& commands);
[[nodiscard]] std::string zsh_script(const std::vector<ShownCommand>& commands);
[[nodiscard]] std::string fish_script(const std::vector<ShownCommand>& commands);

}  // namespace saltus::cli
