#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/mechanics/mechanics_internal.hpp"
#include "saltus/model/optimal_control/ocp_checks_internal.hpp"
#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

/// Times of measurements may be so much outside of the horizon, in its lengths: a rounding.
constexpr double beside_horizon = 1e-9;

Error mistake(std::string message, std::string remedy, const SourceLocation& location,
              ErrorCode code = ErrorCode::invalid_model) {
  return {code, std::move(message), std::move(remedy), location, {"in [optimize]"}};
}

/// The name of the first control that an expression depends on; empty if there is none.
std::string control_in(const SX& expression, const System& system) {
  for (std::size_t i = 0; i < system.control_names.size(); ++i) {
    if (SX::depends_on(expression, system.u(static_cast<casadi_int>(i)))) return system.control_names[i];
  }
  return {};
}

/// States but a clock, which is the time, controls, and the selections and constants of cells that change with them.
SX moving_symbols(const Ocp& ocp, const System& system) {
  SX moving = system.u;
  for (int i = 0; i < static_cast<int>(system.state_names.size()); ++i) {
    if (!ocp.clock || ocp.clock->state != i) moving = SX::vertcat({moving, system.x(i)});
  }
  // Arguments hold symbols of earlier cells, functions those of cells and of earlier functions.
  for (const auto& cell : system.cells) {
    if (SX::depends_on(cell.argument, moving)) moving = SX::vertcat({moving, cell.symbols});
  }
  for (std::size_t j = 0; j < system.switching.size(); ++j) {
    if (!SX::depends_on(system.switching[j].psi, moving)) continue;
    moving = SX::vertcat({moving, system.alpha(static_cast<casadi_int>(j))});
  }
  return moving;
}

std::optional<Error> check_functions(const Ocp& ocp, const SourceLocation& table) {
  const System& system = ocp.system;
  for (std::size_t j = 0; j < system.switching.size(); ++j) {
    const auto& function = system.switching[j];
    const auto control = control_in(function.psi, system);
    if (control.empty()) continue;
    const SX alpha = system.alpha(static_cast<casadi_int>(j));
    const auto stated = ocp.places.find(function.name);
    const auto& location = stated == ocp.places.end() ? table : stated->second;
    if (SX::depends_on(system.f, alpha)) {
      return mistake(fmt::format("the switching function '{}' depends on the control '{}'", function.name, control),
                     fmt::format("make '{0}' a state with a rate that is the control: {0} = \"rate\"", control),
                     location, ErrorCode::not_available);
    }
    if (SX::depends_on(system.outputs, alpha)) {
      return mistake(
          fmt::format("a cost or a constraint switches where '{}' changes its sign, a function of the control "
                      "'{}'",
                      function.name, control),
          "abs and max of controls may enter convexly; step, sign and if of controls may not", location);
    }
  }
  return std::nullopt;
}

/// Says of pairs with a control that it is constant in an interval: another problem than the one with controls that
/// follow the time.
void warn_of_controls_in_pairs(Ocp& ocp, const Description& description) {
  const auto& stated = description.optimize->path_complementarities;
  for (std::size_t i = 0; i < ocp.complementarities.size(); ++i) {
    const auto& [first, second] = ocp.complementarities[i];
    const System& system = ocp.system;
    const std::string control = control_in(SX::vertcat({system.outputs(first), system.outputs(second)}), system);
    if (control.empty()) continue;
    const bool is_written = i < stated.size();
    const std::string pair = is_written ? fmt::format("['{}', '{}']", expression::to_text(*stated[i].first),
                                                      expression::to_text(*stated[i].second))
                                        : std::to_string(i + 1);
    ocp.warnings.push_back(located(
        is_written ? stated[i].location : SourceLocation{},
        fmt::format("the pair {} of path_complementarities has the control '{}', which is constant in each control "
                    "interval: a side that is positive with it is so in the whole interval. Take more "
                    "control_intervals, or make '{}' a state with a rate, if sides change within one",
                    pair, control, control)));
  }
}

}  // namespace

std::optional<Error> check_horizon(const OcpHorizon& horizon, const SourceLocation& location) {
  if (horizon.free) return check_range("the horizon", horizon.value, horizon.lower, horizon.upper, location);
  if (horizon.value > 0.0) return std::nullopt;
  return mistake(fmt::format("the horizon is {}", horizon.value), "give a number > 0", location);
}

