// What jumps read, made of values at their instants.
#include <casadi/core/sx_elem.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"
#include "saltus/model/statement/jumps_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

/// Eight units in the last place of the terms of a value, and of what it moves in those of the time.
SXElem rounding_of(const SXElem& value, SxGraph& graph, const Statement& statement) {
  // A slope that is not finite, as that of a root at 0, says nothing: fmin takes the bound then.
  constexpr double steepest = 1e6;
  const auto bounded = [&](const SX& term, const SX& moved) {
    return fmin(fabs(term), steepest * (fabs(moved) + fabs(SX(value))));
  };
  SX terms = 0.0, rate = 0.0;
  for (const SX& symbol : SX::symvar(SX(value))) {
    const auto& variable = graph.tape().variables()[at(graph.tape()[graph.node(symbol.scalar())].variable)];
    const SX slope = SX::jacobian(SX(value), symbol);
    terms += bounded(slope * symbol, symbol);
    if (variable.kind == VariableKind::time) rate += slope;
    if (variable.kind == VariableKind::state) rate += slope * SX(*statement.states[at(variable.index)].dynamics);
  }
  constexpr double units = 8.0;
  return SX::densify(units * rounding_unit * (terms + bounded(rate * SX(statement.time), SX(statement.time)))).scalar();
}

/// Functions of which a run knows when they are at zero: those that something follows, and those of guards.
std::vector<bool> followed_functions(Recognition& recognition, const std::vector<int>& roots, const System& system) {
  auto followed = recognition.functions_below(roots);
  for (std::size_t i = 0; i < followed.size(); ++i) {
    if (recognition.functions()[i].named) followed[i] = true;
  }
  for (const auto& jump : system.jumps) {
    for (const SXElem& guard : jump.guards.nonzeros()) {
      const auto function = recognition.function_of(recognition.graph.node(guard));
      if (function) followed[at(function->function)] = true;
    }
  }
  return followed;
}

}  // namespace

Expected<std::vector<int>> put_at_instants(Recognition& recognition, const Statement& statement,
                                           const std::vector<int>& f, const std::vector<int>& others, System& system) {
  auto roots = others;
  roots.insert(roots.end(), f.begin(), f.end());
  const auto rounding = [&](const SXElem& value) { return rounding_of(value, recognition.graph, statement); };
  Instant instant{rounding, followed_functions(recognition, roots, system), recognition.functions_below(f), {}};
  for (const SXElem& input : system.input.nonzeros()) instant.inputs.push_back(recognition.graph.node(input));
  std::vector<SX*> all{&system.input_at_instant};
  for (auto& jump : system.jumps) all.insert(all.end(), {&jump.values, &jump.priority, &jump.delay});
  if (const auto error = recognition.put_at_instant(all, instant)) return tl::unexpected(*error);
  std::vector<int> read;
  for (const auto* expressions : all) {
    for (const SX& symbol : SX::symvar(*expressions)) read.push_back(recognition.graph.node(symbol.scalar()));
  }
  return read;
}

}  // namespace saltus::model
