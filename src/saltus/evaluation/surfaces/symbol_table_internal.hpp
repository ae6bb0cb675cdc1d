// Which symbols of a model an expression is made of.
#pragma once

#include <unordered_map>
#include <utility>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

namespace saltus::evaluation {

/// Says what the symbols of a model are. Looking an expression up costs its size, whatever the size of the model.
class SymbolTable {
 public:
  enum class Kind { state, time, parameter, control, selection, constant_of_cell };
  struct Used {
    std::vector<int> places;              ///< ascending
    std::vector<casadi::SXElem> symbols;  ///< of the places
  };

  void add(Kind kind, const casadi::SX& symbols);
  [[nodiscard]] Used used(const casadi::SX& expression, Kind kind) const;

  /// Returns the expression with values in the place of all symbols of a kind.
  [[nodiscard]] casadi::SX with_values(const casadi::SX& expression, Kind kind, const casadi::SX& values) const;

 private:
  std::unordered_map<const void*, std::pair<Kind, int>> known_;
};

}  // namespace saltus::evaluation
