// What the commands that run a model have in common: their options, and the way from there to table and files.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/cli/exit_code.hpp"
#include "saltus/io/toml_model.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace CLI {
class App;
}

namespace saltus::cli {

/// A flag that is short for --set KEY=VALUE.
struct Shortcut {
  const char* flag;
  const char* key;
  const char* placeholder;
  const char* help;
};

/// --until, as every command has it.
inline constexpr Shortcut until_shortcut{"--until", "simulate.until", "T", "end time"};

/// Whether a command runs the method that was chosen, or several.
enum class RunMethods { chosen, several };

/// What was typed behind one of these commands.
struct RunArguments {
  std::string model;
  std::vector<std::pair<Shortcut, std::optional<std::string>>> shortcuts;
  std::vector<std::string> settings;
  std::vector<std::string> outputs;
  std::vector<std::string> output_suffixes;
  std::string report;
  std::string events;  ///< of --events; empty: the default
  bool quiet = false;
  RunMethods methods = RunMethods::several;
};

/// Adds MODEL, the shortcuts, --set, --out, --report and --quiet to a command.
/// @param arguments  filled when the command line is parsed; must stay where it is
/// @param suffixes   of the files of --out
void add_run_options(CLI::App& command, RunArguments& arguments, std::span<const Shortcut> shortcuts,
                     const std::vector<std::string>& suffixes, const std::string& out_help);

using Compute = FunctionRef<Expected<result::Result>(const model::System&, const pipeline::SimulateOptions&,
                                                     const pipeline::Observers&)>;

/// Reads the model, computes, writes the files, prints the table. Ctrl-C asks the observer to stop.
[[nodiscard]] ExitCode run_model(const RunArguments& arguments, Compute compute);

}  // namespace saltus::cli
