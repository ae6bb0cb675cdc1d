#include "saltus/cli/run_command.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/docs_page.hpp"
#include "saltus/base/text.hpp"
#include "saltus/base/told_together.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/cli/progress.hpp"
#include "saltus/cli/text/source_excerpt.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/vector_field.hpp"
#include "saltus/report/table.hpp"
#include "saltus/result/cause.hpp"

namespace saltus::cli {
namespace {

/// Names of --show.
Expected<void> check_shown(const RunArguments& arguments, const model::System& system) {
  if (arguments.show.empty()) return {};
  std::vector<std::string> functions;
  for (const auto& column : system.columns) functions.push_back(column.name);
  return report::check_names(arguments.show, system.state_names, system.output_names, functions);
}

/// @param growing  gets rows and events on the way; may be null
Expected<result::Result> compute_all(const RunArguments& arguments, const frontend::ModelInput& input,
                                     const Outputs& outputs, GrowingOutputs* growing, Compute compute) {
  ProgressLine progress(progress_of(arguments));
  auto observers = watched(progress);  // a signal counts from here on, whatever it meets
  const auto preparing = preparation_shown(progress);
  const auto system = model::build(input.file.description, input.overrides);
  progress.clear();
  if (!system) return tl::unexpected(system.error());
  if (auto known = check_shown(arguments, *system); !known) return tl::unexpected(known.error());
  print_warnings(system->warnings);
  bool can_write = true;
  if (growing != nullptr) {
    observers.on_part = [&](const result::Result& part) {
      can_write = growing->add(part) && can_write;
      if (arguments.quiet) return;
      growing->for_each_due_note([&](SizeNote& note, const std::string& file) {
        progress.clear();
        note.grows(file);
      });
    };
    observers.on_step = [&can_write, on_step = std::move(observers.on_step)](const pipeline::StepRecord& step) {
      return can_write ? on_step(step) : pipeline::Proceed::stop;
    };
  }
  auto options = input.file.simulate;
  if (growing != nullptr && growing->only_counts()) pipeline::leave_out_rows(*system, options);
  auto result = compute(*system, options, observers);
  if (!result) return result;
  if (const auto note = frontend::complete_record(input, *result)) print_error(*note);
  if (outputs.show_surfaces()) pipeline::add_drawings(*system, *result);
  return result;
}

/// Says which trajectories stopped early, if any did, and every reason once.
class Stops {
 public:
  /// @param message_shown  whoever reads this has the messages in the same place already
  explicit Stops(bool message_shown) : message_shown_(message_shown) {}
  void look_at(const std::string& who, const result::Status& status) {
    if (is_done(status.termination)) return;
    if (!causes_.insert(std::string(name(status.termination)) + result::cause_of(status.message)).second) {
      ++stopped_;  // for a reason that was told
      return;
    }
    if (message_shown_) {
      tell(fmt::format("{}stopped early: {}", who, name(status.termination)));
      return;
    }
    const bool says_when = status.message.find("t = ") != std::string::npos;
    tell(fmt::format("{}stopped early: {}{}{}{}", who, name(status.termination),
                     says_when ? "" : fmt::format(" at t = {}", status.time_reached),
                     status.message.empty() ? "" : ": ", status.message));
  }
  /// A run of which only this is known.
  void tell(const std::string& message) {
    ++stopped_;
    if (said_ == most_said) return;
    print_error(message);
    ++said_;
  }
  [[nodiscard]] ExitCode exit_code() const {
    if (stopped_ > said_) print_error(fmt::format("and {} more stopped early", stopped_ - said_));
    if (stopped_ > 0) print_error(fmt::format("what each status means, and what helps: {}", docs_page("questions")));
    return stopped_ == 0 ? ExitCode::done : ExitCode::stopped_early;
  }

 private:
  static constexpr std::size_t most_said = 5;
  std::size_t stopped_ = 0;
  std::size_t said_ = 0;
  bool message_shown_ = false;
  std::set<std::string> causes_;
};

/// How many events the table shows at each end.
Expected<std::size_t> shown_events(const std::string& typed) {
  if (typed.empty()) return report::events_at_each_end;
  if (typed == "all") return std::numeric_limits<std::size_t>::max();
  if (const auto count = whole_text_as<std::size_t>(typed)) return *count;
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("--events {}: expected a whole number or all", typed),
                              "--events 3 shows the first and the last 3",
                              {},
                              {}});
}

/// Whether standard output and standard error are one terminal, file or pipe.
bool is_one_stream() {
  struct stat output = {}, errors = {};
  return fstat(STDOUT_FILENO, &output) == 0 && fstat(STDERR_FILENO, &errors) == 0 && output.st_dev == errors.st_dev &&
         output.st_ino == errors.st_ino;
}

/// @param table_shown  with what it says of the status
ExitCode report_stops(const result::Result& result, bool table_shown) {
  Stops stops(table_shown && is_one_stream());
  for (const auto& entry : result::tree(result)) {
    stops.look_at(entry.result == &result ? "" : "branch " + entry.label + " ", entry.result->status);
  }
  if (result.comparison) {
    const auto& runs = result.comparison->runs;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (i != result.comparison->reference && runs[i].reason.empty()) {
        stops.look_at(fmt::format("{} ({}) ", runs[i].method, runs[i].variant), runs[i].status);
      }
    }
  }
  if (result.order) {
    for (const auto& series : result.order->series) {
      for (const auto& point : series.points) {
        if (!point.reason.empty())
          stops.tell(fmt::format("{} {}, {}, {} steps: {}", series.scheme, series.stages, series.method, point.steps,
                                 point.reason));
      }
    }
  }
  return stops.exit_code();
}

}  // namespace

