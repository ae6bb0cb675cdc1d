// Controls that are constant in intervals, as sampled inputs of a system.
#include <algorithm>
#include <memory>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/model/ocp.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

bool occurs(const SX& symbols, const SX& expression) {
  return expression.nnz() > 0 && SX::depends_on(SX::vec(expression), SX::vec(symbols));
}

/// Whether anything but the inputs needs the constants of this cell.
bool is_used(const System& system, std::size_t cell) {
  const SX& symbols = system.cells[cell].symbols;
  const auto in = [&](const SX& expression) { return occurs(symbols, expression); };
  return in(system.f) || in(system.f_as_written) || in(system.outputs) ||
         std::any_of(system.switching.begin(), system.switching.end(), [&](const auto& s) { return in(s.psi); }) ||
         std::any_of(system.events.begin(), system.events.end(),
                     [&](const auto& event) { return in(event.value) || in(event.guards); }) ||
         std::any_of(system.jumps.begin(), system.jumps.end(),
                     [&](const auto& jump) {
                       return in(jump.value) || in(jump.guards) || in(jump.values) || in(jump.priority) ||
                              in(jump.delay);
                     }) ||
         std::any_of(system.cells.begin() + index(cell) + 1, system.cells.end(),
                     [&](const auto& later) { return in(later.argument); });
}

/// Their breaks would be restarts of nothing.
void drop_cells_of_inputs(System& system) {
  // Backwards: what only a dropped cell needs is dropped, too.
  for (std::size_t i = system.cells.size(); i-- > 0;) {
    if (occurs(system.cells[i].symbols, system.input) && !is_used(system, i)) {
      system.input = SX::vertcat({system.input, system.cells[i].argument});
      system.cells.erase(system.cells.begin() + index(i));
    }
  }
}

}  // namespace

System with_controls(System system, const std::vector<double>& times, const std::vector<std::vector<double>>& values) {
  SALTUS_ASSERT(!times.empty() && times.size() == values.size());
  drop_cells_of_inputs(system);
  std::vector<SX> inputs;
  for (std::size_t i = 0; i < system.control_names.size(); ++i) {
    std::vector<double> column;
    for (const auto& row : values) column.push_back(row[i]);
    Cell cell;
    cell.name = system.control_names[i];
    cell.argument = system.t;
    cell.symbols = SX::sym(cell.name);
    cell.table = std::make_shared<const CellTable>(step_cells(times, column));
    inputs.push_back(cell.symbols);
    system.cells.push_back(std::move(cell));
  }
  system.input = system.input_at_instant = inputs.empty() ? SX(0, 1) : SX::vertcat(inputs);
  return system;
}

}  // namespace saltus::model
