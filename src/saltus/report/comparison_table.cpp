#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/report/comparison_table_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"
#include "saltus/result/cause.hpp"

namespace saltus::report {
namespace {

/// Components of the end state that fit into a row.
constexpr std::size_t states_of_row = 3;

template <class Value>
std::string or_dash(const std::optional<Value>& value, fmt::string_view form) {
  return value ? fmt::format(fmt::runtime(form), *value) : "–";
}

std::string difference(const std::optional<double>& value) { return or_dash(value, "{:.1e}"); }

std::string seconds(double value) { return fmt::format("{:.3g}", value); }

Row run_row(const result::ComparedRun& run, bool is_reference, std::size_t states) {
  Row row{run.method, run.variant};
  for (std::size_t i = 0; i < states; ++i) {
    row.push_back(i < run.x.size() ? fmt::format("{:.10g}", run.x[i]) : "–");
  }
  row.push_back(or_dash(run.switches, "{}"));
  row.push_back(or_dash(run.last_switch, "{:.10g}"));
  row.push_back(is_reference ? "reference" : difference(run.state_difference));
  row.push_back(is_reference ? "" : difference(run.switch_time_difference));
  row.push_back(seconds(run.statistics.wall_seconds));
  return row;
}

std::string of_run(const result::ComparedRun& run) {
  return run.variant.empty() ? run.method : fmt::format("{} ({})", run.method, run.variant);
}

/// Runs that stopped early for one reason.
struct Stop {
  std::string cause;
  result::Status status;  ///< of the first of them
  std::vector<std::string> runs;
};

void note_stop(const result::ComparedRun& run, std::vector<Stop>& stops) {
  const auto cause = std::string(name(run.status.termination)) + result::cause_of(run.status.message);
  const auto same = [&](const Stop& stop) { return stop.cause == cause; };
  auto stop = std::find_if(stops.begin(), stops.end(), same);
  if (stop == stops.end()) stop = stops.insert(stops.end(), {cause, run.status, {}});
  stop->runs.push_back(of_run(run));
}

/// @param what  what that means for the table
std::string not_unique(const result::Result& reference, std::string_view what) {
  const auto& events = reference.events;
  const auto ambiguous = [](const result::Event& event) { return event.unique == false; };
  const auto found = std::find_if(events.begin(), events.end(), ambiguous);
  if (found == events.end()) return "";
  return paragraph("not unique",
                   fmt::format("the solution has other continuations at t = {:.12g}: {}", found->t, what));
}

/// When the states were compared, in words.
std::string compared_states(const result::Result& result, const result::Comparison& comparison) {
  if (!comparison.time) return "no states, as runs stopped at their start";
  const auto early = [](const result::ComparedRun& run) {
    return run.reason.empty() && !is_done(run.status.termination);
  };
  const bool stopped = std::any_of(comparison.runs.begin(), comparison.runs.end(), early);
  return stopped && *comparison.time < result.final.t
             ? fmt::format("states at t = {:.12g}, the last time that the runs have in common", *comparison.time)
             : fmt::format("end states at t = {:.12g}", *comparison.time);
}

}  // namespace

std::string comparison_table(const result::Result& result, const result::Comparison& comparison) {
  const std::size_t states = std::min(states_of_row, result.states.size());
  Row head{"method", ""};
  head.insert(head.end(), result.states.begin(), result.states.begin() + static_cast<std::ptrdiff_t>(states));
  for (const auto* title : {"switches", "last at t", "state differs by", "switches by", "seconds"}) {
    head.emplace_back(title);
  }
  std::vector<Row> rows{head};
  std::string remarks, stops, refusals;
  std::vector<Stop> stopped;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const auto& run = comparison.runs[i];
    if (!run.reason.empty()) {
      refusals += paragraph("", fmt::format("{}: {}", of_run(run), run.reason));
      continue;
    }
    rows.push_back(run_row(run, i == comparison.reference, states));
    if (is_done(run.status.termination)) {
      if (run.status.termination == result::Termination::completed && !run.status.message.empty())
        remarks += paragraph("", fmt::format("{}: {}", of_run(run), run.status.message));
      continue;
    }
    note_stop(run, stopped);
  }
  for (const auto& stop : stopped) {
    stops += paragraph(
        "", fmt::format("{}: {} at t = {:.12g}{}: {}", fmt::join(stop.runs, ", "), name(stop.status.termination),
                        stop.status.time_reached, stop.runs.size() > 1 ? " (the first)" : "", stop.status.message));
  }
  std::string text =
      paragraph("compared", fmt::format("{}{}, and the times of switches", compared_states(result, comparison),
                                        states < result.states.size() ? ", the first components" : ""));
  text += aligned(rows);
  text += not_unique(result, "there methods may differ and both be right");
  if (!remarks.empty()) text += "remarks\n" + remarks;
  if (!stops.empty()) text += "stopped early\n" + stops;
  if (!refusals.empty()) text += "not run\n" + refusals;
  return text;
}

