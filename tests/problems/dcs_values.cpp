#include "problems/dcs_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <casadi/core/function.hpp>

#include "unit/reformulation/dcs_tools.hpp"

namespace saltus::problems {
namespace {

using casadi::DM;
using casadi::SX;
using model::System;
using reformulation::Dcs;
using reformulation::DcsPart;
using reformulation::HeldSymbol;

std::vector<double> call(const std::vector<SX>& symbols, const SX& expression, const std::vector<DM>& point) {
  const casadi::Function function("values", symbols, {SX::densify(expression)});
  return std::vector<double>(function(point).front());
}

double step(double psi) { return psi > 0.0 ? 1.0 : psi < 0.0 ? 0.0 : 0.5; }

/// The position of the smallest, and how far the next one is.
std::size_t smallest(const std::vector<double>& g, double& nearest) {
  const auto best = std::min_element(g.begin(), g.end());
  for (auto other = g.begin(); other != g.end(); ++other) {
    if (other != best) nearest = std::min(nearest, *other - *best);
  }
  return static_cast<std::size_t>(best - g.begin());
}

/// The symbols of a System beside t, x, u, p, alpha: constants of cells, references of groups.
class FurtherSymbols {
 public:
  explicit FurtherSymbols(const System& system) {
    std::vector<SX> all;
    for (const auto& cell : system.cells) all.push_back(cell.symbols);
    for (const auto& group : system.mode_groups) all.push_back(group.reference);
    symbols = SX::vertcat(all);
    values.assign(static_cast<std::size_t>(symbols.numel()), 0.0);
  }
  SX symbols;
  std::vector<double> values;
};

}  // namespace

SystemValues values_at(const System& system, const SmoothPoint& point) {
  FurtherSymbols further(system);
  SystemValues result;
  result.nearest = std::numeric_limits<double>::infinity();
  result.alpha.assign(system.switching.size(), 0.0);
  const auto value = [&](const SX& expression) {
    return call(
        {system.t, system.x, system.u, system.p, system.alpha, further.symbols}, expression,
        {DM(point.t), DM(point.x), DM(point.u), DM(system.parameter_values), DM(result.alpha), DM(further.values)});
  };
  std::size_t next = 0;
  for (const auto& cell : system.cells) {
    const long k = cell.table->cell(value(cell.argument).front());
    for (int column = 0; column < cell.table->columns; ++column)
      further.values[next++] = cell.table->constant(k, column);
  }
  for (std::size_t j = 0; j < system.switching.size(); ++j) {
    const auto& function = system.switching[j];
    if (function.role == model::SwitchingRole::region) continue;
    const double psi = value(function.psi).front();
    result.nearest = std::min(result.nearest, std::abs(psi));
    result.alpha[j] = psi == 0.0 ? function.alpha_at_zero : step(psi);
  }
  for (const auto& group : system.mode_groups) {
    if (group.first < 0) continue;
    std::vector<double> g;
    for (int i = 0; i < group.regions; ++i) {
      g.push_back(-value(system.switching[static_cast<std::size_t>(group.first + i)].psi).front());
    }
    const std::size_t active = smallest(g, result.nearest);
    further.values[next + active] = 1.0;
    result.alpha[static_cast<std::size_t>(group.first) + active] = 1.0;
    next += static_cast<std::size_t>(group.regions);
  }
  result.f = value(system.f);
  result.outputs = value(system.outputs);
  return result;
}

std::vector<double> evaluated(const Dcs& dcs, const System& system, const SX& expression, const SmoothPoint& point,
                              const DcsValues& values) {
  return call({dcs.t, dcs.x, dcs.u, dcs.p, dcs.selection, dcs.lifted, dcs.held}, expression,
              {DM(point.t), DM(point.x), DM(point.u), DM(system.parameter_values), DM(values.selection),
               DM(values.lifted), DM(values.held)});
}

DcsValues values_at(const Dcs& dcs, const System& system, const SmoothPoint& point) {
  DcsValues result;
  result.nearest = std::numeric_limits<double>::infinity();
  result.held.assign(dcs.held_symbols.size(), 0.0);
  result.selection.assign(static_cast<std::size_t>(dcs.selection.numel()), 0.0);
  result.lifted.assign(static_cast<std::size_t>(dcs.lifted.numel()), 0.0);
  const auto value = [&](const SX& expression) { return evaluated(dcs, system, expression, point, result); };
  for (std::size_t k = 0; k < result.held.size(); ++k) {
    const HeldSymbol& held = dcs.held_symbols[k];
    const double argument = value(held.argument).front();
    if (held.kind == HeldSymbol::Kind::selection) {
      result.held[k] = argument == 0.0 ? held.at_zero : step(argument);
      continue;
    }
    const auto& table = *system.cells[static_cast<std::size_t>(held.index)].table;
    result.held[k] = table.constant(table.cell(argument), held.column);
  }
  const auto indicator = value(dcs.indicator);
  for (const DcsPart& part : dcs.parts) {
    const auto first = static_cast<std::size_t>(part.first), count = static_cast<std::size_t>(part.count);
    if (part.form == reformulation::Form::stewart) {
      const std::vector<double> g(indicator.begin() + part.first, indicator.begin() + part.first + part.count);
      result.selection[first + smallest(g, result.nearest)] = 1.0;
      continue;
    }
    for (std::size_t j = first; j < first + count; ++j) {
      result.selection[j] = step(indicator[j]);
      result.nearest = std::min(result.nearest, std::abs(indicator[j]));
    }
  }
  result.lifted = reformulation::lifted_at(dcs, result.selection);
  result.f = value(dcs.f);
  result.alpha = value(dcs.alpha);
  result.outputs = value(dcs.outputs);
  result.surface_alpha = value(dcs.surface_alpha);
  return result;
}

SmoothPoint random_point(const System& system, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  SmoothPoint point;
  point.t = 3.0 * std::abs(uniform(random));
  for (const double initial : system.initial_state)
    point.x.push_back(initial + uniform(random) * (1.0 + std::abs(initial)));
  for (const double initial : system.control_initial) point.u.push_back(initial + uniform(random));
  return point;
}

}  // namespace saltus::problems
