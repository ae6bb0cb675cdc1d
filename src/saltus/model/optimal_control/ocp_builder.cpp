#include "saltus/model/optimal_control/ocp_builder.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/builder_parts_internal.hpp"
#include "saltus/model/optimal_control/initial_values_internal.hpp"
#include "saltus/model/optimal_control/ocp_checks_internal.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

int place_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

struct OcpBuilder::Parts {
  /// What is stated of a free parameter or of a guess.
  struct Named {
    std::string name;
    double lower = 0.0, upper = 0.0;
    int output = 0;
  };

  Builder system;
  Ocp ocp;
  std::vector<std::string> free_states;
  std::map<std::string, SX> initial_values;  ///< of states
  std::vector<Named> free_parameters, guesses;
  std::optional<Error> error;
  int outputs = 0;

  explicit Parts(Builder builder) : system(std::move(builder)) {
    if (auto built = system.build(); !built) error = built.error();
    const Statement& stated = system.parts_->statement;
    outputs = ocp.user_outputs = static_cast<int>(stated.outputs.size());
    ocp.user_controls = static_cast<int>(stated.controls.size());
  }

  /// An output of the system's own beside the user's.
  int add(const SX& expression) {
    system.output(fmt::format("of_problem_{}", outputs), expression);
    return outputs++;
  }
  void fail(std::optional<Error> mistake) {
    if (!error) error = std::move(mistake);
  }
  void set_horizon(OcpHorizon horizon) {
    horizon.time_weight = ocp.horizon.time_weight;
    ocp.horizon = horizon;
    fail(check_horizon(horizon, {}));
  }
  void constrain(std::vector<OcpConstraint>& list, const std::string& name, double lower, const SX& e, double upper,
                 const Softness& soft) {
    OcpConstraint constraint{
        .name = name, .output = add(e), .lower = lower, .upper = upper, .norm = soft.norm, .penalty = soft.penalty};
    fail(check_constraint(constraint, {}));
    list.push_back(std::move(constraint));
  }
  void add_squares(OcpLeastSquares term, const linalg::Matrix& weight) {
    const auto n = static_cast<linalg::Index>(term.of.size());
    term.weight = weight.size() == 0 ? linalg::Matrix::identity(n, n) : weight;
    if (term.weight.rows() != n || term.weight.cols() != n) {
      Error mistake;
      mistake.code = ErrorCode::invalid_model;
      mistake.message =
          fmt::format("the weight of least_squares is {} x {} for {} expressions", weight.rows(), weight.cols(), n);
      mistake.remedy = "give a square matrix, or none";
      return fail(std::move(mistake));
    }
    fail(check_least_squares(term, {}));
    ocp.least_squares.push_back(std::move(term));
  }
  void unknown(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
    Error mistake;
    mistake.code = ErrorCode::unknown_name;
    mistake.message = fmt::format("expected the name of {}, found '{}'", what, name);
    mistake.remedy = suggest(name, known);
    fail(std::move(mistake));
  }

  void free_what_is_free() {
    const auto& built = ocp.system;
    ocp.free_states.assign(built.state_names.size(), false);
    for (const auto& name : free_states) {
      const int i = place_of(built.state_names, name);
      if (i < 0) return unknown("a state", name, built.state_names);
      ocp.free_states[static_cast<std::size_t>(i)] = true;
    }
    ocp.free_parameters.assign(built.parameter_names.size(), false);
    ocp.parameter_lower = ocp.parameter_upper = built.parameter_values;
    for (const auto& stated : free_parameters) {
      const int place = place_of(built.parameter_names, stated.name);
      if (place < 0) return unknown("a parameter", stated.name, built.parameter_names);
      const auto i = static_cast<std::size_t>(place);
      ocp.free_parameters[i] = true;
      ocp.parameter_lower[i] = stated.lower;
      ocp.parameter_upper[i] = stated.upper;
      fail(check_range(fmt::format("parameter '{}'", stated.name), built.parameter_values[i], stated.lower,
                       stated.upper, {}));
    }
  }

