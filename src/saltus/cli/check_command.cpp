#include <memory>

#include <CLI/CLI.hpp>

#include "saltus/cli/check_text.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/model_input.hpp"
#include "saltus/cli/progress.hpp"
#include "saltus/cli/terminal.hpp"

namespace saltus::cli {
namespace {

struct CheckArguments {
  std::string model;
  std::vector<std::string> settings;
};

ExitCode run_check(const CheckArguments& arguments) {
  const auto input = read_input(arguments.model, arguments.settings);
  if (!input) return refuse(input.error());
  ProgressLine progress(ShowProgress::when_terminal);
  const auto text = check_text(*input, watched(progress));
  progress.clear();
  if (!text) return refuse(io::located(text.error(), input->file));
  print(*text);
  if (!interrupted()) return ExitCode::done;
  print_error("stopped early: stopped_by_user: the ranks are those until then");
  return ExitCode::stopped_early;
}

}  // namespace

Command add_check(CLI::App& app) {
  auto* command = app.add_subcommand("check", "read a model, classify its switching functions, warn");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<CheckArguments>();
  command
      ->add_option("MODEL", arguments->model,
                   "model file, a name of the catalogue (saltus models), or - for standard input")
      ->required();
  command->add_option("--set", arguments->settings, "change a value before checking, as in simulate")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  command->footer("Example:\n  saltus check stick-slip");
  return {"check", [arguments] { return run_check(*arguments); }};
}

}  // namespace saltus::cli
