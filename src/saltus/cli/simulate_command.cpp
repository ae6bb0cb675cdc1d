#include <array>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "saltus/cli/commands.hpp"
#include "saltus/cli/run_command.hpp"
#include "saltus/pipeline/option_fields.hpp"

namespace saltus::cli {
namespace {

constexpr std::array simulate_shortcuts{
    until_shortcut,
    Shortcut{"--method", "simulate.method", "METHOD", "event, fesd, timestepping or smoothed"},
    Shortcut{"--rtol", "simulate.rtol", "R", "relative tolerance"},
    Shortcut{"--atol", "simulate.atol", "A", "absolute tolerance"},
    Shortcut{"--integrator", "simulate.event.integrator", "I", "dopri5, dop853, radau5 or taylor"},
    Shortcut{"--branch", "simulate.event.branches", "report|all|K",
             "report, all or K: follow other admissible motions, at most K trajectories"},
};

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
  arguments->methods = RunMethods::chosen;
  add_run_options(*command, *arguments, simulate_shortcuts, {".json", ".csv", ".npz"},
                  "write the result: .json all, .csv trajectory, .events.csv events, .npz for NumPy; may repeat");
  command->add_option("--events", arguments->events, "events in the table: N at each end (10), or all")
      ->type_name("N|all");
  command->footer(simulate_footer);
  return {"simulate", [arguments] { return run_model("simulate", *arguments, pipeline::simulate); }, all_keys()};
}

}  // namespace saltus::cli
