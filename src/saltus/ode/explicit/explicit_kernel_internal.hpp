// Explicit Runge-Kutta steps whose coefficients, and for few states also their number n, are known to the compiler.
//
// `Size` is std::integral_constant<std::size_t, n>, or AnySize: the sums are the same, term by term.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include "saltus/ode/explicit/explicit_method_internal.hpp"
#include "saltus/ode/explicit/lanes_internal.hpp"
#include "saltus/ode/explicit/stage_sums_internal.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {

struct AnySize {};

template <class Size>
inline std::size_t size_of(const ExplicitStep& step) {
  if constexpr (std::is_same_v<Size, AnySize>) {
    return step.n;
  } else {
    return Size::value;
  }
}

/// Evaluates x + h times the sum of the stages with the weights of a row of the tableau.
template <class Tableau, std::size_t row, class Size>
inline void advance(const ExplicitStep& step, double* __restrict result) {
  const std::size_t n = size_of<Size>(step);
  const double* x = step.start;
  const double* stages = step.stages;
  const double h = step.h;
  for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
    store(result + i, load<Value>(x + i) + h * stage_sum<Tableau::a, row, Value>(stages, n, i));
  });
}

/// Evaluates one stage at the argument it leaves behind; false if its slope, the first or the last argument is not
/// finite. Overflow between them shows in the slopes, or belongs to a model that does not mind.
template <class Tableau, std::size_t row, class Size>
inline bool evaluate_stage(const ExplicitStep& step, const StageWork& work, double* argument) {
  const std::size_t n = size_of<Size>(step);
  advance<Tableau, row, Size>(step, argument);
  if constexpr (row == 1 || row + 1 == Tableau::stages) {
    if (!all_finite(argument, n)) return false;
  }
  double* slope = work.stages + row * n;
  work.f(step.t + Tableau::c[row] * step.h, argument, slope);
  ++work.evaluations;
  return all_finite(slope, n);
}

/// Evaluates stages first, first + 1, ...; stops at the first one that is not finite.
template <class Tableau, std::size_t first, class Size, std::size_t... offset>
inline bool evaluate_stages(const ExplicitStep& step, const StageWork& work, std::index_sequence<offset...>) {
  return (evaluate_stage<Tableau, first + offset, Size>(step, work, work.argument) && ...);
}

/// Returns the largest component of an embedded error estimate in units of its scale. The largest, not the mean: a
/// state that slides or rests has no error and must not buy the others a larger one. NaN if a component is (overflow),
/// which a comparison would pass over.
template <const auto& rows, std::size_t row, class Size>
inline double largest_error(const ExplicitStep& step, const Tolerances& tolerances) {
  const std::size_t n = size_of<Size>(step);
  const double* stages = step.stages;
  const double h = step.h;
  double largest = 0.0;
  double sum = 0.0;
  for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
    const Value scale = error_scale(tolerances, load<Value>(step.start + i), load<Value>(step.x_new + i));
    const Value ratio = absolute(h * stage_sum<rows, row, Value>(stages, n, i)) / scale;
    largest = larger(largest, largest_lane(ratio));
    sum += sum_of_lanes(ratio);
  });
  return std::isnan(sum) ? sum : largest;
}

/// Evaluates coefficients 0 to 3 of the nested form: the cubic Hermite interpolant of both ends.
template <std::size_t last, class Size>
inline void hermite_coefficients(const ExplicitStep& step, double* __restrict result) {
  const std::size_t n = size_of<Size>(step);
  const double* slope_new = step.stages + last * n;
  const double h = step.h;
  for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
    const Value start = load<Value>(step.start + i);
    const Value difference = load<Value>(step.x_new + i) - start;
    const Value bend = h * load<Value>(step.stages + i) - difference;
    store(result + i, start);
    store(result + n + i, difference);
    store(result + 2 * n + i, bend);
    store(result + 3 * n + i, difference - h * load<Value>(slope_new + i) - bend);
  });
}
constexpr std::size_t hermite_count = 4;

/// Evaluates row `row` of the dense output's own weights, times h.
template <class Tableau, std::size_t row, class Size>
inline void dense_row(const ExplicitStep& step, double* __restrict result) {
  const std::size_t n = size_of<Size>(step);
  const double* stages = step.stages;
  const double h = step.h;
  for_lanes(n, [&]<class Value>(Lanes<Value>, std::size_t i) {
    store(result + i, h * stage_sum<Tableau::dense, row, Value>(stages, n, i));
  });
}

template <class Tableau, class Size, std::size_t... row>
inline void dense_rows(const ExplicitStep& step, double* result, std::index_sequence<row...>) {
  (dense_row<Tableau, row, Size>(step, result + row * size_of<Size>(step)), ...);
}

/// Holds the functions of one method; `Method` has its Tableau, error_norm, bounds, mean_slopes and stability_limit.
template <class Method, class Size>
struct ExplicitKernel {
  using Tableau = typename Method::Tableau;
  static constexpr std::size_t last = Tableau::stages - 1;

  static bool take(const ExplicitStep& step, const StageWork& work, const Tolerances& tolerances, double& error_norm) {
    const bool finite = evaluate_stages<Tableau, 1, Size>(step, work, std::make_index_sequence<last - 1>{}) &&
                        evaluate_stage<Tableau, last, Size>(step, work, work.x_new);
    if (!finite) return false;
    error_norm = Method::template error_norm<Size>(step, tolerances);
    return true;
  }

  static bool dense(const ExplicitStep& step, const StageWork& work, double* coefficients) {
    constexpr auto further = std::make_index_sequence<Tableau::dense_stages - Tableau::stages>{};
    hermite_coefficients<last, Size>(step, coefficients);
    double* upper = coefficients + hermite_count * size_of<Size>(step);
    if (!evaluate_stages<Tableau, Tableau::stages, Size>(step, work, further)) {
      std::fill_n(upper, Tableau::dense.size() * size_of<Size>(step), 0.0);
      return false;
    }
    dense_rows<Tableau, Size>(step, upper, std::make_index_sequence<Tableau::dense.size()>{});
    return true;
  }

  /// Returns h |k_last - k_before| / |x_new - x_before|, both stages at t + h, in units of the tolerances: about h
  /// times the largest eigenvalue. In other units a large component that moves slowly hides a small one that is stiff.
  static double stability_ratio(const ExplicitStep& step, const Tolerances& tolerances) {
    const std::size_t n = size_of<Size>(step);
    const double* stages = step.stages;
    double slopes = 0.0, states = 0.0, size = 0.0;  // squares
    for (std::size_t i = 0; i < n; ++i) {
      const double before = step.start[i] + step.h * stage_sum<Tableau::a, last - 1>(stages, n, i);
      const double unit = error_scale(tolerances, step.start[i], step.x_new[i]);
      const double slope = (stages[last * n + i] - stages[(last - 1) * n + i]) / unit;
      const double state = (step.x_new[i] - before) / unit;
      slopes += slope * slope;
      states += state * state;
      size += step.x_new[i] * step.x_new[i] / (unit * unit);
    }
    constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
    if (!(states > rounding * rounding * size)) return 0.0;
    return std::abs(step.h) * std::sqrt(slopes / states) / Method::stability_limit;
  }

  static constexpr ExplicitMethod method{take,
                                         Method::template error_norm<Size>,
                                         Method::template bounds<Size>,
                                         Method::template mean_slopes<Size>,
                                         dense,
                                         stability_ratio,
                                         last,
                                         Tableau::dense_stages};
};

}  // namespace saltus::ode
