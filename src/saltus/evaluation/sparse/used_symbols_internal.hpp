// The symbols of a model that one expression holds: what is made of it then costs what it is made of, not the model.
#pragma once

#include <cstddef>
#include <unordered_map>
#include <vector>

#include <casadi/core/sx.hpp>

namespace saltus::evaluation {

/// Holds the symbols of a model.
struct ModelSymbols {
  casadi::SX t, x, p, alpha;
};

/// Holds symbols of one kind, by ascending place among all of that kind.
struct UsedOfKind {
  casadi::SX symbols;
  std::vector<std::size_t> place;
};

struct UsedSymbols {
  bool time = false;
  UsedOfKind x, p, alpha;
};

class SymbolPlaces {
 public:
  SymbolPlaces() = default;
  explicit SymbolPlaces(const ModelSymbols& symbols);
  [[nodiscard]] UsedSymbols used_by(const casadi::SX& expression) const;

 private:
  enum class Kind { time, x, p, alpha };
  struct Place {
    Kind kind;
    std::size_t index;
  };
  std::unordered_map<const void*, Place> places_;
};

}  // namespace saltus::evaluation
