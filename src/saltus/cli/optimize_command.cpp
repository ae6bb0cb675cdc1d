#include <array>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>

#include <fmt/format.h>

#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/cli/run_command.hpp"
#include "saltus/cli/text/source_excerpt.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/frontend/optimum_record.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/optimal_control/optimize.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"
#include "saltus/report/mpcc_table.hpp"
#include "saltus/report/table.hpp"

namespace saltus::cli {
namespace {

constexpr std::array optimize_shortcuts{
    Shortcut{"--intervals", "optimize.control_intervals", "N", "number of control intervals"},
    Shortcut{"--solver", "optimize.mpcc.solver", "S", "how the relaxed problems are solved (structured, ipopt)"},
    Shortcut{"--time-limit", "optimize.time_limit", "S", "seconds"},
};

struct OptimizeArguments {
  RunArguments run;
  std::string start;  ///< of --start; empty for none
};

/// The model with what was typed beside --set.
Expected<frontend::ModelInput> set_input(const OptimizeArguments& arguments, const frontend::ModelText& text) {
  auto input = frontend::read_input(text, arguments.run.settings);
  if (!input) return input;
  if (auto done = apply_shortcuts(arguments.run, *input); !done) return tl::unexpected(done.error());
  if (auto fits = io::check_optimize_options(input->file); !fits) return tl::unexpected(fits.error());
  if (!arguments.start.empty()) {
    input->file.optimize->start_result = arguments.start;
    input->settings.push_back(fmt::format("optimize.initial_guess.result={}", arguments.start));
  }
  input->call = call_of("optimize", arguments.run);
  if (!arguments.start.empty())
    input->call += frontend::command_line({"--start", arguments.start}).substr(std::size("saltus") - 1);
  if (auto done = io::read_start_result(input->file); !done) return tl::unexpected(done.error());
  return input;
}

/// Of a model without [optimize] nothing can be set: that is said, whatever was typed.
Expected<frontend::ModelInput> stated_input(const OptimizeArguments& arguments, const frontend::ModelText& text) {
  auto input = set_input(arguments, text);
  if (input) return input;
  const auto file = io::parse_model(text.text, text.name, text.files);
  if (!file || file->optimize) return input;
  return io::check_optimize_options(*file).and_then([&] { return input; });
}

pipeline::OptimizeObservers observers_of(const RunArguments& arguments) {
  catch_interrupt();
  pipeline::OptimizeObservers observers;
  observers.is_interrupted = interrupted;
  observers.on_warning = [](const std::string& warning) { print_error(fmt::format("warning: {}", warning)); };
  if (!arguments.quiet && ::isatty(STDERR_FILENO) == 1) {
    observers.on_step = [](const result::HomotopyStep& step) { print_error(report::to_line(step)); };
  }
  return observers;
}

Expected<result::Result> compute_optimum(const OptimizeArguments& arguments, const frontend::ModelInput& input,
                                         const Outputs& outputs) {
  const auto ocp = model::build_ocp(input.file.description, input.overrides);
  if (!ocp) return tl::unexpected(ocp.error());
  print_warnings(ocp->system.warnings);
  print_warnings(ocp->warnings);
  auto result = pipeline::optimize(*ocp, *input.file.optimize, observers_of(arguments.run));
  if (!result) return result;
  if (const auto note = frontend::complete_optimum(input, *result)) print_error(*note);
  if (outputs.show_surfaces()) frontend::add_surfaces(*ocp, *result);
  return result;
}

ExitCode run_optimize(const OptimizeArguments& arguments) {
  const auto text = frontend::read_model_text(arguments.run.model);
  if (!text) return refuse(text.error());
  const auto input = stated_input(arguments, *text);
  if (!input) return refuse_with_source(input.error(), *text);
  const auto outputs = Outputs::make(arguments.run.outputs, input->path);
  if (!outputs) return refuse(outputs.error());
  const auto result = compute_optimum(arguments, *input, *outputs);
  if (!result) return refuse_with_source(io::located(result.error(), input->file), *text);
  const auto written = outputs->write(*result, progress_of(arguments.run));
  if (!arguments.run.quiet && !outputs->fill_standard_output()) print(report::to_table(*result));
  if (!written) return refuse(written.error());
  if (*written == Written::interrupted) return ExitCode::stopped_early;
  if (is_done(result->status.termination)) return ExitCode::done;
  print_error(fmt::format("stopped early: {}{}{}", name(result->status.termination),
                          result->status.message.empty() ? "" : ": ", result->status.message));
  return ExitCode::stopped_early;
}

std::string optimize_footer() {
  return fmt::format(
      "Keys of [optimize], for --set optimize.KEY=VALUE:\n{}\nExit code 0: feasible, stationary, and confirmed by an "
      "event-driven simulation of every interval; 3: the table\nsays what is missing.\n\nExample:\n  saltus optimize "
      "turbo-car --intervals 10 --out turbo-car.json --report turbo-car.html",
      pipeline::optimize_options_help());
}

}  // namespace

Command add_optimize(CLI::App& app) {
  auto* command = app.add_subcommand("optimize", "find controls that minimise the cost of [optimize], and verify them");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<OptimizeArguments>();
  add_run_options(*command, arguments->run, optimize_shortcuts, {".json", ".csv", ".npz"},
                  "write the result: .json all, .csv trajectory, .events.csv events, .npz for NumPy; may repeat");
  command->add_option("--start", arguments->start, "begin at the solution of a stored result")
      ->type_name("RESULT.json");
  command->footer(optimize_footer());
  return {"optimize", [arguments] { return run_optimize(*arguments); }};
}

}  // namespace saltus::cli