std::string sensitivity_table(const result::Result& result, const result::Sensitivities& sensitivities) {
  constexpr std::size_t most = 8;
  const std::size_t states = std::min(most, result.states.size());
  const std::size_t parameters = std::min(most, sensitivities.parameters.size());
  Row head{"d / d"};
  for (std::size_t j = 0; j < states; ++j) head.push_back(result.states[j] + "(0)");
  for (std::size_t j = 0; j < parameters; ++j) head.push_back(sensitivities.parameters[j]);
  std::vector<Row> rows{head};
  const auto number = [](double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : "–"; };
  for (std::size_t i = 0; i < states; ++i) {
    Row row{result.states[i]};
    for (std::size_t j = 0; j < states; ++j) row.push_back(number(sensitivities.x0[i][j]));
    for (std::size_t j = 0; j < parameters; ++j) row.push_back(number(sensitivities.p[i][j]));
    rows.push_back(std::move(row));
  }
  return "sensitivities of the end state\n" + aligned(rows);
}

std::string order_table(const result::Result& result, const result::OrderStudy& order) {
  std::string text = paragraph(
      "order", fmt::format("error of the state at t = {:.12g} over the mean step, against {}; slopes of errors above "
                           "{:.1e}",
                           result.final.t, order.reference, order.floor));
  std::vector<double> steps;
  for (const auto& series : order.series) {
    for (const auto& point : series.points) {
      if (!contains(steps, point.mean_step)) steps.push_back(point.mean_step);
    }
  }
  Row head{"scheme", "", "", "step"};
  for (const double step : steps) head.push_back(fmt::format("{:.3g}", step));
  head.emplace_back("slope");
  head.emplace_back("of switches");
  std::vector<Row> rows{head};
  std::string refusals;
  for (const auto& series : order.series) {
    Row row{fmt::format("{} {}", series.scheme, series.stages), series.method, series.reformulation, ""};
    for (const double step : steps) {
      const auto same = [&](const result::OrderPoint& point) { return point.mean_step == step; };
      const auto point = std::find_if(series.points.begin(), series.points.end(), same);
      row.push_back(point == series.points.end() ? "" : difference(point->error));
      if (point == series.points.end() || point->reason.empty()) continue;
      refusals += paragraph("", fmt::format("{} {}, {}, step {:.3g}: {}", series.scheme, series.stages, series.method,
                                            step, point->reason));
    }
    row.push_back(or_dash(series.slope, "{:.2f}"));
    row.push_back(or_dash(series.switch_time_slope, "{:.2f}"));
    rows.push_back(std::move(row));
  }
  text += aligned(rows);
  text += not_unique(result, "a scheme that follows another one has errors and slopes that say nothing");
  if (!refusals.empty()) text += "no error\n" + refusals;
  return text;
}

}  // namespace saltus::report
