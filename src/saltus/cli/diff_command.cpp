#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/difference_text.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/result/difference.hpp"

namespace saltus::cli {
namespace {

struct DiffArguments {
  std::string a, b;
  result::Tolerances tolerances;
};

ExitCode run_diff(const DiffArguments& arguments) {
  const auto a = io::read_result(arguments.a);
  if (!a) return refuse(a.error());
  const auto b = io::read_result(arguments.b);
  if (!b) return refuse(b.error());
  const auto difference = result::difference(*a, *b, arguments.tolerances);
  if (!difference) return refuse(difference.error());
  print(frontend::difference_text(*difference, arguments.tolerances, a->states.size()));
  return difference->is_none() ? ExitCode::done : ExitCode::different;
}

/// Of a tolerance; CLI11's own check prints the greatest number there is with all its digits.
std::string not_negative(const std::string& typed) {
  const auto value = whole_text_as<double>(typed);
  return value && *value >= 0.0 ? "" : fmt::format("'{}': expected a number that is not negative", typed);
}

}  // namespace

Command add_diff(CLI::App& app) {
  auto* command = app.add_subcommand("diff", "say whether two results of a model are the same, to tolerances");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<DiffArguments>();
  command->add_option("A", arguments->a, "result written by simulate --out A.json")->required();
  command->add_option("B", arguments->b, "another one of the same model")->required();
  command->add_option("--rtol", arguments->tolerances.rtol, "relative tolerance (1e-6)")
      ->type_name("R")
      ->check(not_negative);
  command
      ->add_option("--atol", arguments->tolerances.atol,
                   "absolute tolerance (rtol times the range of each column, and no less than that of the runs)")
      ->type_name("A")
      ->check(not_negative);
  command->footer(
      "Compares end states, events, and states at the times that both have; of output = \"auto\" between them, too. "
      "Exit code 0: the same, 1: different, 2: "
      "results of\ndifferent models, or none.\n"
      "\nExample:\n  saltus simulate stick-slip --out a.json && saltus simulate stick-slip --rtol 1e-10 --out b.json "
      "&& "
      "saltus diff a.json b.json");
  return {"diff", [arguments] { return run_diff(*arguments); }};
}

}  // namespace saltus::cli
