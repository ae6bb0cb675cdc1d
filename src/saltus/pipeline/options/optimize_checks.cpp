// Options of an optimisation that are fine one by one, against each other and the problem.
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/pipeline/options/mpcc_options.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::pipeline {
namespace {

/// More elements than this fill any memory.
constexpr long most_in_all = 10000000;

OptionProblem misfit(std::string key, std::string message, std::string remedy) {
  return {std::move(key), {ErrorCode::invalid_option, std::move(message), std::move(remedy), {}, {}}};
}

std::optional<OptionProblem> problem_of_grid(const OptimizeOptions& options) {
  const long intervals = options.control_intervals;
  if (intervals < 1) {
    return misfit("control_intervals", "no number of control intervals",
                  "write control_intervals = 20 in [optimize], or give --intervals N on the command line");
  }
  if (intervals > most_in_all) {
    return misfit("control_intervals", fmt::format("control_intervals = {} asks for more than fits", intervals),
                  fmt::format("at most {} elements in all are possible", most_in_all));
  }
  const auto lengths = options.elements.size();
  if (lengths != 1 && lengths != static_cast<std::size_t>(intervals)) {
    return misfit("elements", fmt::format("elements has {} entries, control_intervals is {}", lengths, intervals),
                  "write one number for all intervals, or one per interval");
  }
  long elements = 0;
  for (const long count : options.elements) {
    const long times = lengths == 1 ? intervals : 1;
    if (count > most_in_all / times || elements > most_in_all - count * times) {
      return misfit("elements", "elements asks for more than fits",
                    fmt::format("at most {} elements in all are possible", most_in_all));
    }
    elements += count * times;
  }
  return std::nullopt;
}

std::optional<OptionProblem> problem_of_references(const OptimizeOptions& options,
                                                   const model::OcpDescription& problem) {
  for (const auto& part : problem.least_squares) {
    const auto rows = part.samples.size();
    const bool fits =
        rows == static_cast<std::size_t>(options.control_intervals) || (rows == 1 && part.at == model::CostPoints::end);
    if (rows == 0 || fits || !part.times.empty()) continue;
    auto found = misfit("control_intervals",
                        fmt::format("{} has {} row{}, control_intervals is {}", part.file, rows, rows == 1 ? "" : "s",
                                    options.control_intervals),
                        "references of a file have one row per control interval, for the end of each");
    found.error.location = part.location;
    return found;
  }
  return std::nullopt;
}

std::optional<OptionProblem> problem_of_plant(const OptimizeOptions& options, const model::OcpDescription& problem) {
  if (options.closed_loop.value_or(true) || problem.plant.empty()) return std::nullopt;
  auto found = misfit("closed_loop", "plant is what closed_loop simulates, and closed_loop is false",
                      "write closed_loop = true, or leave plant out");
  found.error.location = problem.plant.front().value->location;
  return found;
}

}  // namespace

std::optional<OptionProblem> find_problem(const OptimizeOptions& options, const model::OcpDescription& problem) {
  if (auto found = problem_of_grid(options)) return found;
  if (auto found = problem_of_references(options, problem)) return found;
  if (auto found = problem_of_plant(options, problem)) return found;
  if (auto fits = check_mpcc_options(options.mpcc); !fits) return OptionProblem{"mpcc.sigma_final", fits.error()};
  return std::nullopt;
}

}  // namespace saltus::pipeline
