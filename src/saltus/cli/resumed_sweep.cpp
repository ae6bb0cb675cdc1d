#include <filesystem>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "saltus/cli/commands.hpp"
#include "saltus/cli/interrupt.hpp"
#include "saltus/cli/sweep_command_internal.hpp"
#include "saltus/cli/text/terminal.hpp"
#include "saltus/frontend/sweep_folder.hpp"
#include "saltus/frontend/sweep_share.hpp"
#include "saltus/frontend/sweep_warnings.hpp"

namespace saltus::cli {
namespace {

/// Computes the shares that are missing, until an interruption: of a share that is not complete nothing is written.
Expected<void> fill(frontend::SweepFolder& folder, const StatedSweep& sweep) {
  const auto missing = folder.missing();
  std::size_t all = folder.tally().runs;
  for (const auto& share : missing) all += share.end(folder.runs()) - share.begin(folder.runs());
  std::vector<pipeline::SweepWarning> warnings;
  for (const auto& share : missing) {
    if (interrupted()) break;
    const std::size_t begin = share.begin(folder.runs()), count = share.end(folder.runs()) - begin;
    const auto observers = sweep_observers(sweep.arguments, all, folder.tally().runs);
    auto outcome = simulate_runs(sweep, begin, count, observers);
    if (!outcome) return tl::unexpected(outcome.error());
    std::move(outcome->warnings.begin(), outcome->warnings.end(), std::back_inserter(warnings));
    if (interrupted()) break;
    auto table = frontend::sweep_table(sweep.plan, outcome->runs, sweep.keep, begin);
    table.front().name = frontend::share_heading(share, folder.runs(), sweep.mark, sweep.page);
    if (auto added = folder.add(share, table); !added) return added;
  }
  print_warnings(frontend::told_with_runs(warnings));
  return {};
}

/// The table of text goes from share to share; what else is asked for needs all of it in memory.
Expected<void> write_outputs(const frontend::SweepFolder& folder, const SweepArguments& arguments) {
  const bool is_text = std::filesystem::path(arguments.out).extension() == ".csv";
  if (is_text) {
    if (auto written = folder.write_csv(arguments.out); !written) return written;
  }
  SweepArguments rest = arguments;
  if (is_text) rest.out.clear();
  if (rest.out.empty() && rest.page.empty()) return {};
  const auto whole = frontend::join_shares(folder.files());
  if (!whole) return tl::unexpected(whole.error());
  return write_files(rest, whole->table, whole->page);
}

}  // namespace

ExitCode resume_sweep(const StatedSweep& sweep) {
  const auto& arguments = sweep.arguments;
  const auto task = arguments.task.empty() ? Expected<frontend::Share>(frontend::Share{})
                                           : frontend::parse_share(arguments.task, sweep.plan.runs());
  if (!task) return refuse(task.error());
  auto folder = frontend::SweepFolder::open(arguments.resume, sweep.mark, sweep.plan.runs(), *task);
  if (!folder) return refuse(folder.error());
  if (folder->tally().runs > 0 && !arguments.run.quiet) {
    print(fmt::format("{} of {} runs are there\n", folder->tally().runs, folder->runs()));
  }
  catch_interrupt();
  if (auto filled = fill(*folder, sweep); !filled) return refuse(filled.error());
  const auto& tally = folder->tally();
  if (!folder->missing().empty()) {
    print_error(fmt::format("{} of {} runs are in {}: the same command goes on with the others", tally.runs,
                            folder->runs(), arguments.resume));
    return ExitCode::stopped_early;
  }
  if (auto written = write_outputs(*folder, arguments); !written) return refuse(written.error());
  if (!arguments.run.quiet) {
    const auto& file = !arguments.out.empty()    ? arguments.out
                       : !arguments.page.empty() ? arguments.page
                                                 : arguments.resume;
    print(fmt::format("{} runs: {}{}\n{}\n", tally.runs, counted(tally.statuses), doubts(tally.others, tally.undecided),
                      file));
  }
  if (tally.stopped == 0) return ExitCode::done;
  print_error(fmt::format("{} of {} runs stopped early, the first of them run {}", tally.stopped, tally.runs,
                          tally.first_stopped));
  return ExitCode::stopped_early;
}

}  // namespace saltus::cli
