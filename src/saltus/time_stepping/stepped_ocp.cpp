#include "saltus/time_stepping/stepped_ocp.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/foreign/make_problem.hpp"
#include "saltus/foreign/problem.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/system.hpp"

namespace saltus::time_stepping {

using casadi::SX;
using foreign::infinity;
using model::Ocp;
using model::System;

namespace {

/// Of each interval.
constexpr int steps = 5;
/// Between an impulse and what restitution gives back: a body that comes into contact in a step is stopped in the next.
constexpr std::size_t delay = 2;
/// Where multipliers begin.
constexpr double small = 0.01;

/// The numbers of the selections that parts depend on, with those inside of their surfaces.
std::vector<int> selections_in(const System& system, const std::vector<SX>& parts) {
  const auto depends = [&](const SX& alpha) {
    return std::any_of(parts.begin(), parts.end(), [&](const SX& part) { return SX::depends_on(part, alpha); });
  };
  std::vector<int> found;
  for (int k = static_cast<int>(system.switching.size()) - 1; k >= 0; --k) {
    const auto holds = [&](int other) { return contains(system.switching[at(other)].inner, k); };
    const bool is_inner = std::any_of(found.begin(), found.end(), holds);
    if (is_inner || depends(system.alpha(k))) found.push_back(k);
  }
  return found;
}

/// What is evaluated in a step, by number; behind it the surfaces.
enum Part : std::size_t {
  rates,
  outputs,
  gaps,
  velocities,
  responses,
  friction,
  restitution,
  guards,
  switched,
  surfaces
};

/// Those of hysteresis: not those of contacts, nor those that stop a run.
std::vector<const model::Jump*> jumps_of(const System& system) {
  const auto& contacts = system.contacts.contacts;
  std::vector<const model::Jump*> found;
  for (std::size_t i = 0; i < system.jumps.size(); ++i) {
    const auto is_of_contact = [&](const auto& one) { return one.jump == static_cast<int>(i); };
    if (std::any_of(contacts.begin(), contacts.end(), is_of_contact) || !system.jumps[i].forbidden.empty()) continue;
    found.push_back(&system.jumps[i]);
  }
  return found;
}

SX all_of(const std::vector<const model::Jump*>& jumps, SX model::Jump::*part) {
  std::vector<SX> found;
  for (const auto* jump : jumps) found.push_back(jump->*part);
  return SX::vertcat(found);
}

/// What jumps add to the states where their conditions hold.
SX switched_states(const System& system, const std::vector<const model::Jump*>& jumps) {
  SX changes = SX::zeros(system.x.numel());
  for (const auto* jump : jumps) {
    const int state = jump->targets.front();
    changes(state) = jump->value * (jump->values(0) - system.x(state));
  }
  return changes;
}

/// With all contacts open.
std::vector<SX> parts_of(const System& system) {
  const auto& contacts = system.contacts;
  const auto jumps = jumps_of(system);
  const auto constants = model::Activity().values();
  const SX open =
      SX::repmat(SX(std::vector<double>(constants.begin(), constants.end())), 1, contacts.activities.size2());
  return SX::substitute(
      {system.f, system.outputs, contacts.gap, contacts.velocity, contacts.responses, contacts.friction,
       contacts.restitution, all_of(jumps, &model::Jump::guards), switched_states(system, jumps)},
      {SX::vec(contacts.activities), contacts.forces}, {SX::vec(open), SX::zeros(contacts.forces.size())});
}

/// @param used  selections
bool is_known(const Ocp& ocp, const std::vector<int>& used) {
  const System& system = *ocp.physical;
  const auto& contacts = system.contacts.contacts;
  const bool has_gaps = std::all_of(contacts.begin(), contacts.end(), [](auto& one) { return one.has_gap; });
  const bool are_steps = std::all_of(used.begin(), used.end(), [&](int k) {
    const auto role = system.switching[at(k)].role;
    return role != model::SwitchingRole::discrete && role != model::SwitchingRole::region;
  });
  const auto is_measured = [](const auto& term) { return term.at == model::CostPoints::times; };
  return has_gaps && are_steps && system.cells.empty() && ocp.complementarities.empty() && ocp.stage_slacks.empty() &&
         std::none_of(ocp.least_squares.begin(), ocp.least_squares.end(), is_measured);
}

}  // namespace

class Builder {
 public:
  /// @param parts  of a step
  /// @param used   selections
  Builder(const Ocp& ocp, int intervals, const Motion& guess, bool is_held, std::vector<SX> parts,
          std::vector<int> used)
      : ocp_(ocp),
        system_(*ocp.physical),
        intervals_(intervals),
        guess_(guess),
        is_held_(is_held),
        used_(std::move(used)),
        jumps_(jumps_of(system_)),
        made_(new SteppedOcp()) {
    std::vector<SX> psi;
    for (const int k : used_) psi.push_back(system_.switching[at(k)].psi);
    parts.push_back(SX::vertcat(psi));
    guard_alpha_ = all_of(jumps_, &model::Jump::guard_alpha);
    functions_ =
        casadi::Function("step", {system_.t, system_.x, system_.u, system_.p, system_.alpha, guard_alpha_}, parts);
  }

