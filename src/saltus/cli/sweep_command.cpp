#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/sweep_command_internal.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/sweep_input.hpp"
#include "saltus/frontend/sweep_page.hpp"
#include "saltus/frontend/sweep_share.hpp"
#include "saltus/frontend/sweep_table.hpp"
#include "saltus/frontend/sweep_warnings.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/pipeline/options/stated_run.hpp"

namespace saltus::cli {
namespace {

using pipeline::Keep;

Expected<Keep> keep_named(const std::string& word) {
  const std::map<std::string, Keep> known{
      {"final", Keep::final}, {"events", Keep::events}, {"trajectory", Keep::trajectory}};
  if (const auto found = known.find(word); found != known.end()) return found->second;
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("--keep {}: expected final, events or trajectory", word),
                              suggest_word(word, {"final", "events", "trajectory"}),
                              {},
                              {}});
}

Expected<std::size_t> jobs_of(std::optional<long> jobs) {
  if (!jobs) return std::max(1U, std::thread::hardware_concurrency());
  if (*jobs >= 1 && *jobs <= 4096) return static_cast<std::size_t>(*jobs);
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("--jobs {}: expected a number of threads, 1 to 4096", *jobs),
                              "without it there are as many as processors",
                              {},
                              {}});
}

Error misuse(std::string message, std::string remedy) {
  return {ErrorCode::invalid_option, std::move(message), std::move(remedy), {}, {}};
}

Expected<void> check_output(const SweepArguments& arguments, const std::string& input) {
  const bool has_folder = !arguments.resume.empty();
  if (has_folder && !arguments.task.empty() && !(arguments.out.empty() && arguments.page.empty())) {
    return tl::unexpected(misuse("--task with --resume fills a part of the folder, and writes no table",
                                 "write --out and --report by the same command without --task, at the end"));
  }
  if (arguments.out.empty() && !has_folder && (arguments.page.empty() || !arguments.task.empty())) {
    return tl::unexpected(misuse("--out is missing", "add --out table.csv, --report page.html, or --resume FOLDER"));
  }
  if (!arguments.page.empty()) {
    if (!arguments.task.empty()) {
      return tl::unexpected(
          misuse("--report of a share", "the page shows all shares: sweep --join … --report page.html"));
    }
    if (!arguments.page.ends_with(".html")) {
      return tl::unexpected(misuse(fmt::format("--report {}: the name must end in .html", arguments.page), ""));
    }
    if (auto writable = io::check_writable(arguments.page); !writable) return writable;
  }
  if (arguments.out.empty()) return {};
  if (!arguments.task.empty() && !arguments.out.ends_with(".csv")) {
    return tl::unexpected(misuse(fmt::format("--out {}: the share of a task is written as .csv", arguments.out),
                                 "sweep --join makes one table of all, .csv or .npz"));
  }
  const auto suffix = std::filesystem::path(arguments.out).extension();
  if (suffix != ".csv" && suffix != ".npz") {
    return tl::unexpected(Error{ErrorCode::io_failure,
                                fmt::format("--out {}: the name must end in .csv or .npz", arguments.out),
                                "the suffix says what is written",
                                {},
                                {}});
  }
  std::error_code unknown;
  if (std::filesystem::equivalent(arguments.out, input, unknown)) {
    return tl::unexpected(
        Error{ErrorCode::io_failure, fmt::format("--out {}: this file is the input", arguments.out), "", {}, {}});
  }
  return io::check_writable(arguments.out);
}

Expected<void> write_table(const std::string& file, const std::vector<frontend::TableColumn>& table) {
  if (std::filesystem::path(file).extension() == ".csv") return io::write_file(file, frontend::to_csv(table));
  return io::stream_file(file, [&](io::Sink sink) { return frontend::write_npz(table, sink); });
}

/// "98 completed, 2 iteration_limit"
std::string statuses(const std::vector<pipeline::SweepRun>& runs) {
  std::map<std::string, std::size_t> counts;
  for (const auto& run : runs) ++counts[std::string(result::name(run.result.status.termination))];
  return counted(counts);
}

/// Of a table with a column of that: how many runs are in doubt.
std::string doubts_of(const std::vector<frontend::TableColumn>& table) {
  const auto unique =
      std::find_if(table.begin(), table.end(), [](const auto& column) { return column.name == "unique"; });
  if (unique == table.end()) return "";  // joined shares of an older version
  const auto& runs = std::get<std::vector<double>>(table.front().values);
  const auto& values = std::get<std::vector<double>>(unique->values);
  std::size_t others = 0, undecided = 0;
  for (std::size_t row = 0; row < runs.size(); ++row) {
    if (row > 0 && runs[row] == runs[row - 1]) continue;
    if (values[row] == 0.0) ++others;
    if (values[row] < 0.0) ++undecided;
  }
  return doubts(others, undecided);
}