std::optional<Error> check_range(const std::string& what, double initial, double lower, double upper,
                                 const SourceLocation& location) {
  if (!std::isfinite(lower) || !std::isfinite(upper)) {
    return mistake(fmt::format("{} is free and needs two bounds", what), "add lower and upper", location);
  }
  if (lower > upper) {
    return mistake(fmt::format("{} has the lower bound {} above its upper bound {}", what, lower, upper),
                   "exchange them, or correct one", location);
  }
  if (initial < lower || initial > upper) {
    return mistake(fmt::format("{} begins at {}, outside of its bounds [{}, {}]", what, initial, lower, upper),
                   "move `initial` between the bounds", location);
  }
  return std::nullopt;
}

std::optional<Error> check_constraint(const OcpConstraint& constraint, const SourceLocation& location) {
  if (constraint.lower > constraint.upper) {
    return mistake(fmt::format("the constraint '{}' has the lower bound {} above its upper bound {}", constraint.name,
                               constraint.lower, constraint.upper),
                   "exchange them", location);
  }
  if (constraint.norm != ConstraintNorm::hard && !(constraint.penalty > 0.0)) {
    return mistake(fmt::format("the penalty of '{}' is {}", constraint.name, constraint.penalty), "give a number > 0",
                   location);
  }
  return std::nullopt;
}

Error wrong_sample_width(const LeastSquaresDescription& stated, std::size_t row) {
  return mistake(fmt::format("row {} of the reference '{}' has {} numbers, there are {} expressions", row + 1,
                             stated.file, stated.samples[row].size(), stated.of.size()),
                 "one column per expression of `of`, in their order", stated.location);
}

std::optional<Error> check_times(const OcpLeastSquares& term, const LeastSquaresDescription& stated, const Ocp& ocp) {
  if (term.times.empty()) return std::nullopt;
  if (ocp.horizon.free) {
    return mistake("least_squares at times, and the horizon is free",
                   "fix the horizon: it is not known in which interval a time lies", stated.location,
                   ErrorCode::not_available);
  }
  if (ocp.clock) {
    return mistake("least_squares at times, and time stands still at contacts, by hysteresis or by hand",
                   "give references at the ends of intervals: at = \"intervals\"", stated.location,
                   ErrorCode::not_available);
  }
  const double last = ocp.from + ocp.horizon.value;
  const double rounding = beside_horizon * ocp.horizon.value;
  for (std::size_t row = 0; row < term.times.size(); ++row) {
    const double time = term.times[row];
    const auto place = row < stated.rows.size() ? stated.rows[row] : stated.location;
    if (row > 0 && time < term.times[row - 1]) {
      return mistake(
          fmt::format("row {}: the time {} is behind {}, of the row before", row + 1, time, term.times[row - 1]),
          "sort the rows by their times", place);
    }
    if (time >= ocp.from - rounding && time <= last + rounding) continue;
    return mistake(
        fmt::format("row {}: the time {} is outside of the horizon, from {} to {}", row + 1, time, ocp.from, last),
        "leave the row out, or change `from` and `horizon`", place);
  }
  return std::nullopt;
}

std::optional<Error> check_least_squares(const OcpLeastSquares& term, const LeastSquaresDescription& stated) {
  const auto n = term.of.size();
  if (!term.reference.empty() && term.reference.size() != n) {
    return mistake(fmt::format("least_squares has {} expressions and {} references", n, term.reference.size()),
                   "give one reference per expression, or none for 0", stated.location);
  }
  const auto& weight = stated.weight;
  const bool is_square =
      weight.size() == n && std::all_of(weight.begin(), weight.end(), [n](const auto& row) { return row.size() == n; });
  const bool is_diagonal = weight.size() == 1 && weight.front().size() == n;
  if (!weight.empty() && !is_square && !is_diagonal) {
    return mistake(fmt::format("the weight of least_squares does not fit {} expressions", n),
                   "give one number per expression, or a square matrix", stated.location);
  }
  const double asymmetry = (term.weight - term.weight.transpose()).norm();
  if (!(asymmetry <= 1e-14 * term.weight.norm())) {
    return mistake("the weight of least_squares is not symmetric", "a matrix W and its transpose have to be equal",
                   stated.location);
  }
  return std::nullopt;
}

