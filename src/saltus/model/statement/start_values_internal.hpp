// Values of expressions at the start of a simulation, before there is a system.
#pragma once

#include <cmath>
#include <span>

#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

/// Returns the value of an expression of states and parameters with the states at their initial values, which are
/// known. Time and controls count as 0.
/// @param node   its number in the graph of `recognition`
/// @param moved  by how much of their sizes, each by another part of it, states are moved from there
[[nodiscard]] inline double value_at_start(const Recognition& recognition, const Statement& statement, int node,
                                           double moved = 0.0) {
  const Tape tape = recognition.graph.tape().part(std::span(&node, 1));
  Point point = blank_point(tape);
  for (std::size_t i = 0; i < point.size(); ++i) {
    const auto& variable = tape.variables()[i];
    const bool is_state = variable.kind == VariableKind::state || variable.kind == VariableKind::discrete;
    // The tape may have states that this statement has not made yet.
    const bool is_stated = is_state && at(variable.index) < statement.states.size();
    if (!is_stated) continue;
    const double start = statement.states[at(variable.index)].initial;
    point[i] = start + moved * (1.0 + std::abs(start)) * (1.0 + 0.37 * static_cast<double>(variable.index % 5));
  }
  TapeValues values;
  const int place = tape.size() - 1;
  evaluate(tape, tape.cone(std::span(&place, 1), Links::through_alpha), point, values);
  return values.value.back();
}

}  // namespace saltus::model