  /// A parameter that is free where the initial value is.
  void take_initial_values() {
    const auto& built = ocp.system;
    ocp.initial_values.clear();
    for (const auto& [state, symbol] : initial_values) {
      const OcpInitialValue one{place_of(built.state_names, state),
                                place_of(built.parameter_names, InitialValues::parameter_of(state))};
      const std::size_t i = at(one.state), parameter = at(one.parameter);
      ocp.initial_values.push_back(one);
      if (!ocp.free_states[i]) continue;
      ocp.free_parameters[parameter] = true;
      ocp.parameter_lower[parameter] = built.state_lower[i];
      ocp.parameter_upper[parameter] = built.state_upper[i];
    }
  }

  void take_guesses() {
    for (const auto& stated : guesses) {
      GuessDescription description;
      description.name = stated.name;
      auto guess = guess_of(description, ocp, stated.output);
      if (!guess) return fail(guess.error());
      ocp.guess.list.push_back(*guess);
    }
  }

  /// The system as it is written; time stands still in it where there are contacts and hysteresis.
  std::optional<Error> take_system() {
    auto& stated = *system.parts_;
    if (stated.error) return stated.error;
    ocp.problem_outputs = outputs - ocp.user_outputs;
    auto physical = guarded([&] { return stated.as_written(); });
    if (!physical) return physical.error();
    if (!stated.stands_still()) {
      ocp.system = std::move(*physical);
      return std::nullopt;
    }
    auto frozen = guarded([&] { return stated.frozen(FrozenFor::optimisation); });
    if (!frozen) return frozen.error();
    ocp.system = std::move(*frozen);
    ocp.physical = std::make_shared<const System>(std::move(*physical));
    const int clock = ocp.system.freezing->clock;
    ocp.clock = {clock, stated.freezing.speed_lower, stated.freezing.speed_upper};
    ocp.system.initial_state[at(clock)] = ocp.from;
    return std::nullopt;
  }

  /// What the checks look for in a description, which names places in a file: there are none.
  [[nodiscard]] Description without_places() const {
    Description nowhere;
    nowhere.optimize.emplace();
    const auto& built = ocp.system;
    nowhere.states.resize(built.freezing ? at(built.freezing->first_hidden) : built.state_names.size());
    nowhere.jumps.resize(built.jumps.size());
    const auto& mechanics = system.parts_->mechanics;
    if (!mechanics) return nowhere;
    nowhere.mechanics.emplace();
    for (const auto& list : {mechanics->positions, mechanics->velocities}) {
      for (const int i : list) nowhere.mechanics->velocities.push_back({built.state_names[at(i)], {}});
    }
    return nowhere;
  }

  Expected<Ocp> build() {
    if (!error && !(ocp.horizon.value > 0.0)) fail(check_horizon(ocp.horizon, {}));
    if (error) return tl::unexpected(*error);
    if (auto mistake = take_system()) return tl::unexpected(*mistake);
    ocp.guess.list.clear();
    free_what_is_free();
    if (error) return tl::unexpected(*error);
    take_initial_values();
    take_guesses();
    for (const auto& term : ocp.least_squares) fail(check_times(term, {}, ocp));
    const Description nowhere = without_places();
    fail(check_initial_states(ocp, nowhere));
    fail(check(ocp, nowhere));
    if (error) return tl::unexpected(*error);
    return ocp;
  }
};

OcpBuilder::OcpBuilder(Builder system) : parts_(std::make_unique<Parts>(std::move(system))) {}
OcpBuilder::~OcpBuilder() = default;
OcpBuilder::OcpBuilder(OcpBuilder&&) noexcept = default;
OcpBuilder& OcpBuilder::operator=(OcpBuilder&&) noexcept = default;

