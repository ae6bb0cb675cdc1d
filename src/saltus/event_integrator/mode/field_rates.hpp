// Rates of event functions along a field.
#pragma once

#include <cmath>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/position.hpp"

namespace saltus::event_integrator {

/// Holds dg/dt with what its rounding follows from.
struct Rate {
  double value = 0.0;
  double terms = 0.0;      ///< the sum of the sizes of its terms
  double magnitude = 0.0;  ///< the size of the terms of g
  double slope = 0.0;      ///< sum of |d_i g|
};

/// Returns d_t g + grad g . field at (t, x); 0 times infinity is 0. `row` takes grad g.
[[nodiscard]] inline Rate rate_along(const evaluation::ModelKernel& kernel, int function, double t,
                                     const std::vector<double>& x, const std::vector<double>& alpha,
                                     const std::vector<double>& field, evaluation::AffineRow& row) {
  Rate rate;
  kernel.gradient(function, t, x.data(), alpha.data(), row);
  rate.value = row.rate;
  rate.terms = std::abs(rate.value);
  rate.magnitude = rate.value == 0.0 ? 0.0 : std::abs(rate.value * t);
  for (std::size_t k = 0; k < row.column.size(); ++k) {
    const double coefficient = row.coefficient[k];
    if (coefficient == 0.0) continue;
    const double term = coefficient * field[row.column[k]];
    rate.value += term;
    rate.magnitude += std::abs(coefficient * x[row.column[k]]);
    rate.terms += std::abs(term);
    rate.slope += std::abs(coefficient);
  }
  return rate;
}

/// FieldRates differentiates event functions along fields, with the selections of a position.
class FieldRates {
 public:
  FieldRates(const evaluation::ModelKernel& kernel, const Position& here) : kernel_(kernel), here_(here) {}

  /// Returns the rate at the position along its slope.
  [[nodiscard]] Rate here(int function) { return along(function, here_.slope); }
  /// Returns the rate at the position along another field.
  [[nodiscard]] Rate along(int function, const std::vector<double>& field) {
    return at(function, here_.t, here_.x, field);
  }
  /// Returns d_t g + grad g . field at (t, x); 0 times infinity is 0.
  [[nodiscard]] Rate at(int function, double t, const std::vector<double>& x, const std::vector<double>& field) {
    return rate_along(kernel_, function, t, x, here_.state.alpha, field, row_);
  }

 private:
  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  evaluation::AffineRow row_;  ///< grad g
};

}  // namespace saltus::event_integrator
