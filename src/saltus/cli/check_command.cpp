#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/same_place.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/progress.hpp"
#include "saltus/cli/text/source_excerpt.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/check_text.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/frontend/optimize_text.hpp"
#include "saltus/frontend/overview_text.hpp"
#include "saltus/frontend/reformulation_text.hpp"
#include "saltus/io/check/json_check.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/mechanics/contacts_at_start.hpp"
#include "saltus/model/summary.hpp"
#include "saltus/model/system.hpp"

namespace saltus::cli {
namespace {

struct CheckArguments {
  std::string model;
  std::vector<std::string> settings;
  bool json = false;
  bool well_posedness = false;
};

/// Every mistake of the file, or the one that is none of the file: of --set, of an option.
std::vector<Error> all_mistakes(const Error& first, const frontend::ModelText& text) {
  auto errors = io::diagnose_model(text.text, text.name).errors;
  const auto is_first = [&](const Error& error) { return same_place(error.location, first.location); };
  if (std::none_of(errors.begin(), errors.end(), is_first)) errors.push_back(first);
  return errors;
}

ExitCode refuse_model(const CheckArguments& arguments, const Error& first, const frontend::ModelText& text) {
  const auto errors = all_mistakes(first, text);
  for (const auto& error : errors) print_error(with_source(error, text));
  if (errors.size() > 1) print_error(fmt::format("{} mistakes", errors.size()));
  if (arguments.json) print(io::check_json(text.path, errors, nullptr, nullptr));
  return ExitCode::bad_input;
}

/// What is for specialists, and takes a simulation.
ExitCode print_well_posedness(const frontend::ModelInput& input, const model::System& system,
                              const io::ModelOverview& overview) {
  ProgressLine progress(ShowProgress::when_terminal);
  const auto text = frontend::inclusion_in_depth(overview) + frontend::reformulation_text(system) +
                    frontend::ranks_text(system, input.file.simulate, watched(progress));
  progress.clear();
  print(text);
  if (!interrupted()) return ExitCode::done;
  print_error("stopped early: stopped_by_user: the ranks are those until then");
  return ExitCode::stopped_early;
}

ExitCode run_check(const CheckArguments& arguments) {
  const auto text = frontend::read_model_text(arguments.model);
  if (!text) return refuse(text.error());
  const auto input = frontend::read_input(*text, arguments.settings);
  if (!input) return refuse_model(arguments, input.error(), *text);
  const auto system = model::build(input->file.description, input->overrides);
  if (!system) return refuse_model(arguments, io::located(system.error(), input->file), *text);
  // Without an end time the file is no mistake: --until gives it.
  if (const auto fit = io::check_options(input->file); !fit && pipeline::end_time(input->file.simulate)) {
    return refuse_model(arguments, fit.error(), *text);
  }
  if (const auto apart = model::check_contacts_at_start(*system, input->file.simulate.from)) {
    return refuse_model(arguments, io::located(*apart, input->file), *text);
  }
  const auto optimization = frontend::optimize_overview(*input);
  if (!optimization) return refuse_model(arguments, optimization.error(), *text);
  auto overview = io::overview_of(input->file.description, model::summary_of(*system), input->file.captions);
  if (arguments.json) {
    overview.forms = frontend::complementarity_forms(*system);
    print(io::check_json(text->path, {}, &overview, *optimization ? &**optimization : nullptr));
    return ExitCode::done;
  }
  print(frontend::check_text(*input, *system, overview, *optimization));
  return arguments.well_posedness ? print_well_posedness(*input, *system, overview) : ExitCode::done;
}

}  // namespace

Command add_check(CLI::App& app) {
  auto* command =
      app.add_subcommand("check", "say what is understood of a model, or all its mistakes; simulates nothing");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<CheckArguments>();
  command
      ->add_option("MODEL", arguments->model,
                   "model file, a name of the catalogue (saltus models), or - for standard input")
      ->required();
  command->add_option("--set", arguments->settings, "change a value before checking, as in simulate")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  command->add_flag("--json", arguments->json, "print it for programs, mistakes included");
  command
      ->add_flag("--well-posedness", arguments->well_posedness,
                 "print the inclusion and the complementarity systems, simulate, and print the ranks of the equations "
                 "for the multipliers")
      ->excludes("--json");
  command->footer("Example:\n  saltus check stick-slip");
  return {"check", [arguments] { return run_check(*arguments); }};
}

}  // namespace saltus::cli
