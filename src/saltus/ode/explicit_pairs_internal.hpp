// The embedded pairs: their error norms, and the bounds of their steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "saltus/ode/dop853_tableau.hpp"
#include "saltus/ode/dopri5_tableau.hpp"
#include "saltus/ode/explicit_kernel_internal.hpp"

namespace saltus::ode {

struct Dopri5 {
  using Tableau = Dopri5Tableau;
  static constexpr double stability_limit = 3.25;  ///< of code DOPRI5

  template <class Size>
  static double error_norm(const ExplicitStep& step, const ErrorScale& scale, double* ratio) {
    return largest_error<Tableau::error, 0, Size>(step, scale, ratio);
  }

  /// Of the nested form of the dense output of one component: x + theta (difference + (1 - theta) (bend + theta (twist
  /// + (1 - theta) h last))).
  struct Nested {
    double difference, bend, twist, last;
  };
  static Nested nested(const ExplicitStep& step, std::size_t n, std::size_t i) {
    const double difference = step.x_new[i] - step.start[i];
    const double bend = step.h * step.stages[i] - difference;
    const double twist = difference - step.h * step.stages[(Tableau::stages - 1) * n + i] - bend;
    return {difference, bend, twist, stage_sum<Tableau::dense, 0>(step.stages, n, i)};
  }

  /// The chord, widened by the largest values of the other terms.
  template <class Size>
  static void bounds(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    for (std::size_t i = 0; i < n; ++i) {
      const Nested terms = nested(step, n, i);
      const double width =
          std::abs(terms.bend) / 4.0 + std::abs(terms.twist) * (4.0 / 27.0) + std::abs(step.h * terms.last) / 16.0;
      low[i] = std::min(step.start[i], step.x_new[i]) - width;
      high[i] = std::max(step.start[i], step.x_new[i]) + width;
    }
  }

  /// (p(theta) - x) / (theta h) = d + (1 - theta) (bend + theta (twist + (1 - theta) h last)) / h with the chord's
  /// slope d: between d and the slope at the start, but for the last two terms.
  template <class Size>
  static void mean_slopes(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    for (std::size_t i = 0; i < n; ++i) {
      const Nested terms = nested(step, n, i);
      const double slope = step.stages[i];
      const double chord = terms.difference / step.h;
      const double width = std::abs(terms.twist / step.h) / 4.0 + std::abs(terms.last) * (4.0 / 27.0);
      low[i] = std::min(slope, chord) - width;
      high[i] = std::max(slope, chord) + width;
    }
  }
};

struct Dop853 {
  static constexpr std::size_t first_good = 3;  ///< stages 2 and 3 are of low order
  using Tableau = Dop853Tableau;
  static constexpr double stability_limit = 6.1;  ///< of code DOP853

  /// The estimate of order 5, damped where it is small against a tenth of the one of order 3: Hairer, Norsett & Wanner,
  /// (10.17) of chapter II, with the largest component in place of their mean.
  template <class Size>
  static double error_norm(const ExplicitStep& step, const ErrorScale& scale, double* ratio) {
    const double fifth = largest_error<Tableau::error, 0, Size>(step, scale, ratio);
    const double third = largest_error<Tableau::error, 1, Size>(step, scale, ratio);
    if (fifth == 0.0) return 0.0;
    const double ratio_of_both = 0.1 * (third / fifth);
    return fifth / std::sqrt(1.0 + ratio_of_both * ratio_of_both);
  }

  // With the chord's slope d = (x_new - x) / h, R = h max |k_i - d| over the stages and p the dense output, p' - d is a
  // polynomial of degree 6 and mean 0 on the step. What it is at most at the nodes of stages 1, 4, 8 to 12 (0, 0.118,
  // 0.308, 0.651, 0.6, 0.857, 1) bounds |p - chord| by 0.4903 times as much, by interpolation there; the stages' slopes
  // are those of p up to terms of higher order in h, and the bound used is R itself, twice that, over stages 1 and 4
  // to 12.
  template <class Size>
  static void bounds(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    const double h = step.h;
    for (std::size_t i = 0; i < n; ++i) {
      const double begin = step.start[i];
      const double end = step.x_new[i];
      const double difference = end - begin;
      double width = std::abs(h * step.stages[i] - difference);
      for (std::size_t stage = first_good; stage < Tableau::stages; ++stage) {
        width = std::max(width, std::abs(h * step.stages[stage * n + i] - difference));
      }
      low[i] = std::min(begin, end) - width;
      high[i] = std::max(begin, end) + width;
    }
  }

  // The mean of p' over [0, theta], p' interpolated at the nodes of stages 1, 4, 8, 10, 11, 12, has weights of sum 1,
  // of which the negative ones come to 0.199 at most. So it lies between the least and the largest of these slopes but
  // for 0.199 times their distance; the bound used is half of it, over stages 1 and 4 to 12.
  template <class Size>
  static void mean_slopes(const ExplicitStep& step, double* __restrict low, double* __restrict high) {
    const std::size_t n = size_of<Size>(step);
    for (std::size_t i = 0; i < n; ++i) {
      double least = step.stages[i];
      double largest = least;
      for (std::size_t stage = first_good; stage < Tableau::stages; ++stage) {
        least = std::min(least, step.stages[stage * n + i]);
        largest = std::max(largest, step.stages[stage * n + i]);
      }
      const double width = 0.5 * (largest - least);
      low[i] = least - width;
      high[i] = largest + width;
    }
  }
};

}  // namespace saltus::ode
