// `saltus completion SHELL`, `saltus schema`, and what they ask for: made of the same tables as the help.
#include <algorithm>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "saltus/base/version.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/completion_text.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/catalogue.hpp"
#include "saltus/io/check/model_schema.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::cli {
namespace {

/// "a b c" of a type a|b|c; empty for any other one.
std::string listed_words(std::string type) {
  const bool listed = type.find('|') != std::string::npos && std::all_of(type.begin(), type.end(), [](char c) {
                        return c == '|' || c == '-' || c == '_' || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
                      });
  std::replace(type.begin(), type.end(), '|', ' ');
  return listed ? type : "";
}

/// The same of the help "a, b or c".
std::string words_of_help(std::string help) {
  const auto last = help.rfind(" or ");
  if (last == std::string::npos) return "";
  help.replace(last, 4, "|");
  for (std::size_t place = 0; (place = help.find(", ", place)) != std::string::npos;) help.replace(place, 2, "|");
  return listed_words(std::move(help));
}

std::vector<ShownCommand> shown_commands(const CLI::App& app) {
  std::vector<ShownCommand> commands;
  for (const auto* command : app.get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); })) {
    ShownCommand shown{command->get_name(), command->get_description()};
    for (const auto* option : command->get_options()) {
      if (option->get_group().empty()) continue;  // not in the help
      auto words = listed_words(option->get_type_name());
      if (words.empty()) words = words_of_help(option->get_description());
      const bool positional = option->get_positional();
      for (const auto& name : option->get_lnames()) shown.options.emplace_back("--" + name, option->get_description());
      if (!words.empty()) shown.values.emplace_back(positional ? shown.name : shown.options.back().first, words);
      const bool of_catalogue = shown.name == "models" || option->get_name(true) == "MODEL";
      shown.takes_model = shown.takes_model || (positional && of_catalogue);
    }
    commands.push_back(std::move(shown));
  }
  return commands;
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
std::string man_page(const std::vector<ShownCommand>& commands) {
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

/// Names that --set of a model takes, which is the first of the words that is one; of a model with mistakes those that
/// can be read. Without words those of the catalogue.
ExitCode print_names(const std::vector<std::string>& words) {
  std::set<std::string> names;
  if (words.empty()) {
    for (const auto& entry : frontend::catalogue()) names.insert(entry.name);
  }
  for (const auto& word : words) {
    if (word.empty() || word.starts_with('-')) continue;
    const auto path = frontend::find_model(word);
    if (!path || *path == "-") continue;
    if (const auto text = io::read_model_text(*path)) {
      const auto described = io::diagnose_model(text->text, text->name).model.description;
      for (const auto& entry : described.parameters) names.insert(entry.name);
      for (const auto& entry : described.states) names.insert(entry.name);
      for (const auto& entry : described.controls) names.insert(entry.name);
      break;
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
  command->add_option("SHELL", *shell, "where it is to work")->required()->type_name("bash|zsh|fish");
  command->footer("Example:\n  saltus completion bash > ~/.local/share/bash-completion/completions/saltus");
  return {"completion", [&app, shell] { return print_completion(app, *shell); }};
}

Command add_complete_names(CLI::App& app) {
  auto* command = app.add_subcommand("complete-names", "names for completion")->group("");
  auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("WORDS", *words, "what was typed; without it the catalogue");
  return {"complete-names", [words] { return print_names(*words); }};
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
