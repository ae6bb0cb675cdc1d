#include "saltus/fesd_integrator/watch/held_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/ode/bernstein.hpp"

namespace saltus::fesd_integrator {

HeldValues::HeldValues(const discretization::PointFunctions& functions, const std::vector<HeldFact>& facts)
    : functions_(functions),
      facts_(facts),
      values_(facts.size(), 0.0),
      arguments_(facts.size(), 0.0),
      next_(facts.size(), 0.0),
      signs_(facts.size(), 0.0),
      cells_(facts.size(), 0) {}

void HeldValues::update_arguments(double t, const double* x) {
  functions_.held_arguments(t, x, values_.data(), arguments_.data());
}

HeldValues::Change HeldValues::set_behind(double t, double reach, const double* x) {
  if (facts_.empty()) return Change::none;
  next_ = values_;
  const double behind = t + std::max(1e-9 * reach, 4.0 * rounding_unit * std::abs(t));
  for (std::size_t k = 0; k < facts_.size(); ++k) {
    update_arguments(behind, x);  // each depends on those before it
    const double argument = arguments_[k];
    if (facts_[k].cell) {
      cells_[k] = facts_[k].table->cell(argument);
      values_[k] = facts_[k].table->constant(cells_[k], facts_[k].column);
    } else {
      signs_[k] = argument > 0.0 ? 1.0 : argument < 0.0 ? -1.0 : 0.0;
      values_[k] = argument > 0.0 ? 1.0 : argument < 0.0 ? 0.0 : facts_[k].at_zero;
    }
  }
  return next_ == values_ ? Change::none : Change::some;
}

/// How far the argument is from one of the ends of where it is: positive inside.
double HeldValues::distance(std::size_t symbol, int bound) const {
  const auto& fact = facts_[symbol];
  if (!fact.cell) return signs_[symbol] * arguments_[symbol];
  return bound == 0 ? arguments_[symbol] - fact.table->lower(cells_[symbol])
                    : fact.table->upper(cells_[symbol]) - arguments_[symbol];
}

double HeldValues::refined(std::size_t symbol, int bound, double lower, double upper, const double* x) {
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (lower + upper);
    if (!(lower < middle && middle < upper)) break;
    update_arguments(middle, x);
    (distance(symbol, bound) > 0.0 ? lower : upper) = middle;
  }
  return upper;
}

double HeldValues::next_change(double t, double end, const double* x) {
  double first = end;
  next_changing_.reset();
  constexpr int pieces = 4;
  const auto& nodes = ode::interpolation_nodes();
  for (int piece = 0; piece < pieces && first == end && !facts_.empty(); ++piece) {
    const double begin = t + (end - t) * piece / pieces, length = (end - t) / pieces;
    for (std::size_t k = 0; k < facts_.size(); ++k) {
      for (int bound = 0; bound < (facts_[k].cell ? 2 : 1); ++bound) {
        std::array<double, ode::event_nodes> values{};
        double largest = 0.0;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          update_arguments(begin + nodes[i] * length, x);
          values[i] = distance(k, bound);
          largest = std::max({largest, std::abs(values[i]), std::abs(arguments_[k])});
        }
        if (!std::isfinite(largest)) continue;  // the end of an unbounded cell
        const double noise = 8.0 * rounding_unit * largest;
        const auto polynomial = ode::to_bernstein(values);
        const int zero_order = std::abs(values.front()) <= noise ? 1 : 0;
        const auto change = ode::first_sign_change(polynomial, 1, zero_order, noise);
        if (!change) continue;
        const double lower = begin + std::max(0.0, change->lower - 1e-3) * length;
        const double upper = begin + std::min(1.0, change->upper + 1e-3) * length;
        const double at = refined(k, bound, std::max(lower, t), upper, x);
        if (!(at > t) || at > first || (at == first && next_changing_)) continue;
        first = at;
        next_changing_ = k;
      }
    }
  }
  return end - first <= 4.0 * rounding_unit * std::max(std::abs(end), std::abs(t)) ? end : first;
}

}  // namespace saltus::fesd_integrator
