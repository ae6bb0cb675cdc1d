#include "saltus/report/table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/report/comparison_table_internal.hpp"
#include "saltus/report/end_state_internal.hpp"
#include "saltus/report/optimization_table_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"
#include "saltus/result/turned.hpp"

namespace saltus::report {
namespace {

/// Wider tables of signs than this say less than they hide.
constexpr std::size_t most_signs = 16;

std::string signs(const std::optional<result::Mode>& mode) {
  if (!mode) return "?";
  std::string text;
  for (const int k : *mode) text += k > 0 ? '+' : k < 0 ? '-' : '0';
  return text;
}

/// The modes before and behind an event, one sign per switching function; only the one behind a start.
std::string modes(const result::Event& event) {
  if (!event.mode_before || event.mode_before == event.mode_after) return signs(event.mode_after);
  return fmt::format("{} > {}", signs(event.mode_before), signs(event.mode_after));
}

/// "a > a+b; c": the active modes of every group before and after, once where they stay.
std::string regions(const result::Event& event) {
  std::string text;
  const auto joined = [](const std::vector<std::string>& active) { return fmt::format("{}", fmt::join(active, "+")); };
  for (std::size_t g = 0; event.regions_after && g < event.regions_after->size(); ++g) {
    const auto& after = (*event.regions_after)[g];
    if (g > 0) text += "; ";
    if (event.regions_before && (*event.regions_before)[g] != after) text += joined((*event.regions_before)[g]) + " > ";
    text += joined(after);
  }
  return text;
}

std::string what(const result::Event& event, const result::Result& result) {
  const std::string name = event.name.value_or("");
  std::string text = name;
  if (const auto word = turned(event, result)) text += fmt::format(" {}", *word);
  for (const auto& surface : event.surfaces) {
    if (surface != name) text += (text.empty() ? "" : ", ") + surface;
  }
  return text;
}

/// Of an optimum, one solution that is verified by itself, nobody asks what else is undecided.
std::string remark(const result::Event& event, const result::Result& result) {
  if (!event.unique) return result.optimization ? "" : "uniqueness not decided";
  return *event.unique ? "" : "not unique";
}

/// Of how many kinds how many.
std::string kinds_of(const result::Result& result) {
  auto kinds = result.passed_on ? result.passed_on->kinds : std::map<result::EventKind, std::size_t>{};
  for (std::size_t i = 0; !result.passed_on && i < result.events.size(); ++i) ++kinds[result.events.kind(i)];
  std::vector<std::string> pieces;
  for (const auto& [kind, count] : kinds) pieces.push_back(fmt::format("{} {}", count, name(kind)));
  return fmt::format("{}", fmt::join(pieces, ", "));
}

/// Values of states behind an event.
using ShownStates = std::vector<std::size_t>;

Row event_row(std::size_t number, const result::Event& event, const result::Result& result, const ShownStates& states) {
  const std::size_t columns = result.switching_functions.size();
  const bool with_modes = columns > 0 && columns <= most_signs;
  Row row{fmt::format("{}", number),      fmt::format("{:.12g}", event.t),
          std::string(name(event.kind)),  shortened(what(event, result), 24),
          with_modes ? modes(event) : "", shortened(regions(event), 64),
          remark(event, result)};
  for (const std::size_t state : states) row.push_back(fmt::format("{:.9g}", event.x_after[state] + 0.0));
  return row;
}

std::string event_table(const result::Result& result, std::size_t shown_at_each_end, const ShownStates& states) {
  const auto& events = result.events;
  const std::size_t columns = result.switching_functions.size();
  const std::size_t count_of_all = result.passed_on ? result.passed_on->events : events.size();
  if (count_of_all == 0) return "events      none\n";
  const std::size_t left_out = count_of_all - events.size();  // between the first and the last ones
  const bool all = count_of_all / 2 < shown_at_each_end || count_of_all == 2 * shown_at_each_end;
  std::vector<Row> rows{{"#", "t", "kind", "surfaces", columns > 0 && columns <= most_signs ? "mode" : "",
                         !events.empty() && events.front().regions_after ? "regions" : "", ""}};
  for (const std::size_t state : states) rows.front().push_back(result.states[state]);
  for (std::size_t i = 0; i < events.size(); ++i) {
    const bool first = i < shown_at_each_end;
    if (!all && i == shown_at_each_end) rows.emplace_back(rows.front().size()).front() = "…";
    if (all || first || events.size() - i <= shown_at_each_end) {
      rows.push_back(event_row(first ? i + 1 : i + 1 + left_out, events[i], result, states));
    }
  }
  if (all) return fmt::format("events      {}\n", count_of_all) + aligned(rows);
  if (shown_at_each_end == 0)
    return fmt::format("events      {}\n", count_of_all) + paragraph("of kinds", kinds_of(result));
  return fmt::format("events      {}, the first and the last {}\n", count_of_all, shown_at_each_end) +
         paragraph("of kinds", kinds_of(result)) + aligned(rows);
}

/// The first states, as many as fit.
std::string short_state(const result::Result& result) {
  constexpr std::size_t room = 40;
  std::string text;
  for (std::size_t i = 0; i < result.states.size() && i < result.final.x.size(); ++i) {
    const auto piece = fmt::format("{}{} = {:.6g}", i > 0 ? "  " : "", result.states[i], result.final.x[i]);
    if (i > 0 && width(text) + width(piece) > room) return text + " …";
    text += piece;
  }
  return text;
}

/// One line for every other continuation that was followed, and how many were not.
std::string branch_table(const result::Result& result) {
  constexpr std::size_t most_lines = 64;
  const auto tree = result::tree(result);
  std::size_t left_out = 0;
  for (const auto& entry : tree) left_out += result::not_followed(*entry.result);
  if (tree.size() == 1) {
    if (left_out == 0) return "";
    const auto* how = result.method == "event" ? "--branch all" : "--method event --branch all";
    return paragraph("branches", fmt::format("{} other continuation{} not followed: {} follows them", left_out,
                                             left_out == 1 ? "" : "s", how));
  }
  const std::size_t columns = result.switching_functions.size();
  const bool with_modes = columns > 0 && columns <= most_signs;
  std::vector<Row> rows{{"#", "leaves", "at t", with_modes ? "into" : "", "events", "ends", "with"}};
  for (std::size_t i = 1; i < std::min(tree.size(), most_lines + 1); ++i) {
    const auto& [branch, label, parent] = tree[i];
    const auto event = branch->left_at ? branch->left_at->event + 1 : 0;
    const bool member = branch->left_at && branch->left_at->member;
    const bool begun = !branch->events.empty();
    rows.push_back({label, fmt::format("{}, {}event {}", tree[parent].label, member ? "after " : "", event),
                    begun ? fmt::format("{:.12g}", branch->events.front().t) : "",
                    with_modes && begun ? signs(branch->events.front().mode_after) : "",
                    fmt::format("{}", branch->events.size()),
                    fmt::format("{} at {:.6g}", name(branch->status.termination), branch->status.time_reached),
                    short_state(*branch)});
  }
  if (tree.size() > most_lines + 1) rows.push_back({"…", "", "", "", "", "", ""});
  return fmt::format("branches    {}{}\n", tree.size() - 1,
                     left_out > 0 ? fmt::format(", {} more not followed", left_out) : "") +
         aligned(rows);
}

/// Continua of other solutions, which no list of branches can hold.
std::string family_table(const result::Result& result) {
  constexpr std::size_t most_lines = 16;
  std::vector<std::string> lines;
  std::size_t count = 0;
  for (const auto& [trajectory, label, parent] : result::tree(result)) {
    for (const auto& family : trajectory->families) {
      if (++count > most_lines) continue;
      std::string into = family.to.mode.size() <= most_signs ? signs(family.to.mode) : "another mode";
      for (const auto& active : family.to.regions) into += fmt::format(" {}", fmt::join(active, "+"));
      lines.push_back(family.kind == result::FamilyKind::spiral
                          ? fmt::format("{}, event {}: spirals out with any phase", label, family.event + 1)
                          : fmt::format("{}, after event {}: may leave into {} at any time from {:.12g} to {:.12g}",
                                        label, family.event + 1, into, family.from, family.until));
    }
  }
  if (count > most_lines) lines.push_back(fmt::format("… and {} more", count - most_lines));
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += paragraph(i == 0 ? "families" : "", lines[i]);
  return text;
}

/// "dopri5 120 steps over 0.4, radau9 35 steps over 9.6", in units of t.
std::string integrators_text(const result::Statistics& statistics) {
  std::vector<std::string> parts;
  for (const auto& use : statistics.integrators)
    parts.push_back(fmt::format("{} {} steps over {:.4g}", use.name, use.steps, use.time));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The largest errors, and from where on there are none.
std::string estimate_text(const result::Result& result, const result::ErrorEstimate& estimate) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(estimate.final.size(), result.states.size()); ++i) {
    if (std::isfinite(estimate.final[i]))
      parts.push_back(fmt::format("{} {:.2g}", result.states[i], estimate.final[i]));
  }
  constexpr std::size_t most = 6;
  if (parts.size() > most) parts.resize(most);
  const auto& times = estimate.event_times;
  const double latest = times.empty() ? 0.0 : *std::max_element(times.begin(), times.end());
  std::string text = fmt::format("about, at the end: {}; of event times: {:.2g}", fmt::join(parts, ", "), latest);
  if (estimate.parted_at) {
    text += fmt::format("; event {} is another one at smaller tolerances: from there on nothing is known",
                        *estimate.parted_at + 1);
  }
  return text;
}

std::string method_text(const result::Result& result) {
  if (result.optimization) return optimization_method(result);
  const auto value_of = [&](std::string_view key, std::string_view form) -> std::string {
    for (const auto& [name, value] : result.options) {
      if (name != key) continue;
      if (const auto* word = std::get_if<std::string>(&value)) return *word;
      if (const auto* number = std::get_if<double>(&value)) return fmt::format(fmt::runtime(form), *number);
      if (const auto* count = std::get_if<std::int64_t>(&value)) return fmt::format(fmt::runtime(form), *count);
    }
    return "";
  };
  const bool smoothed = result.method == "smoothed";
  std::vector<std::string> details{smoothed ? value_of("simulate.smoothed.epsilon", "epsilon {:g}") : "",
                                   smoothed ? "radau5" : value_of("simulate.event.integrator", ""),
                                   value_of("simulate.rtol", "rtol {:g}"), value_of("simulate.atol", "atol {:g}")};
  if (result.method == "fesd" || result.method == "timestepping") {
    const auto key = fmt::format("simulate.{}.", result.method);
    details = {value_of(key + "scheme", ""), value_of(key + "stages", "{} stages"),
               value_of(key + "steps", "{} steps")};
  }
  std::erase(details, "");
  return details.empty() ? result.method : fmt::format("{} ({})", result.method, fmt::join(details, ", "));
}

}  // namespace

