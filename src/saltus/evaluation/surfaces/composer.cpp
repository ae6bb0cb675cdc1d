#include "saltus/base/contains.hpp"
#include "saltus/evaluation/surfaces/composer_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using casadi::DM;
using casadi::SX;

namespace {

using Kind = SymbolTable::Kind;

void add_dependencies(const Composed& part, Composed& whole) {
  whole.states.insert(part.states.begin(), part.states.end());
  whole.cells.insert(part.cells.begin(), part.cells.end());
  whole.on_time = whole.on_time || part.on_time;
  whole.resolved = whole.resolved && part.resolved;
}

}  // namespace

Composer::Composer(const model::System& system)
    : system_(system), parameters_(DM(system.parameter_values)), inputs_(SX::densify(system.input)) {
  std::vector<SX> symbols{SX(0, 1)};
  for (std::size_t c = 0; c < system.cells.size(); ++c) {
    symbols.push_back(system.cells[c].symbols);
    owners_.insert(owners_.end(), static_cast<std::size_t>(symbols.back().numel()), static_cast<int>(c));
  }
  symbols_ = SX::vertcat(symbols);
  table_.add(Kind::state, system.x);
  table_.add(Kind::time, system.t);
  table_.add(Kind::parameter, system.p);
  table_.add(Kind::control, system.u);
  table_.add(Kind::selection, system.alpha);
  table_.add(Kind::constant_of_cell, symbols_);
  arguments_.resize(system.cells.size());
  for (std::size_t c = 0; c < system.cells.size(); ++c) compose_argument(static_cast<int>(c));
  // Inner functions have smaller indices, so one pass in order composes all.
  for (const auto& entry : system.switching) composed_.push_back(compose(entry.psi));
}

Composed Composer::compose(const SX& expression) const {
  const SX psi = with_inputs(expression);
  Composed result;
  for (const int i : table_.used(psi, Kind::state).places) result.states.insert(i);
  result.on_time = !table_.used(psi, Kind::time).places.empty();
  for (const int symbol : table_.used(psi, Kind::constant_of_cell).places) {
    const int cell = owners_[at(symbol)];
    result.cells.insert(cell);
    add_dependencies(arguments_[at(cell)], result);
  }
  const auto inner = table_.used(psi, Kind::selection);
  if (!inner.places.empty() && composed_.empty()) {
    // The argument of a cell holds selections only where an input of time brings them.
    result.on_time = true;
    result.resolved = false;
    return result;
  }
  std::vector<SX> selections;
  for (const int j : inner.places) {
    const auto& other = composed_[at(j)];
    selections.push_back(SX::if_else(other.psi > 0, 1, 0));
    add_dependencies(other, result);
  }
  result.nested = !selections.empty();
  result.psi = result.nested ? SX::substitute(psi, SX(inner.symbols), SX::vertcat(selections)) : psi;
  return result;
}

SX Composer::with_inputs(const SX& expression) const {
  const SX psi = table_.with_values(SX::densify(expression), Kind::control, inputs_);
  return table_.with_values(psi, Kind::parameter, parameters_);
}

/// Behind the cells in it. A control may have a table, and its input be another one of a larger index.
void Composer::compose_argument(int cell) {
  if (contains(order_, cell)) return;
  const SX& argument = system_.cells[at(cell)].argument;
  for (const int symbol : table_.used(with_inputs(argument), Kind::constant_of_cell).places) {
    compose_argument(owners_[at(symbol)]);
  }
  arguments_[at(cell)] = compose(argument);
  order_.push_back(cell);
}

}  // namespace saltus::evaluation
