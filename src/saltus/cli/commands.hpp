// The subcommands: each adds itself to the command line and is run if it was chosen.
#pragma once

#include <functional>
#include <string>

#include "saltus/cli/exit_code.hpp"

namespace CLI {
class App;
}

namespace saltus::cli {

struct Command {
  std::string name;
  std::function<ExitCode()> run;  ///< once the command line is parsed
  std::string more_help{};        ///< of --help-all, below the help
};

[[nodiscard]] Command add_simulate(CLI::App& app);
[[nodiscard]] Command add_sweep(CLI::App& app);
[[nodiscard]] Command add_optimize(CLI::App& app);
[[nodiscard]] Command add_compare(CLI::App& app);
[[nodiscard]] Command add_order(CLI::App& app);
[[nodiscard]] Command add_check(CLI::App& app);
[[nodiscard]] Command add_mpcc(CLI::App& app);
[[nodiscard]] Command add_models(CLI::App& app);
[[nodiscard]] Command add_report(CLI::App& app);
[[nodiscard]] Command add_diff(CLI::App& app);
[[nodiscard]] Command add_new(CLI::App& app);
[[nodiscard]] Command add_cite(CLI::App& app);
[[nodiscard]] Command add_schema(CLI::App& app);
[[nodiscard]] Command add_completion(CLI::App& app);
/// Is hidden: names of the catalogue, or of a model's values, one a line, for completion; never fails on a broken
/// model.
[[nodiscard]] Command add_complete_names(CLI::App& app);
/// Is hidden: saltus(1) for man.
[[nodiscard]] Command add_man_page(CLI::App& app);
/// Is hidden: prints docs/options.md.
[[nodiscard]] Command add_options_page(CLI::App& app);

}  // namespace saltus::cli