ExitCode report_stopped_runs(const std::vector<pipeline::SweepRun>& runs, std::size_t asked) {
  if (runs.size() < asked) print_error(fmt::format("{} of {} runs began: the others have no rows", runs.size(), asked));
  const auto stopped = [](const auto& run) { return !is_done(run.result.status.termination); };
  const auto first = std::find_if(runs.begin(), runs.end(), stopped);
  if (first == runs.end()) return runs.size() < asked ? ExitCode::stopped_early : ExitCode::done;
  const auto& status = first->result.status;
  print_error(fmt::format("{} of {} runs stopped early; run {}: {}{}{}",
                          std::count_if(runs.begin(), runs.end(), stopped), runs.size(), first - runs.begin() + 1,
                          name(status.termination), status.message.empty() ? "" : ": ", status.message));
  return ExitCode::stopped_early;
}

Expected<frontend::SweepRequest> request_of(const SweepArguments& arguments) {
  auto request = arguments.request;
  if (!arguments.seed) return request;
  if (*arguments.seed < 0) {
    return tl::unexpected(
        misuse(fmt::format("--seed {}: expected a number from 0 on", *arguments.seed), "e.g. --seed 1"));
  }
  request.seed = static_cast<std::uint64_t>(*arguments.seed);
  return request;
}

/// Whether what the sweep changes is not set, too.
Expected<void> check_settings(const std::vector<std::string>& settings, const frontend::SweepPlan& plan) {
  for (const auto& setting : settings) {
    const auto name = setting.substr(0, setting.find('='));
    if (!contains(plan.names(), name)) continue;
    return tl::unexpected(
        misuse(fmt::format("--set {}: '{}' is changed twice", setting, name), "give its values once"));
  }
  return {};
}

/// The first run, where all of what was typed makes sense: values are looked at before files.
Expected<frontend::ModelInput> first_run(const SweepArguments& arguments, const frontend::ModelInput& model,
                                         const frontend::SweepPlan& plan) {
  if (auto once = check_settings(arguments.run.settings, plan); !once) return tl::unexpected(once.error());
  auto first = frontend::input_of_run(model, plan, 0);
  if (!first) return first;
  if (auto one = frontend::check_branches(*first, plan); !one) return tl::unexpected(one.error());
  if (auto writable = check_output(arguments, model.path); !writable) {
    const auto stated = frontend::state_run(model, plan, 0);
    return tl::unexpected(stated ? writable.error() : stated.error());
  }
  return first;
}

ExitCode run_sweep(const SweepArguments& arguments) {
  if (arguments.run.model.empty()) return refuse(misuse("MODEL is missing", "see: saltus help sweep"));
  const auto stated = request_of(arguments);
  if (!stated) return refuse(stated.error());
  const auto& request = *stated;
  const auto plan = frontend::SweepPlan::make(request);
  if (!plan) return refuse(plan.error());
  const auto keep = keep_named(arguments.keep);
  if (!keep) return refuse(keep.error());
  const auto jobs = jobs_of(arguments.jobs);
  if (!jobs) return refuse(jobs.error());
  const auto model = stated_model(arguments.run);
  if (!model) return refuse(model.error());
  const auto first = first_run(arguments, *model, *plan);
  if (!first) return refuse(first.error());
  print_warnings(frontend::options_without_effect(first->file));

  const bool grid = !request.paired && request.samples.empty();
  const frontend::SweepPage page{model->file.description.name, call_of("simulate", arguments.run), plan->names(), grid,
                                 model->file.captions};
  const auto mark = frontend::sweep_mark(*model, request, arguments.keep);
  const StatedSweep sweep{arguments, *model, *plan, *keep, *jobs, page, mark};
  if (!arguments.resume.empty()) return resume_sweep(sweep);
  const auto share = arguments.task.empty() ? Expected<frontend::Share>(frontend::Share{})
                                            : frontend::parse_share(arguments.task, plan->runs());
  if (!share) return refuse(share.error());
  const std::size_t begin = share->begin(plan->runs()), count = share->end(plan->runs()) - begin;
  catch_interrupt();
  const auto observers = sweep_observers(arguments, count);
  const auto outcome = simulate_runs(sweep, begin, count, observers);
  if (!outcome) return refuse(outcome.error());
  print_warnings(frontend::told_with_runs(outcome->warnings));
  const auto& runs = outcome->runs;
  auto table = frontend::sweep_table(*plan, runs, *keep, begin);
  if (!arguments.task.empty()) table.front().name = frontend::share_heading(*share, plan->runs(), mark, page);
  if (auto written = write_files(arguments, table, page); !written) return refuse(written.error());
  if (!arguments.run.quiet) {
    print(fmt::format("{} runs: {}{}\n{}\n", runs.size(), statuses(runs), doubts_of(table),
                      arguments.out.empty() ? arguments.page : arguments.out));
  }
  return report_stopped_runs(runs, count);
}

