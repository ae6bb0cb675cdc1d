// What the commands that run a model have in common: their options, and the way from there to table and files.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/cli/exit_code.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace CLI {
class App;
}

namespace saltus::cli {

/// Holds a flag that is short for --set KEY=VALUE.
struct Shortcut {
  const char* flag;
  const char* key;
  const char* placeholder;
  const char* help;
};

/// --until, as every command has it.
inline constexpr Shortcut until_shortcut{"--until", "simulate.until", "T", "end time"};

/// The flags of commands that simulate.
inline constexpr std::array simulate_shortcuts{
    until_shortcut,
    Shortcut{"--method", "simulate.method", "METHOD", "event, fesd, timestepping or smoothed"},
    Shortcut{"--rtol", "simulate.rtol", "R", "relative tolerance"},
    Shortcut{"--atol", "simulate.atol", "A", "absolute tolerance"},
    Shortcut{"--integrator", "simulate.event.integrator", "I",
             "auto, dopri5, dop853, radau5, radau9, radau13 or taylor"},
    Shortcut{"--branch", "simulate.event.branches", "report|all|K",
             "report, all or K: follow other admissible motions, at most K trajectories"},
};

/// Holds what was typed behind one of these commands.
struct RunArguments {
  std::string model;
  std::vector<std::pair<Shortcut, std::optional<std::string>>> shortcuts;
  std::vector<std::string> settings;
  OutputNames outputs;
  std::string events;             ///< of --events; empty: the default
  std::vector<std::string> show;  ///< of --show
  bool quiet = false;
  frontend::RunMethods methods = frontend::RunMethods::several;
};

/// Adds MODEL, the shortcuts, --set and --quiet to a command.
/// @param arguments  filled when the command line is parsed; must stay where it is
void add_model_options(CLI::App& command, RunArguments& arguments, std::span<const Shortcut> shortcuts);

/// Returns the model with the settings and shortcuts applied.
[[nodiscard]] Expected<frontend::ModelInput> stated_model(const RunArguments& arguments);

/// Adds MODEL, the shortcuts, --set, --out, --report and --quiet to a command.
/// @param arguments  filled when the command line is parsed; must stay where it is
/// @param suffixes   of the files of --out
void add_run_options(CLI::App& command, RunArguments& arguments, std::span<const Shortcut> shortcuts,
                     const std::vector<std::string>& suffixes, const std::string& out_help);

/// Returns whether to show a line of progress on a terminal.
[[nodiscard]] inline ShowProgress progress_of(const RunArguments& arguments) {
  return arguments.quiet ? ShowProgress::never : ShowProgress::when_terminal;
}

/// Writes warnings to standard error, of many the first ones.
void print_warnings(const std::vector<std::string>& warnings);

/// Applies what was typed beside --set, and notes it as settings.
[[nodiscard]] Expected<void> apply_shortcuts(const RunArguments& arguments, frontend::ModelInput& input);

/// Returns the call, without what says where its results go.
[[nodiscard]] std::string call_of(const char* command, const RunArguments& arguments);

using Compute = FunctionRef<Expected<result::Result>(const model::System&, const pipeline::SimulateOptions&,
                                                     const pipeline::Observers&)>;

/// Reads the model, computes, writes the files, prints the table. Ctrl-C asks the observer to stop.
/// @param command  its name
[[nodiscard]] ExitCode run_model(const char* command, const RunArguments& arguments, Compute compute);

}  // namespace saltus::cli
