// Functions of a model with its parameters, inputs and inner selections put in.
#pragma once

#include <set>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/surfaces/symbol_table_internal.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::evaluation {

/// Holds a switching function with what it depends on, the inner ones' dependencies included.
struct Composed {
  casadi::SX psi;  ///< over t, x and the constants of cells
  std::set<int> states;
  std::set<int> cells;  ///< in it, and in their arguments
  bool on_time = false;
  bool nested = false;
  bool resolved = true;  ///< no selections are left in it
};

class Composer {
 public:
  explicit Composer(const model::System& system);

  [[nodiscard]] Composed compose(const casadi::SX& expression) const;

  /// The arguments of all cells, over x and the constants of others; these come first in `order`.
  [[nodiscard]] const std::vector<Composed>& arguments() const { return arguments_; }
  [[nodiscard]] const std::vector<int>& order() const { return order_; }
  [[nodiscard]] const casadi::SX& symbols() const { return symbols_; }
  [[nodiscard]] const Composed& function(int j) const { return composed_[at(j)]; }

 private:
  [[nodiscard]] casadi::SX with_inputs(const casadi::SX& expression) const;
  void compose_argument(int cell);

  const model::System& system_;
  casadi::SX parameters_;
  casadi::SX inputs_;  ///< what the controls are
  casadi::SX symbols_;
  SymbolTable table_;
  std::vector<int> owners_;  ///< the cell of every symbol
  std::vector<Composed> arguments_;
  std::vector<int> order_;
  std::vector<Composed> composed_;
};

}  // namespace saltus::evaluation