std::string to_table(const result::Result& result, std::size_t shown_events, const std::vector<std::string>& names) {
  std::string text = paragraph("model", result.model.description.empty()
                                            ? result.model.name
                                            : fmt::format("{}: {}", result.model.name, result.model.description));
  if (result.comparison) return text + comparison_table(result, *result.comparison);
  if (result.order) return text + order_table(result, *result.order);
  text += paragraph("method", method_text(result));
  // The message mostly says when, with all digits; an optimisation has no time at which it stops.
  const bool says_when = !is_done(result.status.termination) && result.status.message.find("t = ") != std::string::npos;
  const auto termination = std::string(name(result.status.termination));
  text += paragraph("status", says_when || result.optimization
                                  ? termination
                                  : fmt::format("{} at t = {:.12g}", termination, result.status.time_reached));
  if (!result.status.message.empty()) text += paragraph("", result.status.message);
  if (result.optimization) text += objective_table(*result.optimization);
  text += end_state(result, names);
  if (result.optimization) text += findings_table(result, *result.optimization);
  constexpr double rounding = 1e-12;
  if (result.penetration.value_or(0.0) > rounding) {
    text += paragraph("contacts", fmt::format("bodies are at most {:.2g} deep in each other", *result.penetration));
  }
  if (result.sensitivities) text += sensitivity_table(result, *result.sensitivities);
  // Values beside events: as many columns as a terminal has room for.
  constexpr std::size_t most_states = 4;
  ShownStates states = names.empty() ? ShownStates{} : shown_states(result, names);
  if (states.size() > most_states) states.clear();
  text += event_table(result, shown_events, states);
  text += branch_table(result);
  text += family_table(result);
  if (result.optimization) return text + optimization_statistics(*result.optimization);
  const auto& statistics = result.statistics;
  text += paragraph("statistics", fmt::format("{} steps, {} rejected, {} evaluations of the right-hand side, {:.3g} s",
                                              statistics.steps, statistics.rejected, statistics.rhs_evaluations,
                                              statistics.wall_seconds));
  if (!statistics.integrators.empty()) text += paragraph("integrator", integrators_text(statistics));
  if (result.error_estimate) text += paragraph("errors", estimate_text(result, *result.error_estimate));
  if (statistics.thinned_from) {
    text += paragraph("rows", fmt::format("those between events are thinned from t = {} on, as there are very many; "
                                          "output = \"steps\" has those of all steps",
                                          *statistics.thinned_from));
  }
  return text;
}

}  // namespace saltus::report
