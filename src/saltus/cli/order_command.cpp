#include <array>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/run_command.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/pipeline/order.hpp"

namespace saltus::cli {
namespace {

struct OrderArguments {
  RunArguments run;
  std::optional<std::string> schemes, steps, reformulation;
};

/// Reads one option; its error gets the option as its place.
template <class Value, class Parse>
Expected<void> read(const char* flag, const std::optional<std::string>& text, Parse parse, Value& value) {
  if (!text) return {};
  auto parsed = parse(*text);
  if (!parsed) {
    parsed.error().location = {fmt::format("{} {}", flag, *text), 0, 0};
    return tl::unexpected(parsed.error());
  }
  value = std::move(*parsed);
  return {};
}

Expected<pipeline::OrderOptions> order_options(const OrderArguments& arguments) {
  pipeline::OrderOptions options;
  const auto word = [](const std::string& text) { return Expected<std::string>(text); };
  return read("--schemes", arguments.schemes, pipeline::parse_schemes, options.schemes)
      .and_then([&] { return read("--steps", arguments.steps, pipeline::parse_steps, options.steps); })
      .and_then([&] { return read("--reformulation", arguments.reformulation, word, options.reformulation); })
      .map([&] { return options; });
}

ExitCode run_order(const OrderArguments& arguments) {
  const auto what = order_options(arguments);
  if (!what) return refuse(what.error());
  return run_model(
      "order", arguments.run,
      [&](const model::System& system, const pipeline::SimulateOptions& options, const pipeline::Observers& observers) {
        return pipeline::order(system, options, *what, observers);
      });
}

}  // namespace

Command add_order(CLI::App& app) {
  auto* command = app.add_subcommand("order", "measure how the errors of schemes fall with the step");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<OrderArguments>();
  add_run_options(*command, arguments->run, std::array{until_shortcut}, {".json"},
                  "write the errors, slopes and the reference run; may repeat");
  command
      ->add_option("--schemes", arguments->schemes,
                   "schemes with their stages (radau_iia:1,radau_iia:2,radau_iia:3,gauss_legendre:2)")
      ->type_name("NAME:STAGES,…");
  command->add_option("--steps", arguments->steps, "numbers of simulation steps (25,50,100,200,400)")
      ->type_name("N,N,…");
  command->add_option("--reformulation", arguments->reformulation, "step or stewart")->type_name("FORM");
  command->footer(
      "Every scheme runs with (fesd) and without (timestepping) switch detection; all else is as in [simulate.fesd] "
      "and\n"
      "[simulate.timestepping]. The reference is the method event with its tightest settings.\n"
      "\nExample:\n  saltus order stick-slip --schemes radau_iia:2,gauss_legendre:2 --steps 100,200,400 "
      "--report order.html");
  return {"order", [arguments] { return run_order(*arguments); }};
}

}  // namespace saltus::cli