void print_warnings(const std::vector<std::string>& warnings) {
  constexpr std::size_t most = 12;
  const auto told = told_together(warnings);
  for (std::size_t i = 0; i < std::min(most, told.size()); ++i) print_error(fmt::format("warning: {}", told[i]));
  if (told.size() > most) print_error(fmt::format("and {} more warnings: saltus check lists them", told.size() - most));
}

void add_model_options(CLI::App& command, RunArguments& arguments, std::span<const Shortcut> shortcuts) {
  command
      .add_option("MODEL", arguments.model,
                  "model file, a name of the catalogue (saltus models), or - for standard input")
      ->required();
  for (const auto& shortcut : shortcuts) arguments.shortcuts.emplace_back(shortcut, std::nullopt);
  for (auto& [shortcut, value] : arguments.shortcuts) {
    command.add_option(shortcut.flag, value, shortcut.help)->type_name(shortcut.placeholder);
  }
  command
      .add_option("--set", arguments.settings,
                  "change a parameter, an initial value, a constant input or (dotted) any key; may repeat")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  command.add_flag("--quiet", arguments.quiet, "no table, no progress");
}

void add_run_options(CLI::App& command, RunArguments& arguments, std::span<const Shortcut> shortcuts,
                     const std::vector<std::string>& suffixes, const std::string& out_help) {
  add_model_options(command, arguments, shortcuts);
  arguments.outputs.suffixes = suffixes;
  command.add_option("--out", arguments.outputs.files, out_help)
      ->type_name(suffixes.size() == 1 ? "FILE" + suffixes.front() : "FILE")
      ->expected(1)
      ->take_all();
  command.add_option("--format", arguments.outputs.format, "of --out -: json (default), or another suffix of --out")
      ->type_name("FORMAT");
  command.add_option("--report", arguments.outputs.report, "write a page with pictures that works offline")
      ->type_name("FILE.html");
}

Expected<frontend::ModelInput> stated_model(const RunArguments& arguments) {
  auto input = frontend::read_input(arguments.model, arguments.settings);
  if (!input) return input;
  if (auto done = apply_shortcuts(arguments, *input); !done) return tl::unexpected(done.error());
  return input;
}

Expected<void> apply_shortcuts(const RunArguments& arguments, frontend::ModelInput& input) {
  for (const auto& [shortcut, value] : arguments.shortcuts) {
    if (!value) continue;
    const auto typed = fmt::format("{} {}", shortcut.flag, *value);
    if (auto done = frontend::apply_option(input, shortcut.key, *value, typed); !done) return done;
  }
  return {};
}

std::string call_of(const char* command, const RunArguments& arguments) {
  std::vector<std::string> call{command, arguments.model};
  for (const auto& [shortcut, value] : arguments.shortcuts) {
    if (value) call.insert(call.end(), {shortcut.flag, *value});
  }
  for (const auto& setting : arguments.settings) call.insert(call.end(), {"--set", setting});
  return frontend::command_line(call);
}

/// A stored optimum holds its model, and that its first guess of the controls.
void tell_whose_controls(const frontend::ModelInput& input) {
  const auto& description = input.file.description;
  const bool stored = input.path != description.file;
  if (!stored || !input.file.optimize || description.controls.empty()) return;
  if (!description.inputs.empty() || !description.sampled_inputs.empty()) return;
  print_error(
      fmt::format("note: the controls are those of the model; for those that were found add --set "
                  "simulate.inputs.{}.result={}",
                  description.controls.front().name, input.path));
}

ExitCode run_model(const char* command, const RunArguments& arguments, Compute compute) {
  const auto shown = shown_events(arguments.events);
  if (!shown) return refuse(shown.error());
  const auto text = frontend::read_model_text(arguments.model);
  if (!text) return refuse(text.error());
  auto input = frontend::read_input(*text, arguments.settings);
  if (!input) return refuse_with_source(input.error(), *text);
  if (auto done = apply_shortcuts(arguments, *input); !done) return refuse(done.error());
  if (auto fits = io::check_options(input->file); !fits) return refuse_with_source(fits.error(), *text);
  input->call = call_of(command, arguments);
  const auto outputs = Outputs::make(arguments.outputs, input->path);
  if (!outputs) return refuse(outputs.error());

  const bool one_run = arguments.methods == frontend::RunMethods::chosen;
  if (one_run) print_warnings(frontend::options_without_effect(input->file));
  tell_whose_controls(*input);
  auto growing = one_run ? outputs->growing(*shown) : std::nullopt;
  Expected<result::Result> result = tl::unexpected(Error{});
  try {
    result = compute_all(arguments, *input, *outputs, growing ? &*growing : nullptr, compute);
  } catch (const Stopped&) {
    print_error("stopped while the model was prepared: nothing was computed, nothing is written");
    return ExitCode::stopped_early;
  }
  if (!result) return refuse_with_source(io::located(result.error(), input->file), *text);

  const bool has_grown = growing && growing->begun();
  const auto written = has_grown ? outputs->finish(*growing, *result, progress_of(arguments))
                                 : outputs->write(*result, progress_of(arguments));
  if (has_grown) result->events = growing->ends();
  // Also if nothing could be written: it is all that is left.
  const bool table_shown = !arguments.quiet && !outputs->fill_standard_output();
  if (table_shown) print(report::to_table(*result, *shown, arguments.show));
  if (!written) return refuse(written.error());
  if (*written == Written::interrupted) return ExitCode::stopped_early;
  return report_stops(*result, table_shown);
}

}  // namespace saltus::cli
