#include "saltus/cli/tool.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/base/version.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/exit_code.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/catalogue.hpp"

namespace saltus::cli {
namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The option of this command that was meant, or the command that has it.
std::string about_option(const std::string& typed, const CLI::App& app, const CLI::App& reader) {
  const auto known = option_names(reader);
  if (!nearest_words(typed, known).empty()) return suggest_word(typed, known);
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const auto names = option_names(*command);
    const auto meant = names_meant(typed, names);
    if (meant.empty() && !contains(names, typed)) continue;
    const auto& name = meant.empty() ? typed : meant.front();
    auto remedy = fmt::format("{} is an option of `saltus {}`", name, command->get_name());
    const bool writes_results = reader.get_option_no_throw("--format") != nullptr;
    const bool draws = reader.get_option_no_throw("--report") != nullptr;
    if (command->get_name() == "report" && writes_results) {
      remedy += fmt::format(": add --out r.json, then saltus report r.json {} …", name);
    } else if (command->get_name() == "report" && draws) {
      remedy += fmt::format("; saltus {} draws its table with --report FILE.html", reader.get_name());
    }
    return remedy;
  }
  return suggest_word(typed, known);
}

/// NAME=VALUE without its option: values of a sweep where there are several.
std::string about_setting(const std::string& typed, const CLI::App& reader) {
  const bool several = typed.find_first_of(":,", typed.find('=')) != std::string::npos;
  for (const auto* option : {several ? "--over" : "--set", "--set"}) {
    if (reader.get_option_no_throw(option) != nullptr) return fmt::format("did you mean {} {}?", option, typed);
  }
  return {};
}

/// What CLI11 did not understand, in our words: the first argument nobody expected, and what it may have meant.
Error unexpected_argument(const CLI::App& app, const CLI::ParseError& failure) {
  Error error{ErrorCode::parse_failure, failure.what(), "saltus --help shows how it is used", {}, {}};
  std::replace(error.message.begin(), error.message.end(), '\n', ' ');
  const auto chosen = app.get_subcommands();
  const auto& reader = chosen.empty() ? app : *chosen.front();
  if (!chosen.empty()) error.remedy = fmt::format("saltus {} --help shows how it is used", reader.get_name());
  for (const auto& argument : app.remaining(true)) {
    if (argument == "--") continue;
    const auto name = argument.substr(0, argument.find('='));
    error.message = fmt::format("unexpected argument '{}'", argument);
    if (name.starts_with("--")) error.remedy = about_option(name, app, reader);
    if (name.starts_with('-') || name == argument) break;
    if (auto remedy = about_setting(argument, reader); !remedy.empty()) error.remedy = std::move(remedy);
    break;
  }
  return error;
}

Error unknown_command(const std::string& word, const std::vector<Command>& commands) {
  std::vector<std::string> known{"help"};
  for (const auto& command : commands) {
    const bool hidden =
        command.name == "options-page" || command.name == "complete-names" || command.name == "man-page";
    if (!hidden) known.push_back(command.name);
  }
  std::error_code unknown;
  const auto model = frontend::find_model(word);
  const bool is_model = nearest_names(word, known).empty() && model && std::filesystem::exists(*model, unknown);
  return {ErrorCode::unknown_name,
          fmt::format("'{}' is no command of saltus", word),
          is_model ? fmt::format("did you mean `saltus simulate {}`?", word) : suggest(word, known),
          {},
          {}};
}

/// What was typed behind the name of the tool.
std::vector<std::string> arguments_of(int argc, char** argv) {
  return argc > 1 ? std::vector<std::string>(argv + 1, argv + argc) : std::vector<std::string>();
}

/// `help` and `help CMD` as `--help` and `CMD --help`; help about `help` is the help.
std::vector<std::string> help_for(std::vector<std::string> typed) {
  typed.erase(typed.begin());
  if (!typed.empty() && typed.front() == "help") typed.erase(typed.begin());
  if (typed.size() > 1) typed.resize(1);
  typed.emplace_back("--help");
  return typed;
}

void add_help_all(CLI::App& app, const std::vector<Command>& commands) {
  for (const auto& command : commands) {
    if (!command.more_help.empty()) {
      app.get_subcommand(command.name)->set_help_all_flag("--help-all", "the same, with every key of the model file");
    }
  }
}

ExitCode run(int argc, char** argv) {
  CLI::App app("Simulates and optimises nonsmooth dynamical systems: switches and sliding modes, located exactly.",
               "saltus");
  app.set_version_flag("--version", fmt::format("saltus {}", version));
  app.footer("Example:\n  saltus simulate stick-slip");
  app.get_formatter()->column_width(26);
  const std::vector<Command> commands{
      add_simulate(app), add_sweep(app),       add_optimize(app), add_compare(app),    add_order(app),
      add_check(app),    add_mpcc(app),        add_models(app),   add_report(app),     add_diff(app),
      add_new(app),      add_cite(app),        add_schema(app),   add_completion(app), add_complete_names(app),
      add_man_page(app), add_options_page(app)};
  add_help_all(app, commands);
  auto typed = arguments_of(argc, argv);
  if (!typed.empty() && typed.front() == "help") typed = help_for(typed);
  const auto chosen = [&](const Command& command) { return !typed.empty() && command.name == typed.front(); };
  const auto command = std::find_if(commands.begin(), commands.end(), chosen);
  if (command == commands.end() && !typed.empty() && !typed.front().starts_with('-')) {
    return refuse(unknown_command(typed.front(), commands));
  }
  try {
    app.parse(std::vector<std::string>(typed.rbegin(), typed.rend()));  // CLI11 takes them from the back
  } catch (const CLI::CallForAllHelp&) {
    print(app.help() + command->more_help);
    return ExitCode::done;
  } catch (const CLI::ParseError& failure) {
    if (failure.get_exit_code() != 0) return refuse(unexpected_argument(app, failure));
    app.exit(failure);  // prints the help or the version that was asked for
    return ExitCode::done;
  }
  if (command != commands.end()) {
    const ExitCode code = command->run();
    const auto unwritten = lost_output();
    return unwritten ? refuse(*unwritten) : code;
  }
  print_error(app.help());
  return ExitCode::bad_input;
}

}  // namespace

/// What calls std::abort, in a library or where an exception cannot pass, has the exit code of an internal error, too.
extern "C" void end_as_internal_error(int) { std::_Exit(static_cast<int>(ExitCode::internal_error)); }

int run_tool(int argc, char** argv) {
  std::signal(SIGABRT, end_as_internal_error);
  try {
    return static_cast<int>(run(argc, argv));
  } catch (const InternalError& failure) {
    print_error(failure.what());
    return static_cast<int>(ExitCode::internal_error);
  } catch (const std::exception& failure) {
    print_error(fmt::format("internal error: {}\n  please report this with the model file", failure.what()));
    return static_cast<int>(ExitCode::internal_error);
  }
}

}  // namespace saltus::cli