  std::unique_ptr<SteppedOcp> build() {
    declare();
    SX x = initial_state_;
    for (int k = 0; k < intervals_; ++k) {
      const SX u = controls(k);
      for (int j = 0; j < steps; ++j) x = step(k, j, x, u);
      statement_.objective += horizon_ / intervals_ * squares(model::CostPoints::intervals, k);
      for (const auto& row : ocp_.path) constrain(row);
    }
    for (const auto& row : ocp_.terminal) constrain(row);
    if (ocp_.terminal_cost) statement_.objective += outputs_(*ocp_.terminal_cost);
    statement_.objective += squares(model::CostPoints::end, intervals_ - 1);
    statement_.objective += ocp_.horizon.time_weight * horizon_;
    statement_.file_variables = static_cast<int>(statement_.symbols.size());
    made_->problem_ = foreign::make_problem(std::move(statement_));
    made_->motion_ = guess_;
    return std::move(made_);
  }

 private:
  SX add(double start, double lower, double upper) {
    statement_.symbols.push_back(SX::sym("w" + std::to_string(statement_.symbols.size())));
    statement_.start.push_back(start);
    statement_.lower.push_back(lower);
    statement_.upper.push_back(upper);
    return statement_.symbols.back();
  }
  [[nodiscard]] int last() const { return static_cast<int>(statement_.symbols.size()) - 1; }
  SX multiplier() { return add(small, 0.0, infinity); }
  void equal(const SX& difference) {
    for (casadi_int i = 0; i < difference.numel(); ++i) statement_.rows.push_back({difference(i), 0.0, 0.0, {}});
  }
  void pair(const SX& G, const SX& H) { statement_.pairs.push_back({G, H, {}}); }

  /// What all steps share.
  void declare() {
    const auto& horizon = ocp_.horizon;
    horizon_ = horizon.free ? add(guess_.horizon, is_held_ ? guess_.horizon : horizon.lower,
                                  is_held_ ? guess_.horizon : horizon.upper)
                            : SX(horizon.value);
    if (horizon.free) made_->horizon_ = last();
    for (std::size_t i = 0; i < guess_.parameters.size(); ++i) {
      const bool is_free = ocp_.free_parameters[i] && !ocp_.is_initial_value(i);
      parameters_ = SX::vertcat(
          {parameters_, is_free ? add(guess_.parameters[i], ocp_.parameter_lower[i], ocp_.parameter_upper[i])
                                : SX(guess_.parameters[i])});
      made_->parameters_.push_back(is_free ? last() : -1);
    }
    for (std::size_t i = 0; i < system_.state_names.size(); ++i) {
      const bool is_free = ocp_.free_states[i];
      initial_state_ = SX::vertcat(
          {initial_state_, is_free ? add(guess_.initial_state[i], system_.state_lower[i], system_.state_upper[i])
                                   : SX(guess_.initial_state[i])});
      made_->initial_state_.push_back(is_free ? last() : -1);
    }
    for (const auto& [state, parameter] : ocp_.initial_values) parameters_(parameter) = initial_state_(state);
  }

