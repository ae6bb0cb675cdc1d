// The embedded pairs: their error norms, and the bounds of their steps.
#pragma once

#include <cmath>
#include <cstddef>

#include "saltus/ode/explicit/dop853_tableau.hpp"
#include "saltus/ode/explicit/dopri5_tableau.hpp"
#include "saltus/ode/explicit/explicit_kernel_internal.hpp"

namespace saltus::ode {

struct Dopri5 {
  using Tableau = Dopri5Tableau;
  static constexpr double stability_limit = 3.25;  ///< of code DOPRI5

  template <class Size>
  static double error_norm(const ExplicitStep& step, const Tolerances& tolerances) {
    return largest_error<Tableau::error, 0, Size>(step, tolerances);
  }

  /// Holds the coefficients of the nested form of the dense output of one component: x + theta (difference + (1 -
  /// theta) (bend + theta (twist + (1 - theta) h last))).
  template <class Value>
  struct Nested {
    Value start, end, difference, bend, twist, last;
  };
  template <class Value>
  static Nested<Value> nested(const ExplicitStep& step, std::size_t n, std::size_t i) {
    const Value start = load<Value>(step.start + i);
    const Value end = load<Value>(step.x_new + i);
    const Value difference = end - start;
    const Value bend = step.h * load<Value>(step.stages + i) - difference;
    const Value twist = difference - step.h * load<Value>(step.stages + (Tableau::stages - 1) * n + i) - bend;
    return {start, end, difference, bend, twist, stage_sum<Tableau::dense, 0, Value>(step.stages, n, i)};
  }

  /// Evaluates the chord, widened by the largest values of the other terms.
  template <class Size>
  static void bounds(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
      const auto terms = nested<Value>(step, n, i);
      const Value width =
          absolute(terms.bend) / 4.0 + absolute(terms.twist) * (4.0 / 27.0) + absolute(step.h * terms.last) / 16.0;
      store(low + i, smaller(terms.start, terms.end) - width);
      store(high + i, larger(terms.start, terms.end) + width);
    });
  }

  /// Bounds (p(theta) - x) / (theta h) = d + (1 - theta) (bend + theta (twist + (1 - theta) h last)) / h with the
  /// chord's slope d: between d and the slope at the start, but for the last two terms.
  template <class Size>
  static void mean_slopes(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
      const auto terms = nested<Value>(step, n, i);
      const Value slope = load<Value>(step.stages + i);
      const Value chord = terms.difference / step.h;
      const Value width = absolute(terms.twist / step.h) / 4.0 + absolute(terms.last) * (4.0 / 27.0);
      store(low + i, smaller(slope, chord) - width);
      store(high + i, larger(slope, chord) + width);
    });
  }
};

struct Dop853 {
  static constexpr std::size_t first_good = 3;  ///< stages 2 and 3 are of low order
  using Tableau = Dop853Tableau;
  static constexpr double stability_limit = dop853_stability_limit;

  /// Returns the estimate of order 5, damped where it is small against a tenth of the one of order 3: Hairer, Norsett &
  /// Wanner, (10.17) of chapter II, with the largest component in place of their mean.
  template <class Size>
  static double error_norm(const ExplicitStep& step, const Tolerances& tolerances) {
    const double fifth = largest_error<Tableau::error, 0, Size>(step, tolerances);
    const double third = largest_error<Tableau::error, 1, Size>(step, tolerances);
    if (fifth == 0.0) return 0.0;
    const double ratio_of_both = 0.1 * (third / fifth);
    return fifth / std::sqrt(1.0 + ratio_of_both * ratio_of_both);
  }

  // Let d = (x_new - x) / h be the chord's slope, R = h max |k_i - d| over the stages and p the dense output. Then p' -
  // d is a polynomial of degree 6 and mean 0 on the step. What it is at most at the nodes of stages 1, 4, 8 to 12 (0,
  // 0.118, 0.308, 0.651, 0.6, 0.857, 1) bounds |p - chord| by 0.4903 times as much, by interpolation there. The stages'
  // slopes are those of p up to terms of higher order in h. The bound used is R itself, twice that, over stages 1 and 4
  // to 12.
  template <class Size>
  static void bounds(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    const double h = step.h;
    for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
      const Value begin = load<Value>(step.start + i);
      const Value end = load<Value>(step.x_new + i);
      const Value difference = end - begin;
      Value width = absolute(h * load<Value>(step.stages + i) - difference);
      for (std::size_t stage = first_good; stage < Tableau::stages; ++stage) {
        width = larger(width, absolute(h * load<Value>(step.stages + stage * n + i) - difference));
      }
      store(low + i, smaller(begin, end) - width);
      store(high + i, larger(begin, end) + width);
    });
  }

  // Let p' be interpolated at the nodes of stages 1, 4, 8, 10, 11, 12. Its mean over [0, theta] has weights of sum 1,
  // of which the negative ones come to 0.199 at most. So it lies between the least and the largest of these slopes but
  // for 0.199 times their distance; the bound used is half of it, over stages 1 and 4 to 12.
  template <class Size>
  static void mean_slopes(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
      Value least = load<Value>(step.stages + i);
      Value largest = least;
      for (std::size_t stage = first_good; stage < Tableau::stages; ++stage) {
        const Value slope = load<Value>(step.stages + stage * n + i);
        least = smaller(least, slope);
        largest = larger(largest, slope);
      }
      const Value width = 0.5 * (largest - least);
      store(low + i, least - width);
      store(high + i, largest + width);
    });
  }
};

}  // namespace saltus::ode
