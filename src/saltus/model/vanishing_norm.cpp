#include "saltus/model/vanishing_norm.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/interpret.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

struct NormValue {
  double value = 0.0;
  std::set<int> states = {};  ///< those in its argument
};

/// hypot and sqrt of states in the right-hand side, in the order of its evaluation.
std::vector<NormValue> norms_at(const casadi::Function& rate, const std::vector<std::vector<double>>& arguments) {
  std::vector<NormValue> norms;
  const auto input = [&](casadi_int argument, casadi_int entry) {
    NormValue value{arguments[at(argument)][at(entry)], {}};
    if (argument == 1) value.states.insert(static_cast<int>(entry));
    return value;
  };
  const auto operate = [&](casadi_int, casadi_int operation, const NormValue& first, const NormValue& second) {
    NormValue result{operated(operation, first.value, second.value), first.states};
    result.states.insert(second.states.begin(), second.states.end());
    const bool is_norm = operation == casadi::OP_HYPOT || operation == casadi::OP_SQRT;
    if (is_norm && result.states.size() > 1) norms.push_back(result);
    return result;
  };
  static_cast<void>(interpret<NormValue>(rate, input, operate));
  return norms;
}

}  // namespace

std::string vanishing_norm(const System& system, double t, const std::vector<double>& x) {
  casadi::SX constants(0, 1);
  for (const auto& cell : system.cells) constants = casadi::SX::vertcat({constants, cell.symbols});
  const casadi::SX known = casadi::SX::vertcat({system.t, system.x, system.u, system.p, system.alpha, constants});
  // Weights of regions that are written by those of the others.
  for (const auto& symbol : casadi::SX::symvar(system.f_as_written)) {
    if (!casadi::SX::depends_on(symbol, known)) constants = casadi::SX::vertcat({constants, symbol});
  }
  const casadi::Function rate("rate", {system.t, system.x, system.u, system.p, system.alpha, constants},
                              {system.f_as_written});
  const std::vector<double> alpha(at(system.alpha.numel()), 0.5), cells(at(constants.numel()), 0.0);
  const auto at_point = [&](const std::vector<double>& point) {
    return norms_at(rate, {{t}, point, system.control_initial, system.parameter_values, alpha, cells});
  };
  const auto before = at_point(system.initial_state), now = at_point(x);
  constexpr double next_to_nothing = 1e-6;
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (!(now[k].value <= next_to_nothing * before[k].value)) continue;
    std::vector<std::string> names;
    for (const int state : now[k].states) names.push_back(system.state_names[at(state)]);
    const auto& contacts = system.contacts.contacts;
    if (std::any_of(contacts.begin(), contacts.end(), [](const auto& contact) { return contact.in_plane; })) {
      return "; a slip with two tangents begins or ends here, so slowly that its direction is hardly resolved: "
             "integrator = \"radau5\" follows it in few steps, larger rtol and atol in fewer than now";
    }
    return fmt::format(
        "; a norm of {0} vanishes here, and its direction with it, as in planar friction (the force along -v/|v|): use "
        "a norm that does not vanish, for two like sqrt({1}^2 + {2}^2 + 1e-6), or [[contacts]] with two tangents",
        fmt::join(names, ", "), names[0], names[1]);
  }
  return "";
}

}  // namespace saltus::model
