#include "saltus/model/vanishing_norm.hpp"

#include <cmath>
#include <set>

#include <casadi/core/calculus.hpp>
#include <casadi/core/function.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"

namespace saltus::model {
namespace {

struct NormValue {
  double value = 0.0;
  std::set<int> states;  ///< those in its argument
};

/// hypot and sqrt of states in the right-hand side, in the order of its evaluation.
std::vector<NormValue> norms_at(const casadi::Function& rate, const std::vector<std::vector<double>>& arguments) {
  std::vector<NormValue> work(rate.sz_w()), norms;
  for (casadi_int k = 0; k < rate.n_instructions(); ++k) {
    const casadi_int operation = rate.instruction_id(k);
    if (operation == casadi::OP_OUTPUT) continue;
    const auto in = rate.instruction_input(k);
    auto& out = work[at(rate.instruction_output(k)[0])];
    NormValue result;
    if (operation == casadi::OP_CONST) {
      result.value = rate.instruction_constant(k);
    } else if (operation == casadi::OP_INPUT) {
      result.value = arguments[at(in[0])][at(in[1])];
      if (in[0] == 1) result.states.insert(static_cast<int>(in[1]));
    } else {
      const NormValue &first = work[at(in[0])], &second = work[at(in.back())];
      casadi::casadi_math<double>::fun(static_cast<unsigned char>(operation), first.value, second.value, result.value);
      result.states = first.states;
      result.states.insert(second.states.begin(), second.states.end());
      const bool is_norm = operation == casadi::OP_HYPOT || operation == casadi::OP_SQRT;
      if (is_norm && result.states.size() > 1) norms.push_back(result);
    }
    out = std::move(result);
  }
  return norms;
}

}  // namespace

std::string vanishing_norm(const System& system, double t, const std::vector<double>& x) {
  casadi::SX constants(0, 1);
  for (const auto& cell : system.cells) constants = casadi::SX::vertcat({constants, cell.symbols});
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
    return fmt::format(
        "; a norm of {0} vanishes here, and its direction with it, as in planar friction (the force along -v/|v|): use "
        "a "
        "norm that does not vanish, for two like sqrt({1}^2 + {2}^2 + 1e-6), or [[contacts]] with two tangents",
        fmt::join(names, ", "), names[0], names[1]);
  }
  return "";
}

}  // namespace saltus::model
