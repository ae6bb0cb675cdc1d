#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/stopwatch.hpp"
#include "saltus/cli/command_line_internal.hpp"
#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/mpcc_input.hpp"
#include "saltus/cli/outputs.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/foreign/problem.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/mpcc/json_mpcc.hpp"
#include "saltus/pipeline/mpcc/solve_mpcc.hpp"
#include "saltus/pipeline/options/mpcc_options.hpp"
#include "saltus/report/mpcc_table.hpp"

namespace saltus::cli {
namespace {

struct MpccArguments {
  std::string file;
  std::optional<std::string> solver, method, time_limit;
  std::string start;
  std::vector<std::string> settings;
  std::vector<std::string> outputs;
  bool quiet = false;
};

Expected<void> set_setting(solver::SolveOptions& options, const std::string& setting) {
  constexpr std::string_view root = "mpcc.";
  const auto equal = setting.find('=');
  const auto failed = [&](Error error) {
    error.location = {"--set " + setting, 0, 0};
    return tl::unexpected(std::move(error));
  };
  if (equal == std::string::npos || equal == 0 || equal + 1 == setting.size()) {
    return failed(
        {ErrorCode::parse_failure, "expected mpcc.KEY=VALUE", "for example --set mpcc.sigma_factor=0.2", {}, {}});
  }
  const auto key = setting.substr(0, equal);
  if (!key.starts_with(root)) {
    return failed({ErrorCode::unknown_name,
                   fmt::format("'{}' is no option of saltus mpcc", key),
                   "options begin with mpcc., for example mpcc.tolerance",
                   {},
                   {}});
  }
  return set_mpcc_option(options, key.substr(root.size()), setting.substr(equal + 1), "--set " + setting);
}

Expected<solver::SolveOptions> options_of(const MpccArguments& arguments) {
  solver::SolveOptions options;
  for (const auto& setting : arguments.settings) {
    if (auto done = set_setting(options, setting); !done) return tl::unexpected(done.error());
  }
  const auto shortcut = [&](const char* key, const std::string& flag,
                            const std::optional<std::string>& text) -> Expected<void> {
    if (!text) return {};
    return set_mpcc_option(options, key, *text, fmt::format("{} {}", flag, *text));
  };
  if (auto done = shortcut("solver", "--solver", arguments.solver); !done) return tl::unexpected(done.error());
  if (auto done = shortcut("method", "--method", arguments.method); !done) return tl::unexpected(done.error());
  if (auto done = shortcut("time_limit", "--time-limit", arguments.time_limit); !done)
    return tl::unexpected(done.error());
  if (auto fits = pipeline::check_mpcc_options(options); !fits) return tl::unexpected(fits.error());
  return options;
}

/// A line per problem that was solved, where somebody looks.
void show_steps(const MpccArguments& arguments, const foreign::Problem& problem, solver::SolveOptions& options) {
  if (arguments.quiet || ::isatty(STDERR_FILENO) != 1) return;
  options.on_step = [&problem](result::HomotopyStep step) {
    step.objective = problem.in_sense_of_file(step.objective);
    print_error(report::to_line(step));
  };
}

ExitCode finish(const MpccArguments& arguments, const result::MpccResult& result) {
  Expected<void> written;
  bool to_standard_output = false;
  const auto text = arguments.outputs.empty() ? std::string() : io::to_json(result);
  for (const auto& file : arguments.outputs) {
    to_standard_output = to_standard_output || file == "-";
    if (file == "-") {
      print(text);
      continue;
    }
    auto done = io::write_file(file, text);
    if (!done && written) written = std::move(done);
  }
  if (!arguments.quiet && !to_standard_output) print(report::to_table(result));
  if (!written) return refuse(written.error());
  if (is_done(result.status.termination)) return ExitCode::done;
  print_error(fmt::format("stopped early: {}{}{}", name(result.status.termination),
                          result.status.message.empty() ? "" : ": ", result.status.message));
  return ExitCode::stopped_early;
}

ExitCode run_mpcc(const MpccArguments& arguments) {
  auto options = options_of(arguments);
  if (!options) return refuse(options.error());
  const Stopwatch stopwatch;
  const auto input = read_mpcc(arguments.file);
  if (!input) return refuse(input.error());
  auto& problem = *input->problem;
  const auto outputs = Outputs::make({.files = arguments.outputs, .suffixes = {".json"}}, arguments.file);
  if (!outputs) return refuse(outputs.error());
  std::optional<std::vector<double>> start;
  if (!arguments.start.empty()) {
    auto x = io::read_mpcc_start(arguments.start);
    if (!x) return refuse(x.error());
    start = std::move(*x);
  }
  if (!arguments.quiet) {
    for (const auto& note : problem.notes()) print_error(fmt::format("note: {}: {}", arguments.file, note));
  }
  const double building = stopwatch.seconds();

  catch_interrupt();
  options->is_interrupted = interrupted;
  show_steps(arguments, problem, *options);
  auto result = pipeline::solve_mpcc(problem, *options, start);
  if (!result) {
    if (result.error().location.file.empty()) result.error().location.file = arguments.file;
    return refuse(result.error());
  }
  result->file = arguments.file;
  result->sha256 = input->sha256;
  result->statistics.build_seconds = building;
  return finish(arguments, *result);
}

/// Words broken into lines that begin behind a column.
std::string wrapped_words(std::string_view words, std::size_t behind) {
  const std::size_t widest = 110 - behind;
  std::string text;
  std::size_t column = 0;
  while (!words.empty()) {
    const auto end = std::min(words.find(' '), words.size());
    if (column > 0 && column + end > widest) {
      text += "\n" + std::string(behind, ' ');
      column = 0;
    }
    text += fmt::format("{}{}", column > 0 ? " " : "", words.substr(0, end));
    column += end + 1;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return text;
}

std::string keys_help() {
  std::string text = "Keys of --set mpcc.KEY=VALUE:\n";
  for (const auto& field : pipeline::mpcc_fields()) {
    text += fmt::format("  {:<17} {}\n        {}\n", field.key, wrapped_words(expects(field.kind), 20),
                        wrapped_words(field.doc, 8));
  }
  return text;
}

}  // namespace

Command add_mpcc(CLI::App& app) {
  auto* command = app.add_subcommand("mpcc", "solve a problem with complementarities that another program wrote");
  // Shared: the parser fills it after this function has returned, the command reads it.
  auto arguments = std::make_shared<MpccArguments>();
  command->add_option("FILE", arguments->file, "AMPL .nl text, or JSON of NOSBENCH or mpecopt")->required();
  command->add_option("--solver", arguments->solver, "how the relaxed problems are solved (structured, ipopt)")
      ->type_name("NAME");
  command->add_option("--method", arguments->method, "relaxation (scholtes): mpcc.method below")->type_name("NAME");
  command->add_option("--start", arguments->start, "begin at the x of a stored result")->type_name("RESULT.json");
  command->add_option("--time-limit", arguments->time_limit, "seconds")->type_name("S");
  command->add_option("--set", arguments->settings, "change an option of the method; may repeat")
      ->type_name("mpcc.KEY=VALUE")
      ->expected(1)
      ->take_all();
  command->add_option("--out", arguments->outputs, "write the result; may repeat")
      ->type_name("FILE.json")
      ->expected(1)
      ->take_all();
  command->add_flag("--quiet", arguments->quiet, "no table, no progress");
  command->footer(keys_help() +
                  "\nExit code 0: feasible, complementary, stationary and without a first-order descent direction; 3: "
                  "the table\nsays what is missing. The models of the example are in examples/mpcc.\n"
                  "\nExample:\n  saltus mpcc examples/mpcc/corner.nl --out corner.json");
  return {"mpcc", [arguments] { return run_mpcc(*arguments); }};
}

}  // namespace saltus::cli
