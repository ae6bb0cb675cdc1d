#include <array>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/model_input.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/cli/progress.hpp"
#include "saltus/cli/terminal.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/build.hpp"
#include "saltus/pipeline/option_fields.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/surfaces.hpp"
#include "saltus/report/table.hpp"

namespace saltus::cli {
namespace {

/// A flag that is short for --set KEY=VALUE.
struct Shortcut {
  const char* flag;
  const char* key;
  const char* placeholder;
  const char* help;
};
constexpr std::array shortcuts{
    Shortcut{"--until", "simulate.until", "T", "end time"},
    Shortcut{"--method", "simulate.method", "METHOD", "event or smoothed (others come with later versions)"},
    Shortcut{"--rtol", "simulate.rtol", "R", "relative tolerance"},
    Shortcut{"--atol", "simulate.atol", "A", "absolute tolerance"},
    Shortcut{"--integrator", "simulate.event.integrator", "I", "dopri5, dop853 or radau5"},
    Shortcut{"--branch", "simulate.event.branches", "report|all|K",
             "report, all or K: follow other admissible motions, at most K trajectories"},
};

struct Arguments {
  std::string model;
  std::array<std::optional<std::string>, shortcuts.size()> shortcut_values;
  std::vector<std::string> settings;
  std::vector<std::string> outputs;
  std::string report;
  bool quiet = false;
};

Expected<void> apply_shortcuts(const Arguments& arguments, io::ModelFile& file) {
  for (std::size_t i = 0; i < shortcuts.size(); ++i) {
    const auto& value = arguments.shortcut_values[i];
    if (!value) continue;
    auto options = io::with_option(file.simulate, shortcuts[i].key, *value);
    if (!options) {
      options.error().location = {fmt::format("{} {}", shortcuts[i].flag, *value), 0, 0};
      return tl::unexpected(options.error());
    }
    file.simulate = std::move(*options);
  }
  return {};
}

/// What simulate cannot know: the file's fingerprint, and the inputs as they were written.
void complete_record(const ModelInput& input, result::Result& result) {
  result.model.sha256 = input.file.sha256;
  for (const auto& value : input.file.description.inputs) {
    result.options.emplace_back(fmt::format("simulate.inputs.{}", value.name), expression::to_text(*value.expression));
  }
  for (auto& branch : result.branches) complete_record(input, branch);
}

Expected<result::Result> compute(const Arguments& arguments, const ModelInput& input, const Outputs& outputs) {
  const auto system = model::build(input.file.description, input.overrides);
  if (!system) return tl::unexpected(system.error());
  for (const auto& warning : system->warnings) print_error(fmt::format("warning: {}", warning));
  ProgressLine progress(arguments.quiet ? ShowProgress::never : ShowProgress::when_terminal);
  pipeline::Observers observers;
  observers.on_step = [&](const pipeline::StepRecord& step) {
    progress.update(step);
    return interrupted() ? pipeline::Proceed::stop : pipeline::Proceed::on;
  };
  catch_interrupt();
  auto result = pipeline::simulate(*system, input.file.simulate, observers);
  if (!result) return result;
  complete_record(input, *result);
  if (outputs.show_surfaces()) result->surfaces = pipeline::surfaces(*system, *result);
  return result;
}

/// Says which trajectories stopped early, if any did.
ExitCode report_stops(const result::Result& result) {
  constexpr std::size_t most_said = 5;
  const auto tree = result::tree(result);
  std::size_t stopped = 0;
  for (const auto& entry : tree) {
    const auto& status = entry.result->status;
    if (is_done(status.termination) || ++stopped > most_said) continue;
    const bool says_when = status.message.find("t = ") != std::string::npos;
    print_error(fmt::format("{}stopped early: {}{}{}{}", entry.result == &result ? "" : "branch " + entry.label + " ",
                            name(status.termination), says_when ? "" : fmt::format(" at t = {}", status.time_reached),
                            status.message.empty() ? "" : ": ", status.message));
  }
  if (stopped > most_said) print_error(fmt::format("and {} more branches stopped early", stopped - most_said));
  return stopped == 0 ? ExitCode::done : ExitCode::stopped_early;
}

ExitCode run(const Arguments& arguments) {
  auto input = read_input(arguments.model, arguments.settings);
  if (!input) return refuse(input.error());
  if (auto done = apply_shortcuts(arguments, input->file); !done) return refuse(done.error());
  if (auto fits = io::check_options(input->file); !fits) return refuse(fits.error());
  const auto outputs = Outputs::make(arguments.outputs, arguments.report, input->path);
  if (!outputs) return refuse(outputs.error());

  auto result = compute(arguments, *input, *outputs);
  if (!result) return refuse(io::located(result.error(), input->file));

  const auto written = outputs->write(*result);
  if (!arguments.quiet) print(report::to_table(*result));  // also if nothing could be written: it is all that is left
  if (!written) return refuse(written.error());
  return report_stops(*result);
}

std::string footer() {
  return fmt::format(
      "Keys of [simulate], for --set simulate.KEY=VALUE:\n{}\nExample:\n  saltus simulate stick-slip --until 20 "
      "--set belt=0.3 --out stick-slip.json --report stick-slip.html",
      pipeline::options_help());
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto* command = app.add_subcommand("simulate", "simulate a model and show its end state and events");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<Arguments>();
  command->add_option("MODEL", arguments->model, "model file, or a name of the catalogue (saltus models)")->required();
  for (std::size_t i = 0; i < shortcuts.size(); ++i) {
    command->add_option(shortcuts[i].flag, arguments->shortcut_values[i], shortcuts[i].help)
        ->type_name(shortcuts[i].placeholder);
  }
  command
      ->add_option("--set", arguments->settings,
                   "change a parameter, an initial value, a constant input or (dotted) any key; may repeat")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  command->add_option("--out", arguments->outputs, "write the result: .json all of it, .csv the trajectory; may repeat")
      ->type_name("FILE")
      ->expected(1)
      ->take_all();
  command->add_option("--report", arguments->report, "write a page with pictures that works offline")
      ->type_name("FILE.html");
  command->add_flag("--quiet", arguments->quiet, "no table, no progress");
  command->footer(footer());
  return {"simulate", [arguments] { return run(*arguments); }};
}

}  // namespace saltus::cli