/// What MODEL and the files behind it are with --join: all are shares.
ExitCode run_join(const SweepArguments& arguments) {
  if (!arguments.run.model.empty() || !arguments.request.over.empty() || !arguments.request.samples.empty() ||
      !arguments.task.empty() || !arguments.resume.empty()) {
    return refuse(
        misuse("--join takes the tables of shares, and no model", "saltus sweep --join 1.csv 2.csv --out all.csv"));
  }
  if (auto writable = check_output(arguments, ""); !writable) return refuse(writable.error());
  const auto whole = frontend::join_shares(arguments.join);
  if (!whole) return refuse(whole.error());
  if (auto written = write_files(arguments, whole->table, whole->page); !written) return refuse(written.error());
  if (!arguments.run.quiet) {
    print(fmt::format("{} shares, {} rows{}\n{}\n", arguments.join.size(), frontend::rows_of(whole->table.front()),
                      doubts_of(whole->table), arguments.out.empty() ? arguments.page : arguments.out));
  }
  return ExitCode::done;
}

}  // namespace

Expected<void> write_files(const SweepArguments& arguments, const std::vector<frontend::TableColumn>& table,
                           const frontend::SweepPage& page) {
  if (!arguments.out.empty()) {
    if (auto written = write_table(arguments.out, table); !written) return written;
  }
  if (arguments.page.empty()) return {};
  return io::write_file(arguments.page, frontend::sweep_page(table, page));
}

std::string counted(const std::map<std::string, std::size_t>& statuses) {
  std::vector<std::string> parts;
  for (const auto& [status, count] : statuses) parts.push_back(fmt::format("{} {}", count, status));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string doubts(std::size_t others, std::size_t undecided) {
  std::vector<std::string> parts;
  if (others > 0) parts.push_back(fmt::format("{} not unique", others));
  if (undecided > 0) parts.push_back(fmt::format("uniqueness of {} not decided", undecided));
  return parts.empty() ? "" : fmt::format("; {}", fmt::join(parts, ", "));
}

pipeline::SweepObservers sweep_observers(const SweepArguments& arguments, std::size_t all, std::size_t before) {
  pipeline::SweepObservers observers;
  observers.is_interrupted = interrupted;
  if (arguments.run.quiet || ::isatty(STDERR_FILENO) != 1) return observers;
  observers.on_run = [all, before, every = std::max<std::size_t>(1, all / 200)](std::size_t count) {
    const std::size_t done = before + count;
    if (done % every == 0) fmt::print(stderr, "\r{} of {} runs", done, all);
    if (done == all) fmt::print(stderr, "\r{:40}\r", "");
  };
  return observers;
}

Expected<pipeline::SweepOutcome> simulate_runs(const StatedSweep& sweep, std::size_t begin, std::size_t count,
                                               const pipeline::SweepObservers& observers) {
  const auto state = [&](std::size_t run) { return frontend::state_run(sweep.model, sweep.plan, begin + run); };
  auto outcome = pipeline::sweep({count, sweep.keep, sweep.jobs, begin}, state, observers);
  if (!outcome) return tl::unexpected(io::located(outcome.error(), sweep.model.file));
  return outcome;
}

Command add_sweep(CLI::App& app) {
  auto* command = app.add_subcommand("sweep", "simulate a model with many values and write one table");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<SweepArguments>();
  add_model_options(*command, arguments->run, simulate_shortcuts);
  const auto several = [&](const char* flag, std::vector<std::string>& values, const char* help, const char* type) {
    command->add_option(flag, values, help)->type_name(type)->expected(1)->take_all();
  };
  auto& request = arguments->request;
  several("--over", request.over, "values of a parameter, an initial value or an option; several make a grid",
          "NAME=FROM:TO:NUMBER|V1,V2,…");
  command->add_flag("--zip", request.paired, "values one by one instead of a grid");
  several("--sample", request.samples, "random values: normal(m,s), uniform(a,b), lognormal(m,s)", "NAME=DISTRIBUTION");
  command->add_option("--runs", request.runs, "samples (of every point of the grid)")->type_name("N");
  command->add_option("--seed", arguments->seed, "of the random numbers (1)")->type_name("N");
  command->add_flag("--yes", request.confirmed, fmt::format("also more than {} runs", frontend::unconfirmed_runs));
  command->add_option("--keep", arguments->keep, "a row for every run, for every event, or for every time (final)")
      ->type_name("final|events|trajectory");
  command->add_option("--jobs", arguments->jobs, "threads (as many as processors); the table does not depend on it")
      ->type_name("N");
  command->add_option("--out", arguments->out, "the table")->type_name("FILE.csv|.npz");
  command->add_option("--report", arguments->page, "a page with pictures of the table, which works offline")
      ->type_name("FILE.html");
  command
      ->add_option("--resume", arguments->resume,
                   "a folder that is filled share by share; what is there is not computed again")
      ->type_name("FOLDER");
  command
      ->add_option("--task", arguments->task,
                   "only share I of N, for several machines: of the table (.csv), or of the folder of --resume")
      ->type_name("I/N");
  command->add_option("--join", arguments->join, "the tables of all shares, which become one; no MODEL then")
      ->type_name("FILE.csv …");
  command->get_option("MODEL")->required(false);
  command->get_option("--branch")->group("");  // not in the help: it is refused, with the reason
  command->footer("Example:\n  saltus sweep stick-slip --over belt=0.05:0.3:100 --over v=-0.1,0,0.1 --out belt.csv");
  return {"sweep", [arguments] { return arguments->join.empty() ? run_sweep(*arguments) : run_join(*arguments); }};
}

}  // namespace saltus::cli
