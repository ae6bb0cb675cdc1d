// What the kernel knows of cells: which one each argument is in, and where its constants stand among the parameters.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using model::ModelFunction;

class CellFunctions {
 public:
  CellFunctions() = default;
  /// Appends constants, upper and lower ends of all cells to the symbols `p` and their values `parameters`.
  CellFunctions(const model::System& system, casadi::SX& p, std::vector<double>& parameters);

  /// Returns rows argument - upper end, argument - lower end, cell by cell.
  [[nodiscard]] std::vector<casadi::SX> rows(const model::System& system) const;
  /// Compiles the arguments as functions of t, x, p, alpha, the inputs put in for the controls.
  void compile(const std::vector<casadi::SX>& variables, const model::System& system, const casadi::SX& input);

  [[nodiscard]] int size() const { return static_cast<int>(places_.size()); }
  [[nodiscard]] const model::CellTable& table(int cell) const { return *place(cell).table; }
  [[nodiscard]] long index(int cell) const { return place(cell).index; }
  void move(int cell, long target, std::vector<double>& parameters);
  [[nodiscard]] double argument(int cell, const std::array<const double*, 4>& here);
  /// Returns for every row of `expression` the cells whose constants it holds.
  [[nodiscard]] std::vector<std::vector<bool>> dependencies(const std::vector<std::vector<int>>& on_parameters) const;

 private:
  struct Place {
    std::shared_ptr<const model::CellTable> table;
    long index = 0;
    std::size_t constants = 0, upper = 0, lower = 0;  ///< where they are among the parameters
    casadi::SX upper_symbol, lower_symbol;
    ModelFunction argument{};
  };
  [[nodiscard]] const Place& place(int cell) const { return places_[at(cell)]; }
  std::vector<Place> places_;
};

}  // namespace saltus::evaluation
