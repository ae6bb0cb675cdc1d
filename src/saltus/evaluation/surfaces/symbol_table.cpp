#include <map>

#include "saltus/evaluation/surfaces/symbol_table_internal.hpp"

namespace saltus::evaluation {

using casadi::SX;
using casadi::SXElem;

void SymbolTable::add(Kind kind, const SX& symbols) {
  int place = 0;
  for (const auto& symbol : symbols.nonzeros()) known_.emplace(symbol.get(), std::pair{kind, place++});
}

SymbolTable::Used SymbolTable::used(const SX& expression, Kind kind) const {
  std::map<int, SXElem> found;
  for (const auto& symbol : SX::symvar(expression)) {
    const auto known = known_.find(symbol.scalar().get());
    if (known != known_.end() && known->second.first == kind) found.emplace(known->second.second, symbol.scalar());
  }
  Used used;
  for (const auto& [place, symbol] : found) {
    used.places.push_back(place);
    used.symbols.push_back(symbol);
  }
  return used;
}

SX SymbolTable::with_values(const SX& expression, Kind kind, const SX& values) const {
  const auto replaced = used(expression, kind);
  if (replaced.places.empty()) return expression;
  std::vector<SXElem> by;
  for (const int place : replaced.places) by.push_back(values(place).scalar());
  return SX::substitute(expression, SX(replaced.symbols), SX(by));
}

}  // namespace saltus::evaluation
