#include <algorithm>
#include <limits>

#include "saltus/discretization/element_expressions_internal.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;

/// Sums over the points of the elements before and after a boundary, one row per pair.
struct Sums {
  SX a_before, a_after, lambda_before, lambda_after;
};

Sums sums_of(const Boundary& boundary) {
  return {SX::sum2(boundary.before.a), SX::sum2(boundary.after.a), SX::sum2(boundary.before.lambda),
          SX::sum2(boundary.after.lambda)};
}

SX product(const SX& factors) {
  SX result = 1.0;
  for (casadi_int i = 0; i < factors.numel(); ++i) result *= factors(i);
  return result;
}

/// Variables of a boundary in mode mlcp: per pair the minima q of both sides with their multipliers, and the
/// multipliers of the minimum over all pairs; that minimum; both parts of h_n - h_(n-1).
struct LogicVariables {
  SX q_a, q_lambda, m_a, m_lambda, weight, minimum, longer, shorter;

  LogicVariables(const SX& own, casadi_int pairs) {
    casadi_int next = 0;
    const auto take = [&](casadi_int count) {
      const SX part = own(casadi::Slice(next, next + count));
      next += count;
      return part;
    };
    q_a = take(pairs);
    q_lambda = take(pairs);
    m_a = take(pairs);
    m_lambda = take(pairs);
    weight = take(pairs);
    minimum = take(1);
    longer = take(1);
    shorter = take(1);
  }
};

/// q = min(b, f): the largest q below both, multipliers m and 1 - m.
void add_minimum(const SX& q, const SX& m, const SX& b, const SX& f, LocalExpressions& expressions) {
  expressions.pair(b - q, m, mpcc::Sign::constrained);
  expressions.pair(f - q, 1.0 - m, mpcc::Sign::constrained);
}

void add_logic(const Boundary& boundary, LocalExpressions& expressions) {
  const Sums s = sums_of(boundary);
  const casadi_int pairs = s.a_before.numel();
  const LogicVariables v(boundary.own, pairs);
  for (casadi_int k = 0; k < pairs; ++k) {
    add_minimum(v.q_a(k), v.m_a(k), s.a_before(k), s.a_after(k), expressions);
    add_minimum(v.q_lambda(k), v.m_lambda(k), s.lambda_before(k), s.lambda_after(k), expressions);
    expressions.pair(v.q_a(k) + v.q_lambda(k) - v.minimum, v.weight(k), mpcc::Sign::constrained);
  }
  expressions.equation(SX::sum1(v.weight) - 1.0);
  expressions.equation(boundary.h_after - boundary.h_before - v.longer + v.shorter);
  expressions.pair(v.longer + v.shorter, v.minimum);
  expressions.pair(v.longer, v.shorter);
}

}  // namespace

SX switch_indicator(const Boundary& boundary) {
  const Sums s = sums_of(boundary);
  return product(s.a_before * s.a_after + s.lambda_before * s.lambda_after);
}

SX printed_switch_indicator(const std::vector<SelectionPair>& kinds, const Boundary& boundary) {
  const Sums s = sums_of(boundary);
  const SX of_lambda = s.lambda_before * s.lambda_after;
  const SX of_a = s.a_before * s.a_after;
  SX eta = 1.0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto row = static_cast<casadi_int>(k);
    if (kinds[k].is_region) {
      eta *= of_a(row) + of_lambda(row);
    } else if (!kinds[k].complement) {  // lambda_n here, lambda_p in the next row
      eta *= of_lambda(row) + of_lambda(row + 1);
    }
  }
  return eta;
}

mpcc::Bounds boundary_bounds(StepEquilibration mode, int pairs) {
  if (mode != StepEquilibration::mlcp || pairs == 0) return {linalg::Vector(0), linalg::Vector(0)};
  const double infinity = std::numeric_limits<double>::infinity();
  mpcc::Bounds bounds{linalg::Vector::zero(5 * pairs + 3), linalg::Vector::constant(5 * pairs + 3, infinity)};
  bounds.upper.segment(2 * pairs, 3 * pairs).set_constant(1.0);  // multipliers of minima
  return bounds;
}

linalg::Vector boundary_values(const linalg::Vector& first_sides, double difference) {
  const linalg::Index pairs = (first_sides.size() - 2) / 5;
  linalg::Vector own = linalg::Vector::zero(5 * pairs + 3);
  linalg::Index smallest = 0;
  double minimum = std::numeric_limits<double>::infinity();
  for (linalg::Index k = 0; k < pairs; ++k) {
    const auto sums = first_sides.segment(5 * k, 4).at_least(0.0);
    own[k] = std::min(sums[0], sums[1]);
    own[pairs + k] = std::min(sums[2], sums[3]);
    own[2 * pairs + k] = sums[0] <= sums[1] ? 1.0 : 0.0;
    own[3 * pairs + k] = sums[2] <= sums[3] ? 1.0 : 0.0;
    if (own[k] + own[pairs + k] >= minimum) continue;
    minimum = own[k] + own[pairs + k];
    smallest = k;
  }
  own[4 * pairs + smallest] = 1.0;
  own.tail(3) = {minimum, std::max(difference, 0.0), std::max(-difference, 0.0)};
  return own;
}

void add_step_equilibration(const FesdOptions& options, const std::vector<SelectionPair>& kinds,
                            const Boundary& boundary, LocalExpressions& expressions) {
  const SX difference = boundary.h_after - boundary.h_before;
  switch (options.step_equilibration) {
    case StepEquilibration::none:
    case StepEquilibration::heuristic_mean:  // belongs to elements
      return;
    case StepEquilibration::heuristic_diff:
      expressions.objective = options.rho_h * SX::sq(difference);
      return;
    case StepEquilibration::l2_relaxed:
      expressions.objective = options.rho_h * switch_indicator(boundary) * SX::sq(difference);
      return;
    case StepEquilibration::l2_relaxed_scaled:
      expressions.objective =
          options.rho_h * SX::tanh(switch_indicator(boundary) / options.sigma_h) * SX::sq(difference);
      return;
    case StepEquilibration::direct:
      expressions.equation(switch_indicator(boundary) * difference);
      return;
    case StepEquilibration::mlcp:
      if (kinds.empty()) {
        expressions.equation(difference);
      } else {
        add_logic(boundary, expressions);
      }
      return;
    case StepEquilibration::paper:
      expressions.equation(printed_switch_indicator(kinds, boundary) * difference);
      return;
  }
}

}  // namespace saltus::discretization
