#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/run/diagnosis_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

struct PlaceOfEntry {
  std::size_t row, column;
};

/// The first entry by columns that is as asked.
template <class Test>
std::optional<PlaceOfEntry> first_entry(const discretization::EntryPattern& pattern, const std::vector<double>& values,
                                        const Test& is_asked) {
  std::optional<PlaceOfEntry> first;
  for (std::size_t column = 0; column < at(pattern.columns) && !first; ++column) {
    visit_column(pattern, values, column, [&](std::size_t row, double value) {
      if (!first && is_asked(value)) first = PlaceOfEntry{row, column};
    });
  }
  return first;
}

}  // namespace

std::string coarse_message(const Facts& facts, const Coarseness::Worst& worst) {
  return fmt::format(
      "the elements are coarse: their estimated errors add up to {:.2g} of the largest |{}|, of the element at t = "
      "{:.6g} alone {:.2g}; take more simulate.fesd.steps",
      worst.sum, facts.state_names[worst.state], worst.t, worst.error);
}

std::optional<std::string> steep_derivative(RunContext& context, const Position& position, double nominal) {
  context.kernel.evaluate(position.t(), position.x().data(), position.selections().data(), context.held.data(),
                          context.at_point);
  // Of a square root: of arguments below 1e-20 of the unit of time.
  constexpr double steep = 1e10;
  const auto& at_point = context.at_point;
  const auto by_state = first_entry(at_point.pattern->f_x, at_point.f_x,
                                    [&](double derivative) { return !(std::abs(derivative) * nominal < steep); });
  if (by_state) {
    return fmt::format(
        "the right-hand side of {} has no finite derivative by {} at t = {:.10g} (a root of zero?), and elements are "
        "solved by derivatives; use method = \"event\"",
        context.facts.state_names[by_state->row], context.facts.state_names[by_state->column], position.t());
  }
  // Of any size, as psi may be in any unit.
  const auto of_indicator = first_entry(at_point.pattern->indicator_x, at_point.indicator_x,
                                        [](double derivative) { return !std::isfinite(derivative); });
  if (of_indicator) {
    return fmt::format(
        "the switching function of {} has no finite derivative by {} at t = {:.10g} (a root of zero?), and elements "
        "are solved by derivatives; use method = \"event\"",
        context.facts.selections[of_indicator->row].name, context.facts.state_names[of_indicator->column],
        position.t());
  }
  return std::nullopt;
}

std::optional<std::string> undefined_beyond(RunContext& context, const Position& position, double nominal) {
  context.kernel.evaluate(position.t(), position.x().data(), position.selections().data(), context.held.data(),
                          context.at_point);
  const std::vector<double> slope = context.at_point.f;
  std::vector<double> ahead(position.x().size());
  constexpr double first = 1e-14, last = 1e-3, factor = 8.0;  // of a simulation step
  for (double part = first; part <= last; part *= factor) {
    const double h = part * nominal;
    for (std::size_t k = 0; k < position.x().size(); ++k) ahead[k] = position.x()[k] + h * slope[k];
    context.kernel.evaluate(position.t() + h, ahead.data(), position.selections().data(), context.held.data(),
                            context.at_point);
    const auto undefined = [](const std::vector<double>& values) {
      return static_cast<std::size_t>(
          std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }) - values.begin());
    };
    const auto message = [&](std::string_view what, const std::string& name) {
      return fmt::format(
          "the {} of '{}' is not finite beyond t = {:.10g}; guard the expression with if(…), or end the "
          "simulation before",
          what, name, position.t());
    };
    if (const auto k = undefined(context.at_point.f); k < position.x().size())
      return message("right-hand side", context.facts.state_names[k]);
    if (const auto j = undefined(context.at_point.indicator); j < context.facts.selections.size())
      return message("switching function", context.facts.selections[j].name);
  }
  return std::nullopt;
}

std::string undetermined_message(const RunContext& context, const Position& position, const Recorder& recorder) {
  const auto view = recorder.view(position.set(), position.selections(), context.held.data());
  std::vector<std::string> names;
  const auto add_zero = [&](int function, const std::string& name) {
    if (view.mode[at(function)] == 0) names.push_back(name);
  };
  for (const auto& column : context.facts.columns) add_zero(column.function, column.name);
  for (const auto& group : context.facts.regions) {
    for (std::size_t i = 0; i < group.names.size(); ++i) add_zero(group.first + static_cast<int>(i), group.names[i]);
  }
  const bool regions =
      std::any_of(context.facts.parts.begin(), context.facts.parts.end(), [](const Part& p) { return p.simplex; });
  const std::string_view remedy = !context.facts.regions.empty()
                                      ? "state regions by conditions (when), not by indicators"
                                  : regions ? "take reformulation = \"step\" or method = \"event\""
                                            : "take method = \"event\"";
  return fmt::format(
      "from t = {:.10g} the solution is one of many: the equations of sliding on {} do not determine all {}, and these "
      "move the state (unique = false); {}",
      position.t(), fmt::join(names, ", "), regions ? "weights of regions" : "selections", remedy);
}

}  // namespace saltus::fesd_integrator
