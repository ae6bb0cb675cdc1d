#include <array>
#include <memory>

#include <fmt/format.h>

#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/run_command.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::cli {
namespace {

constexpr const char* simulate_footer =
    "--set simulate.KEY=VALUE reaches every key of [simulate]: saltus simulate --help-all lists them.\n"
    "\nExample:\n  saltus simulate stick-slip --until 20 --set belt=0.3 --out stick-slip.json --report "
    "stick-slip.html";

std::string all_keys() {
  return fmt::format("\nKeys of [simulate], for --set simulate.KEY=VALUE:\n{}", pipeline::options_help());
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto* command = app.add_subcommand("simulate", "simulate a model and show its end state and events");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<RunArguments>();
  arguments->methods = frontend::RunMethods::chosen;
  add_run_options(*command, *arguments, simulate_shortcuts, {".json", ".csv", ".npz"},
                  "write the result: .json all, .csv trajectory, .events.csv events, .npz for NumPy; may repeat");
  command->add_option("--events", arguments->events, "events in the table: N at each end (10), or all")
      ->type_name("N|all");
  command
      ->add_option("--show", arguments->show,
                   "states, outputs, switching functions in the table, as names or patterns like v*; may repeat")
      ->type_name("NAME,…")
      ->delimiter(',')
      ->expected(1)
      ->take_all();
  command->add_flag_callback(
      "--error-estimate", [arguments] { arguments->settings.emplace_back("simulate.error_estimate=true"); },
      "estimate errors of rows, event times and end state by a second run");
  command->footer(simulate_footer);
  const auto compute = [](const model::System& system, const pipeline::SimulateOptions& options,
                          const pipeline::Observers& observers) {
    return pipeline::simulate(system, options, observers);
  };
  return {"simulate", [arguments, compute] { return run_model("simulate", *arguments, compute); }, all_keys()};
}

}  // namespace saltus::cli
