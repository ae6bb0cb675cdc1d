#include <algorithm>
#include <utility>

#include <casadi/core/sx_elem.hpp>

#include "saltus/evaluation/sparse/used_symbols_internal.hpp"

namespace saltus::evaluation {

SymbolPlaces::SymbolPlaces(const ModelSymbols& symbols) {
  const auto note = [&](const casadi::SX& of_kind, Kind kind) {
    std::size_t index = 0;
    for (const auto& symbol : of_kind.nonzeros()) places_.emplace(symbol.get(), Place{kind, index++});
  };
  note(symbols.t, Kind::time);
  note(symbols.x, Kind::x);
  note(symbols.p, Kind::p);
  note(symbols.alpha, Kind::alpha);
}

UsedSymbols SymbolPlaces::used_by(const casadi::SX& expression) const {
  using Entries = std::vector<std::pair<std::size_t, casadi::SXElem>>;
  UsedSymbols used;
  Entries x, p, alpha;
  for (const auto& symbol : casadi::SX::symvar(expression)) {
    const auto element = symbol.scalar();
    const auto found = places_.find(element.get());
    if (found == places_.end()) continue;
    const auto [kind, index] = found->second;
    if (kind == Kind::time) used.time = true;
    if (kind == Kind::x) x.emplace_back(index, element);
    if (kind == Kind::p) p.emplace_back(index, element);
    if (kind == Kind::alpha) alpha.emplace_back(index, element);
  }
  const auto sorted = [](Entries& entries) {
    std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    UsedOfKind result;
    std::vector<casadi::SXElem> symbols;
    for (const auto& [index, symbol] : entries) {
      result.place.push_back(index);
      symbols.push_back(symbol);
    }
    result.symbols = symbols.empty() ? casadi::SX(0, 1) : casadi::SX(symbols);
    return result;
  };
  used.x = sorted(x);
  used.p = sorted(p);
  used.alpha = sorted(alpha);
  return used;
}

}  // namespace saltus::evaluation
