#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/model/mechanics/smooth_check_internal.hpp"

namespace saltus::model {
namespace {

/// A free parameter of an optimisation is a variable like a control.
bool is_a_parameter(const Statement& statement, const SXElem& symbol) {
  return std::any_of(statement.parameters.begin(), statement.parameters.end(),
                     [&](const auto& parameter) { return SXElem::is_equal(parameter.symbol, symbol, 0); });
}

Error not_allowed(const SmoothOf& allowed, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), allowed.location, {}};
}

std::optional<Error> find_kink(const Recognition& recognition, int node, const SmoothOf& allowed) {
  const auto& tape = recognition.graph.tape();
  if (tape[node].psi >= 0) {
    return not_allowed(allowed, fmt::format("{} switches", allowed.what), "write it with smooth functions");
  }
  if (tape[node].operation != cell_operation || !allowed.and_time) return std::nullopt;
  const bool of_a_state = (tape[tape[node].left].written & kind_bit(VariableKind::state)) != 0;
  if (!of_a_state || tape.table_of(tape[node]).has_slope()) return std::nullopt;
  return not_allowed(allowed, fmt::format("{} has kinks or jumps: floor, mod or a table", allowed.what),
                     "write it with smooth functions, or give the table kind = \"cubic\"");
}

}  // namespace

std::optional<Error> check_smooth(const Recognition& recognition, const Statement& statement, int node,
                                  const SmoothOf& allowed) {
  const auto& tape = recognition.graph.tape();
  for (const int member : tape.cone(std::span(&node, 1), Links::written)) {
    if (!allowed.may_switch) {
      if (auto error = find_kink(recognition, member, allowed)) return error;
    }
    if (tape[member].psi >= 0 || tape[member].operation == cell_operation) continue;
    if (tape[member].variable < 0) continue;
    const auto& variable = tape.variables()[at(tape[member].variable)];
    if (variable.kind == VariableKind::parameter || variable.kind == VariableKind::cell) continue;
    if (variable.kind == VariableKind::time && allowed.and_time) continue;
    const bool is_state = variable.kind == VariableKind::state || variable.kind == VariableKind::discrete;
    const auto& positions = allowed.positions;
    if (is_state && contains(positions, variable.index)) continue;
    const SXElem symbol = recognition.graph.expression(member);
    if (variable.kind == VariableKind::control && is_a_parameter(statement, symbol)) continue;
    if (allowed.and_time && SXElem::is_equal(symbol, statement.time, 0)) {
      return not_allowed(allowed,
                         fmt::format("{} depends on t, and time stands still while bodies collide", allowed.what),
                         "use method = \"event\"; for this one let what moves have a position of its own");
    }
    return not_allowed(
        allowed, fmt::format("{} depends on '{}', which is no position and no parameter", allowed.what, symbol.name()),
        fmt::format("it is an expression of positions{} and parameters", allowed.and_time ? ", t" : ""));
  }
  return std::nullopt;
}

}  // namespace saltus::model
