// Names that the expressions of a description use.
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {
namespace {

using expression::NodePtr;

void note_all(const std::vector<NodePtr>& nodes, ModelScope& scope) {
  for (const auto& node : nodes) scope.note_names(node);
}

void note_names_of(const OcpDescription& problem, ModelScope& scope) {
  note_all({problem.from, problem.horizon.value, problem.horizon.lower, problem.horizon.upper, problem.running_cost,
            problem.terminal_cost, problem.time_weight},
           scope);
  for (const auto* constraints : {&problem.path_constraints, &problem.terminal_constraints}) {
    for (const auto& constraint : *constraints) {
      note_all(constraint.sides, scope);
      scope.note_names(constraint.penalty);
    }
  }
  for (const auto& pair : problem.path_complementarities) note_all({pair.first, pair.second}, scope);
  for (const auto& term : problem.least_squares) {
    note_all(term.of, scope);
    note_all(term.reference, scope);
    for (const auto& row : term.weight) note_all(row, scope);
  }
  for (const auto& guess : problem.guess) scope.note_names(guess.expression);
}

void note_names_of(const MechanicsDescription& mechanics, ModelScope& scope) {
  for (const auto& row : mechanics.mass) note_all(row, scope);
  scope.note_names(mechanics.potential);
  for (const auto& entry : mechanics.force) scope.note_names(entry.force);
  for (const auto& shape : mechanics.draw) {
    scope.note_names(shape.radius);
    for (const auto& point : shape.points) note_all({point[0], point[1]}, scope);
  }
}

}  // namespace

void note_names(const Description& description, ModelScope& scope) {
  for (const auto* table : {&description.parameters, &description.definitions, &description.switching,
                            &description.dynamics, &description.outputs, &description.inputs}) {
    for (const auto& entry : *table) scope.note_names(entry.expression);
  }
  for (const auto& state : description.states) note_all({state.initial, state.lower, state.upper}, scope);
  for (const auto& control : description.controls) note_all({control.initial, control.lower, control.upper}, scope);
  for (const auto& event : description.events) scope.note_names(event.when);
  for (const auto& mode : description.modes) {
    note_all({mode.when, mode.indicator}, scope);
    for (const auto& entry : mode.dynamics) scope.note_names(entry.expression);
  }
  for (const auto& jump : description.jumps) {
    note_all({jump.when, jump.every, jump.priority, jump.delay}, scope);
    note_all(jump.at, scope);
    for (const auto& entry : jump.set) scope.note_names(entry.expression);
  }
  for (const auto& entry : description.hysteresis) note_all({entry.input, entry.on, entry.off, entry.initial}, scope);
  if (description.mechanics) note_names_of(*description.mechanics, scope);
  for (const auto& contact : description.contacts) {
    note_all({contact.gap, contact.friction, contact.restitution}, scope);
    for (const auto& tangent : contact.tangents) {
      for (const auto& entry : tangent) scope.note_names(entry.value);
    }
  }
  note_all(description.replaced, scope);
  if (!description.optimize) return;
  note_names_of(*description.optimize, scope);
  for (const auto& parameter : description.free_parameters) note_all({parameter.lower, parameter.upper}, scope);
}

}  // namespace saltus::model
