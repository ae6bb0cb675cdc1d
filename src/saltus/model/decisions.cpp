#include "saltus/model/decisions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/recognition/decisions_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// A system with other values than it was built with.
class ChangedValues {
 public:
  explicit ChangedValues(const System& system) : system_(system), made_(*system.decisions), tape_(made_.tape) {
    const auto& variables = made_.tape.variables();
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (variables[i].kind != VariableKind::parameter) continue;
      const double value = system.parameter_values[at(variables[i].index)];
      if (is_same(value, variables[i].value)) continue;
      tape_.set_value(static_cast<int>(i), value);
      changed_.insert(static_cast<int>(i));
    }
  }

  [[nodiscard]] std::optional<Error> find() const {
    if (changed_.empty()) return std::nullopt;
    for (const auto& decision : made_.noted) {
      if (auto error = decided_otherwise(decision)) return error;
    }
    if (auto error = coincide()) return error;
    return jump();
  }

 private:
  [[nodiscard]] std::vector<int> changed_in(std::span<const int> roots) const {
    std::vector<int> found;
    for (const int node : tape_.cone(roots, Links::through_alpha)) {
      if (changed_.contains(tape_[node].variable)) found.push_back(tape_[node].variable);
    }
    return found;
  }

  [[nodiscard]] std::optional<Error> decided_otherwise(const Decision& decision) const {
    const int roots[] = {decision.node, decision.other};
    const auto changed = changed_in(roots);
    if (changed.empty() || is_set_by_hand(decision)) return std::nullopt;
    if (is_same(outcome(tape_, decision), decision.outcome)) return std::nullopt;
    return refused(changed, decision.text);
  }

  [[nodiscard]] bool is_set_by_hand(const Decision& decision) const {
    const auto differs = [&](const std::vector<double>& list) {
      return list[at(decision.computed.index)] != decision.outcome;
    };
    switch (decision.computed.list) {
      case ComputedNumber::Of::parameters:
        return differs(system_.parameter_values);
      case ComputedNumber::Of::initial_state:
        return differs(system_.initial_state);
      case ComputedNumber::Of::nothing_kept:
        return false;
    }
    __builtin_unreachable();
  }

  /// Functions that were different have one selection each, which one surface does not determine.
  [[nodiscard]] std::optional<Error> coincide() const {
    std::vector<int> psi;
    for (const auto& [node, name] : made_.functions) psi.push_back(node);
    if (changed_in(psi).empty()) return std::nullopt;
    const auto before = first_multiples(made_.tape, psi), now = first_multiples(tape_, psi);
    for (std::size_t i = 0; i < psi.size(); ++i) {
      if (now[i] == before[i] || before[i] != i) continue;
      const int roots[] = {psi[i], psi[now[i]]};
      return refused(changed_in(roots), fmt::format("'{}' and '{}' are two switching functions",
                                                    made_.functions[now[i]].second, made_.functions[i].second));
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Error> jump() const {
    std::map<int, std::vector<int>> targets;  // by alpha
    for (const int target : made_.targets) {
      for (const int alpha : alpha_nodes(tape_, std::span(&target, 1), Links::written))
        targets[alpha].push_back(target);
    }
    std::vector<Surface> concerned;
    std::vector<std::vector<int>> changed;
    for (const auto& kink : made_.kinks) {
      auto roots = targets[kink.alpha];
      roots.push_back(kink.psi);
      auto found = changed_in(roots);
      if (found.empty()) continue;
      concerned.push_back(kink);
      changed.push_back(std::move(found));
    }
    const auto classes = classify(tape_, concerned, made_.discrete, made_.targets);
    for (std::size_t i = 0; i < classes.size(); ++i) {
      if (classes[i].role == SwitchingRole::kink) continue;
      return refused(changed[i], fmt::format("nothing jumps where '{}' is 0", name_of(concerned[i].psi)));
    }
    return std::nullopt;
  }

  [[nodiscard]] const std::string& name_of(int psi) const {
    const auto is_it = [&](const auto& function) { return function.first == psi; };
    return std::find_if(made_.functions.begin(), made_.functions.end(), is_it)->second;
  }

  [[nodiscard]] Error refused(const std::vector<int>& changed, const std::string& decided) const {
    std::vector<std::string> before, now;
    for (const int i : changed) {
      const auto& variable = made_.tape.variables()[at(i)];
      const auto& name = system_.parameter_names[at(variable.index)];
      before.push_back(fmt::format("{} = {}", name, variable.value));
      now.push_back(fmt::format("{} = {}", name, tape_.variables()[at(i)].value));
    }
    return {ErrorCode::invalid_model,
            fmt::format("the system was built for {}: {}, which does not hold for {}", fmt::join(before, ", "), decided,
                        fmt::join(now, ", ")),
            "build the model anew with this value: Builder::parameter, or an override of model::build",
            {},
            {}};
  }

  const System& system_;
  const Decisions& made_;
  Tape tape_;              ///< with the values of now
  std::set<int> changed_;  ///< variables
};

std::optional<Error> find_wrong_length(const System& system) {
  for (const auto& [what, values, names] :
       {std::tuple{"parameter_values", system.parameter_values.size(), system.parameter_names.size()},
        std::tuple{"initial_state", system.initial_state.size(), system.state_names.size()},
        std::tuple{"control_initial", system.control_initial.size(), system.control_names.size()}}) {
    if (values == names) continue;
    return Error{ErrorCode::invalid_model,
                 fmt::format("{} has {} numbers for {} names", what, values, names),
                 "change numbers and leave their order and count as they are",
                 {},
                 {}};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> find_stale(const System& system) {
  if (auto error = find_wrong_length(system)) return error;
  return system.decisions ? ChangedValues(system).find() : std::nullopt;
}

std::optional<std::string> find_indefinite_mass(const System& system, const std::vector<double>& x) {
  if (!system.decisions) return std::nullopt;
  const Tape& tape = system.decisions->tape;
  Point point = blank_point(tape);
  for (std::size_t i = 0; i < point.size(); ++i) {
    const auto& variable = tape.variables()[i];
    const auto place = at(variable.index);
    if (variable.kind == VariableKind::state || variable.kind == VariableKind::discrete) point[i] = x[place];
    if (variable.kind == VariableKind::parameter) point[i] = system.parameter_values[place];
  }
  for (const auto& pivot : system.decisions->mass_pivots) {
    TapeValues values;
    evaluate(tape, tape.cone(std::span(&pivot.node, 1), Links::through_alpha), point, values);
    const double value = values.value[at(pivot.node)];
    if (!(value <= 0.0)) continue;
    return fmt::format("row {} ('{}') has no positive mass (pivot {:.3g})", pivot.row + 1,
                       system.state_names[at(pivot.velocity)], value);
  }
  return std::nullopt;
}

}  // namespace saltus::model