  SX controls(int k) {
    SX u(0, 1);
    auto& places = made_->controls_.emplace_back();
    for (std::size_t i = 0; i < system_.control_names.size(); ++i) {
      u = SX::vertcat({u, add(guess_.controls[at(k)][i], system_.control_lower[i], system_.control_upper[i])});
      places.push_back(last());
    }
    return u;
  }

  /// The state at the end of step j of interval k.
  SX step(int k, int j, const SX& before, const SX& u) {
    const int number = k * steps + j;
    SX x(0, 1);
    auto& places = made_->states_.emplace_back();
    for (std::size_t i = 0; i < system_.state_names.size(); ++i) {
      x = SX::vertcat({x, add(guess_.states[at(number)][i], system_.state_lower[i], system_.state_upper[i])});
      places.push_back(last());
    }
    SX alpha = SX::zeros(system_.alpha.numel());
    for (const int s : used_) alpha(s) = add(0.5, 0.0, 1.0);
    SX passed = SX::zeros(guard_alpha_.numel());
    for (casadi_int i = 0; i < passed.numel(); ++i) passed(i) = add(0.5, 0.0, 1.0);
    const SX h = horizon_ / (intervals_ * steps), t = ocp_.from + (number + 1) * h;
    const auto values = functions_(std::vector<SX>{t, before_switching(before, x), u, parameters_, alpha, passed});
    outputs_ = values[outputs];
    for (std::size_t i = 0; i < used_.size(); ++i) {
      select(alpha(used_[i]), values[surfaces](static_cast<casadi_int>(i)));
    }
    for (casadi_int i = 0; i < passed.numel(); ++i) select(passed(i), values[guards](i));
    equal(x - before - h * values[rates] - impulses(values) - values[switched]);
    if (ocp_.running_cost) statement_.objective += h * outputs_(*ocp_.running_cost);
    statement_.objective += h * squares(model::CostPoints::stages, k);
    return x;
  }

  /// Least squares at the end of the last step, in interval k.
  [[nodiscard]] SX squares(model::CostPoints points, int k) const {
    SX sum = 0.0;
    for (const auto& term : ocp_.least_squares) {
      if (term.at != points) continue;
      std::vector<SX> r;
      for (std::size_t i = 0; i < term.of.size(); ++i) {
        r.push_back(outputs_(term.of[i]));
        if (!term.reference.empty()) r.back() -= outputs_(term.reference[i]);
        if (term.samples_per_interval() > 0) r.back() -= term.samples(k, static_cast<linalg::Index>(i));
      }
      for (std::size_t i = 0; i < r.size(); ++i) {
        for (std::size_t j = 0; j < r.size(); ++j) {
          const double weight = term.weight(static_cast<linalg::Index>(i), static_cast<linalg::Index>(j));
          if (weight != 0.0) sum += weight * r[i] * r[j];
        }
      }
    }
    return sum;
  }

  void select(const SX& alpha, const SX& psi) {
    const SX plus = multiplier(), minus = multiplier();
    equal(psi - plus + minus);
    pair(alpha, minus);
    pair(1.0 - alpha, plus);
  }

  /// A step is done with what hysteresis was before, and then looks at thresholds: so one over a threshold has a
  /// solution.
  [[nodiscard]] SX before_switching(const SX& before, SX x) const {
    for (const auto* jump : jumps_) x(jump->targets.front()) = before(jump->targets.front());
    return x;
  }