namespace {

Error unknown_guess(const GuessDescription& stated, const Ocp& ocp) {
  std::vector<std::string> known = ocp.system.state_names;
  known.insert(known.end(), ocp.system.control_names.begin(), ocp.system.control_names.begin() + ocp.user_controls);
  for (std::size_t i = 0; i < ocp.free_parameters.size(); ++i) {
    if (ocp.free_parameters[i]) known.push_back(ocp.system.parameter_names[i]);
  }
  return {ErrorCode::unknown_name,
          fmt::format("expected the name of a state, a control or a free parameter, found '{}'", stated.name),
          suggest(stated.name, known),
          stated.location,
          {"in [optimize] initial_guess"}};
}

int place_among(const std::vector<std::string>& names, std::size_t count, const std::string& name) {
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(count);
  const auto found = std::find(names.begin(), end, name);
  return found == end ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

Expected<OcpGuess> guess_of(const GuessDescription& stated, const Ocp& ocp, int output) {
  using Kind = OcpGuess::Kind;
  const auto& system = ocp.system;
  const System& guessed = ocp.guess.system ? *ocp.guess.system : system;
  OcpGuess guess{Kind::state, place_among(system.state_names, system.state_names.size(), stated.name), output};
  if (guess.index < 0) {
    guess.kind = Kind::control;
    guess.index = place_among(system.control_names, at(ocp.user_controls), stated.name);
  }
  if (guess.index < 0) {
    guess.kind = Kind::parameter;
    guess.index = place_among(system.parameter_names, system.parameter_names.size(), stated.name);
    if (guess.index >= 0 && !ocp.free_parameters[at(guess.index)]) guess.index = -1;
  }
  if (guess.index < 0) return tl::unexpected(unknown_guess(stated, ocp));
  if (!SX::depends_on(guessed.outputs(output), moving_symbols(ocp, guessed))) return guess;
  return tl::unexpected(mistake(fmt::format("the guess of '{}' depends on states or controls", stated.name),
                                "a guess is an expression of t and parameters", stated.location));
}

std::optional<Error> check_initial_states(const Ocp& ocp, const Description& description) {
  const auto& system = ocp.system;
  for (std::size_t i = 0; i < description.states.size(); ++i) {
    const auto& location = description.states[i].location;
    const double initial = system.initial_state[i];
    if (ocp.free_states[i]) {
      if (auto error = check_range(fmt::format("state '{}'", system.state_names[i]), initial, system.state_lower[i],
                                   system.state_upper[i], location))
        return error;
    } else if (initial < system.state_lower[i] || initial > system.state_upper[i]) {
      return mistake(fmt::format("state '{}' starts at {}, outside of its bounds [{}, {}]", system.state_names[i],
                                 initial, system.state_lower[i], system.state_upper[i]),
                     "move the initial value between the bounds, or make it free", location);
    }
  }
  return std::nullopt;
}

std::optional<Error> check(Ocp& ocp, const Description& description) {
  const auto& system = ocp.system;
  const SourceLocation& location = description.optimize->location;
  if (!system.jumps.empty()) {
    return mistake("[optimize] does not cover [[jumps]]",
                   "states that jump at contacts or by hysteresis have forms of their own: time frozen by hand "
                   "([time_freezing] clock), or a model without the jumps",
                   description.jumps.front().location, ErrorCode::not_available);
  }
  for (std::size_t i = 0; i < description.states.size(); ++i) {
    // A velocity that no force changes is still one.
    if (!system.discrete_states[i] || is_mechanical(description, system.state_names[i])) continue;
    return mistake(fmt::format("the state '{}' is discrete: nothing moves it", system.state_names[i]),
                   "make it a parameter, with free = true if it is to be chosen", description.states[i].location,
                   ErrorCode::not_available);
  }
  if (ocp.clock) {
    const SX all = SX::vertcat({system.f, system.outputs});
    if (SX::depends_on(all, system.t)) {
      return mistake(
          fmt::format("t beside the clock '{}'", system.state_names[at(ocp.clock->state)]),
          fmt::format("write the clock's name, {}: time is frozen by hand", system.state_names[at(ocp.clock->state)]),
          location);
    }
  }
  for (const auto& event : description.events) {
    if (event.action == AtEvent::stop) {
      ocp.warnings.push_back(fmt::format("[[events]] with stop = true do not stop an optimisation"));
    }
  }
  warn_of_controls_in_pairs(ocp, description);
  return check_functions(ocp, location);
}

}  // namespace saltus::model
