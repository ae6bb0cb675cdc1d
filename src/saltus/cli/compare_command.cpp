#include <array>
#include <memory>

#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/run_command.hpp"
#include "saltus/pipeline/compare.hpp"

namespace saltus::cli {
namespace {

constexpr std::array compare_shortcuts{
    until_shortcut,
    Shortcut{"--rtol", "simulate.rtol", "R", "relative tolerance of all but the reference"},
    Shortcut{"--atol", "simulate.atol", "A", "absolute tolerance of all but the reference"},
};

}  // namespace

Command add_compare(CLI::App& app) {
  auto* command = app.add_subcommand("compare", "simulate a model with every method and show where they agree");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<RunArguments>();
  add_run_options(*command, *arguments, compare_shortcuts, {".json"},
                  "write the comparison and the reference run; may repeat");
  command->footer(
      "The reference is the method event with its tightest settings. What a method cannot do is told below the table.\n"
      "\nExample:\n  saltus compare stick-slip --until 10 --out stick-slip.json --report stick-slip.html");
  return {"compare", [arguments] { return run_model("compare", *arguments, pipeline::compare); }};
}

}  // namespace saltus::cli