  /// By how much contacts change the states in a step.
  SX impulses(const std::vector<SX>& values) {
    const auto& contacts = system_.contacts;
    const SX &gap = values[gaps], &velocity = values[velocities], &response = values[responses];
    const casadi_int m = gap.numel();
    SX changes = SX::zeros(response.size1());
    auto& normals = normals_.emplace_back(m, 1);
    const std::size_t number = normals_.size() - 1;
    for (casadi_int i = 0; i < m; ++i) {
      SX normal = multiplier();
      normals(i) = normal;
      pair(normal, gap(i));
      if (number >= delay) normal += values[restitution](i) * normals_[number - delay](i);
      changes += response(casadi::Slice(), i) * normal;
      const auto& contact = contacts.contacts[at(i)];
      if (!contact.has_friction) continue;
      const SX speed = multiplier();
      SX rest = values[friction](i) * normal;
      for (int d = 0; d < contact.tangents(); ++d) {
        const casadi_int row = (d + 1) * m + i;
        const SX plus = multiplier(), minus = multiplier();
        pair(plus, speed + velocity(row));
        pair(minus, speed - velocity(row));
        changes += response(casadi::Slice(), row) * (plus - minus);
        rest -= plus + minus;
      }
      pair(speed, rest);
    }
    SX of_states = SX::zeros(system_.x.numel());
    for (std::size_t i = 0; i < contacts.velocities.size(); ++i) {
      of_states(contacts.velocities[i]) = changes(static_cast<casadi_int>(i));
    }
    return of_states;
  }

  void constrain(const model::OcpConstraint& row) {
    if (row.norm != model::ConstraintNorm::hard) return;
    statement_.rows.push_back({outputs_(row.output), row.lower, row.upper, {}});
  }

  const Ocp& ocp_;
  const System& system_;
  int intervals_;
  const Motion& guess_;
  bool is_held_;                           ///< the horizon
  std::vector<int> used_;                  ///< selections
  std::vector<const model::Jump*> jumps_;  ///< of hysteresis
  std::unique_ptr<SteppedOcp> made_;
  foreign::Statement statement_;
  casadi::Function functions_;
  SX guard_alpha_;  ///< of the guards of hysteresis
  SX horizon_, parameters_ = SX(0, 1), initial_state_ = SX(0, 1);
  SX outputs_;               ///< at the end of the last step
  std::vector<SX> normals_;  ///< impulses in each step
};

std::vector<double> ends_of_steps(int intervals) {
  std::vector<double> fractions;
  const int count = intervals * steps;
  for (int k = 1; k <= count; ++k) fractions.push_back(static_cast<double>(k) / count);
  return fractions;
}

std::unique_ptr<SteppedOcp> SteppedOcp::make(const Ocp& ocp, int intervals, const Motion& guess, bool is_held) {
  if (!ocp.physical) return nullptr;
  auto parts = parts_of(*ocp.physical);
  auto used = selections_in(*ocp.physical, parts);
  if (!is_known(ocp, used)) return nullptr;
  return Builder(ocp, intervals, guess, is_held, std::move(parts), std::move(used)).build();
}

SteppedOcp::~SteppedOcp() = default;

std::vector<double> SteppedOcp::values(mpcc::ConstVectorView w, const std::vector<int>& places) const {
  std::vector<double> found;
  for (const int place : places) found.push_back(w[place]);
  return found;
}

linalg::Vector SteppedOcp::start_at(const std::vector<std::vector<double>>& states) const {
  linalg::Vector w = problem_->start();
  for (std::size_t k = 0; k < states_.size(); ++k) {
    for (std::size_t i = 0; i < states_[k].size(); ++i) w[states_[k][i]] = states[k][i];
  }
  return w;
}

Motion SteppedOcp::read(mpcc::ConstVectorView w) const {
  Motion motion = motion_;
  if (horizon_ >= 0) motion.horizon = w[horizon_];
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (parameters_[i] >= 0) motion.parameters[i] = w[parameters_[i]];
  }
  for (std::size_t i = 0; i < initial_state_.size(); ++i) {
    if (initial_state_[i] >= 0) motion.initial_state[i] = w[initial_state_[i]];
  }
  for (std::size_t k = 0; k < controls_.size(); ++k) motion.controls[k] = values(w, controls_[k]);
  for (std::size_t k = 0; k < states_.size(); ++k) motion.states[k] = values(w, states_[k]);
  return motion;
}

}  // namespace saltus::time_stepping
