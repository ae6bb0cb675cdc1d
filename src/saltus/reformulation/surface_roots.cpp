#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

#include <casadi/core/function.hpp>
#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/reformulation/same_surface_internal.hpp"
#include "saltus/reformulation/surface_roots_internal.hpp"

namespace saltus::reformulation {
namespace {

bool is_guard(const SXElem& e) { return e.op() == casadi::OP_IF_ELSE_ZERO && e.dep(0).op() == casadi::OP_NE; }

/// sign(base) |base|^c; the small number keeps derivatives at 0 finite, and is below rounding for |base| > 1e-14.
SXElem odd_power(const SXElem& base, double exponent) { return base * pow(fabs(base) + 1e-30, exponent - 1.0); }

/// An expression counts on this side of a surface only.
struct Border {
  int surface = 0;
  int side = 1;
};

class RootSearch {
 public:
  RootSearch(const model::System& system, Unnested& unnested) : system_(system), unnested_(unnested), samples_(system) {
    for (const auto& surface : unnested.surfaces) samples_.add(entry(surface.psi), unnested.held);
  }
  [[nodiscard]] SXElem taken_out(const SXElem& expression, const std::vector<Border>& borders);

 private:
  [[nodiscard]] std::optional<double> exponent_of(const SXElem& power) const;
  void add_borders(const SXElem& weight, std::vector<Border>& borders) const;
  [[nodiscard]] SXElem away_from(int surface);
  [[nodiscard]] std::optional<SXElem> on_sides(const SXElem& base, double exponent, const std::vector<Border>& borders);
  [[nodiscard]] std::optional<SXElem> power_of(const SXElem& base, double exponent, const std::vector<Border>& borders);
  [[nodiscard]] SXElem root_of(const SXElem& base, double exponent, int surface);

  const model::System& system_;
  Unnested& unnested_;
  SurfaceSamples samples_;
};

/// Of a power that is no polynomial, and a root at most of parameters: its exponent, if it is > 0.
std::optional<double> RootSearch::exponent_of(const SXElem& power) const {
  if (power.op() == casadi::OP_SQRT) return 0.5;
  if (power.op() != casadi::OP_POW && power.op() != casadi::OP_CONSTPOW) return std::nullopt;
  const auto parameters = symbols_in(system_.p);
  for (const SXElem& symbol : symbols_in(SX(power.dep(1)))) {
    if (std::none_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.get() == symbol.get(); })) {
      return std::nullopt;
    }
  }
  const casadi::Function function("exponent", {system_.p}, {SX(power.dep(1))});
  const auto value = static_cast<double>(function(std::vector<casadi::DM>{system_.parameter_values}).front());
  return value > 0.0 && value != std::floor(value) ? std::optional(value) : std::nullopt;
}

/// The sides of surfaces on whose other side a weight is 0.
void RootSearch::add_borders(const SXElem& weight, std::vector<Border>& borders) const {
  std::unordered_set<const void*> symbols;
  for (const SXElem& symbol : symbols_in(SX(weight))) symbols.insert(symbol.get());
  for (std::size_t j = 0; j < unnested_.surfaces.size(); ++j) {
    const SXElem& symbol = unnested_.surface_symbols[j];
    if (!symbols.contains(symbol.get())) continue;
    for (const double alpha : {0.0, 1.0}) {
      Replacement other_side;
      other_side.set(symbol, alpha);
      if (other_side.of(weight).is_zero()) borders.push_back({static_cast<int>(j), alpha == 0.0 ? 1 : -1});
    }
  }
}

SXElem RootSearch::away_from(int surface) {
  for (const auto& known : unnested_.away) {
    if (known.surface == surface) return known.symbol;
  }
  unnested_.away.push_back({surface, SXElem::sym(fmt::format("away{}", surface))});
  return unnested_.away.back().symbol;
}

SXElem RootSearch::root_of(const SXElem& base, double exponent, int surface) {
  constexpr casadi_int compared_depth = 8;
  for (const auto& known : unnested_.roots) {
    if (known.exponent == exponent && SXElem::is_equal(known.base, base, compared_depth)) return known.symbol;
  }
  unnested_.roots.push_back({SXElem::sym(fmt::format("root{}", unnested_.roots.size())), base, exponent, surface});
  return unnested_.roots.back().symbol;
}