void OcpBuilder::start_time(double from) { parts_->ocp.from = from; }

void OcpBuilder::horizon(double length) { parts_->set_horizon({.free = false, .value = length}); }

void OcpBuilder::free_horizon(double initial, double lower, double upper) {
  parts_->set_horizon({.free = true, .value = initial, .lower = lower, .upper = upper});
}

void OcpBuilder::minimize_time(double weight) { parts_->ocp.horizon.time_weight = weight; }
void OcpBuilder::running_cost(const SX& cost) { parts_->ocp.running_cost = parts_->add(cost); }
void OcpBuilder::terminal_cost(const SX& cost) { parts_->ocp.terminal_cost = parts_->add(cost); }

void OcpBuilder::least_squares(const std::vector<SX>& of, const std::vector<SX>& reference,
                               const linalg::Matrix& weight, CostPoints at) {
  OcpLeastSquares term;
  term.at = at;
  for (const auto& e : of) term.of.push_back(parts_->add(e));
  for (const auto& e : reference) term.reference.push_back(parts_->add(e));
  parts_->add_squares(std::move(term), weight);
}

void OcpBuilder::measurements(const std::vector<SX>& of, const std::vector<double>& times,
                              const linalg::Matrix& samples, const linalg::Matrix& weight) {
  OcpLeastSquares term;
  term.at = CostPoints::times;
  term.times = times;
  term.samples = samples;
  for (const auto& e : of) term.of.push_back(parts_->add(e));
  const auto rows = static_cast<linalg::Index>(times.size()), columns = static_cast<linalg::Index>(of.size());
  if (rows == 0 || samples.rows() != rows || samples.cols() != columns) {
    Error mistake;
    mistake.code = ErrorCode::invalid_model;
    mistake.message =
        fmt::format("{} x {} samples for {} times and {} expressions", samples.rows(), samples.cols(), rows, columns);
    mistake.remedy = "give one row per time, one column per expression";
    return parts_->fail(std::move(mistake));
  }
  parts_->add_squares(std::move(term), weight);
}

void OcpBuilder::path_constraint(const std::string& name, double lower, const SX& e, double upper,
                                 const Softness& soft) {
  parts_->constrain(parts_->ocp.path, name, lower, e, upper, soft);
}

void OcpBuilder::path_constraints_at(ConstraintPoints points) { parts_->ocp.path_at = points; }

void OcpBuilder::terminal_constraint(const std::string& name, double lower, const SX& e, double upper,
                                     const Softness& soft) {
  parts_->constrain(parts_->ocp.terminal, name, lower, e, upper, soft);
}

void OcpBuilder::complementarity(const SX& a, const SX& b) {
  const int first = parts_->add(a);
  parts_->ocp.complementarities.emplace_back(first, parts_->add(b));
}

SX OcpBuilder::initial(const std::string& state) {
  auto& values = parts_->initial_values;
  if (const auto known = values.find(state); known != values.end()) return known->second;
  const auto& states = parts_->system.parts_->statement.states;
  const auto stated = std::find_if(states.begin(), states.end(), [&](const auto& one) { return one.name == state; });
  if (stated == states.end()) {
    std::vector<std::string> names;
    for (const auto& one : states) names.push_back(one.name);
    parts_->unknown("a state", state, names);
    return SX(0.0);
  }
  return values[state] = parts_->system.parameter(InitialValues::parameter_of(state), stated->initial);
}

void OcpBuilder::free_state(const std::string& name) { parts_->free_states.push_back(name); }

void OcpBuilder::free_parameter(const std::string& name, double lower, double upper) {
  parts_->free_parameters.push_back({name, lower, upper, 0});
}

void OcpBuilder::guess(const std::string& name, const SX& e) {
  parts_->guesses.push_back({name, 0.0, 0.0, parts_->add(e)});
}

Expected<Ocp> OcpBuilder::build() { return parts_->build(); }

}  // namespace saltus::model
