#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/cell_functions_internal.hpp"

namespace saltus::evaluation {

using casadi::SX;

CellFunctions::CellFunctions(const model::System& system, SX& p, std::vector<double>& parameters) {
  if (system.cells.empty()) return;
  std::vector<SX> symbols{p};
  std::size_t next = parameters.size();
  for (const auto& cell : system.cells) {
    Place place;
    const auto columns = static_cast<std::size_t>(cell.symbols.numel());
    place.table = cell.table;
    place.constants = next;
    place.upper = next + columns;
    place.lower = place.upper + 1;
    place.upper_symbol = SX::sym("upper");
    place.lower_symbol = SX::sym("lower");
    next = place.lower + 1;
    symbols.insert(symbols.end(), {cell.symbols, place.upper_symbol, place.lower_symbol});
    places_.push_back(std::move(place));
  }
  p = SX::vertcat(symbols);
  parameters.resize(next);
  for (int cell = 0; cell < size(); ++cell) move(cell, 0, parameters);
}

std::vector<SX> CellFunctions::rows(const model::System& system) const {
  std::vector<SX> rows;
  for (std::size_t c = 0; c < places_.size(); ++c) {
    const SX& argument = system.cells[c].argument;
    rows.insert(rows.end(), {argument - places_[c].upper_symbol, argument - places_[c].lower_symbol});
  }
  return rows;
}

void CellFunctions::compile(const std::vector<SX>& variables, const model::System& system, const SX& input) {
  for (std::size_t c = 0; c < places_.size(); ++c) {
    const SX& argument = system.cells[c].argument;
    places_[c].argument = ModelFunction("cell", variables,
                                        {system.u.numel() == 0 ? argument : SX::substitute(argument, system.u, input)});
  }
}

void CellFunctions::move(int cell, long target, std::vector<double>& parameters) {
  Place& place = places_[at(cell)];
  place.index = target;
  for (int column = 0; column < place.table->columns; ++column) {
    parameters[place.constants + static_cast<std::size_t>(column)] = place.table->constant(target, column);
  }
  parameters[place.upper] = place.table->upper(target);
  parameters[place.lower] = place.table->lower(target);
}

double CellFunctions::argument(int cell, const std::array<const double*, 4>& here) {
  double value = 0.0;
  places_[at(cell)].argument(here, std::array<double*, 1>{&value});
  return value;
}

std::vector<std::vector<bool>> CellFunctions::dependencies(const std::vector<std::vector<int>>& on_parameters) const {
  std::vector<std::vector<bool>> found(on_parameters.size(), std::vector<bool>(places_.size(), false));
  for (std::size_t row = 0; row < on_parameters.size(); ++row) {
    for (const int entry : on_parameters[row]) {
      const auto parameter = static_cast<std::size_t>(entry);
      for (std::size_t c = 0; c < places_.size(); ++c) {
        if (parameter >= places_[c].constants && parameter < places_[c].upper) found[row][c] = true;
      }
    }
  }
  return found;
}

}  // namespace saltus::evaluation