/// base^exponent, if the base is zero at one of the borders; nullopt else.
std::optional<SXElem> RootSearch::power_of(const SXElem& base, double exponent, const std::vector<Border>& borders) {
  if (base.is_zero()) return SXElem(0.0);
  if (borders.empty()) return std::nullopt;
  const auto match = samples_.find(base, unnested_.held);
  if (!match || std::none_of(borders.begin(), borders.end(), [&](const Border& border) {
        return border.surface == match->surface && border.side == match->orientation;
      })) {
    return std::nullopt;
  }
  const SXElem value = exponent < 1.0 ? root_of(base, exponent, match->surface) : odd_power(base, exponent);
  return SXElem::binary(casadi::OP_IF_ELSE_ZERO, away_from(match->surface), value);
}

/// The same for a base that has the selection of a kink in it: |psi| = alpha psi - (1 - alpha) psi.
std::optional<SXElem> RootSearch::on_sides(const SXElem& base, double exponent, const std::vector<Border>& borders) {
  std::vector<int> surfaces;
  for (const SXElem& symbol : symbols_in(SX(base))) {
    for (std::size_t j = 0; j < unnested_.surfaces.size(); ++j) {
      if (unnested_.surface_symbols[j].get() == symbol.get()) surfaces.push_back(static_cast<int>(j));
    }
  }
  if (surfaces.empty()) return power_of(base, exponent, borders);
  if (surfaces.size() > 1) return std::nullopt;
  const SXElem& alpha = unnested_.surface_symbols[at(surfaces.front())];
  SXElem sum = 0.0;
  for (const double side : {1.0, 0.0}) {
    Replacement fixed;
    fixed.set(alpha, side);
    const auto value = power_of(fixed.of(base), exponent, {{surfaces.front(), side > 0.0 ? 1 : -1}});
    if (!value) return std::nullopt;
    const SXElem weight = side > 0.0 ? alpha : 1.0 - alpha;
    sum += SXElem::binary(casadi::OP_IF_ELSE_ZERO, SXElem::binary(casadi::OP_NE, weight, 0.0), weight * *value);
  }
  return sum;
}

SXElem RootSearch::taken_out(const SXElem& expression, const std::vector<Border>& borders) {
  Replacement replacement;
  std::vector<SXElem> open{expression};
  std::unordered_set<const void*> seen;
  while (!open.empty()) {
    const SXElem e = open.back();
    open.pop_back();
    if (e.is_constant() || e.is_symbolic() || !seen.insert(e.get()).second) continue;
    if (is_guard(e)) {
      auto all = borders;
      add_borders(e.dep(0).dep(0), all);
      const SXElem inside = taken_out(e.dep(1), all);
      if (inside.get() != e.dep(1).get()) {
        replacement.set(e, SXElem::binary(casadi::OP_IF_ELSE_ZERO, e.dep(0), inside));
      }
      continue;
    }
    if (const auto exponent = exponent_of(e)) {
      if (const auto value = on_sides(e.dep(0), *exponent, borders)) {
        replacement.set(e, *value);
        continue;
      }
    }
    for (casadi_int i = 0; i < e.n_dep(); ++i) open.push_back(e.dep(i));
  }
  return replacement.empty() ? expression : replacement.of(expression);
}

}  // namespace

void take_roots(const model::System& system, Unnested& unnested) {
  RootSearch search(system, unnested);
  auto f = entries(unnested.f);
  for (SXElem& component : f) component = search.taken_out(component, {});
  if (!unnested.away.empty()) unnested.f = column(f);
}

void finish_roots(const Unnested& unnested, Dcs& dcs) {
  constexpr double rounding = 1e-9;  // of sums of weights
  Replacement away, values;
  for (const auto& [surface, symbol] : unnested.away) {
    const SXElem alpha = entry(dcs.surface_alpha(surface));
    away.set(symbol, fabs(alpha * (1.0 - alpha)) < rounding);  // iterates leave [0, 1]
  }
  dcs.with_roots = away.empty() ? dcs.f : away.of(dcs.f);
  std::vector<SXElem> symbols, bases;
  for (const auto& root : unnested.roots) {
    symbols.push_back(root.symbol);
    bases.push_back(root.base);
    dcs.root_exponents.push_back(root.exponent);
    values.set(root.symbol, odd_power(root.base, root.exponent));
  }
  dcs.roots = column(symbols);
  dcs.root_bases = column(bases);
  dcs.f = values.empty() ? dcs.with_roots : values.of(dcs.with_roots);
}

}  // namespace saltus::reformulation
