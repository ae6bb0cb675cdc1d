// Event functions that are affine in (t, x), and which of them can vanish within a step at all.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Holds bounds of a step: its times, and the states over it, n_x each.
struct StepBounds {
  double begin = 0.0;
  double end = 0.0;
  const double* low = nullptr;
  const double* high = nullptr;
};

/// Holds the forms phi_i(t, x) = offset_i + rate_i t + sum_k a_k x_k, one for every event function of a mode that is
/// affine.
///
/// A loaded row of one state is a threshold of that state. Of the thresholds of a state on the same side only the
/// nearest can be the first to be reached. So a step is compared with two numbers per state, however many thresholds
/// there are. At most these two and what lies beside them are looked at. Owns its memory; allocates while forms are set
/// only.
class AffineForms {
 public:
  explicit AffineForms(std::size_t states);
  /// Loads the rows for use_row, which stay the same from mode to mode.
  void load(const evaluation::AffineRows& rows);
  /// Begins without forms, for `functions` functions; then use_row and set, then group.
  void reset(std::size_t functions);
  /// Makes the form of function i loaded row j; nothing if that row is not affine.
  void use_row(std::size_t i, std::size_t j) { forms_[i] = table_[j]; }
  /// Makes the form of function i row j; nothing if that row is not affine.
  void set(std::size_t i, const evaluation::AffineRows& rows, std::size_t j);
  void set(std::size_t i, const evaluation::AffineRow& row);
  /// Sets, behind group(), the form of a function that is no threshold and is not watched; null where it has none.
  void replace(std::size_t i, const evaluation::AffineRow* row);

  /// Puts the thresholds of each state together when all forms are set. None is watched.
  void group();

  [[nodiscard]] bool has(std::size_t i) const { return forms_[i].known; }
  /// Returns whether the form is a threshold: its value has the roundings of the function itself, up to its factor's.
  [[nodiscard]] bool is_threshold(std::size_t i) const { return forms_[i].threshold; }
  /// Returns the state of a threshold, and its factor.
  [[nodiscard]] std::size_t state(std::size_t i) const { return terms_[forms_[i].first].column; }
  [[nodiscard]] double factor(std::size_t i) const { return terms_[forms_[i].first].coefficient; }
  [[nodiscard]] double value(std::size_t i, double t, const double* x) const;
  /// Returns the same of a threshold, which no time is in.
  [[nodiscard]] double threshold_value(std::size_t i, const double* x) const {
    const auto [column, coefficient] = terms_[forms_[i].first];
    return 0.0 + coefficient * x[column] + forms_[i].offset;
  }
  /// Returns d phi_i / dt along f (n_x); nullopt where that is no more than the rounding of its terms.
  [[nodiscard]] std::optional<double> rate_along(std::size_t i, const double* f) const;
  /// Returns the Bernstein coefficients of the form along a step.
  [[nodiscard]] ode::BernsteinCoefficients along(std::size_t i, const ode::DenseStep& step) const;
  /// Returns the same in the form that the step is kept in.
  [[nodiscard]] ode::NestedPolynomial nested_along(std::size_t i, const ode::DenseStep& step) const;
  /// Holds Bernstein coefficients where the step is a series, with its terms, and what roundings may have changed the
  /// polynomial by.
  struct AlongSeries {
    ode::SeriesCoefficients terms;  ///< of theta^k
    ode::SeriesCoefficients coefficients;
    double rounding = 0.0;
    void subtract(double offset);
    [[nodiscard]] double derivative(double theta) const;
  };
  [[nodiscard]] AlongSeries along_series(std::size_t i, const ode::DenseStep& step) const;
  /// Returns the sum of the sizes of the terms that a value is the sum of, at most this over the step: what its
  /// rounding follows from.
  [[nodiscard]] double terms(std::size_t i, const StepBounds& bounds) const;

  /// Watches no function.
  void watch_none();
  /// Watches function i, whose sign is `sign` (+1, -1): may_vanish and append_suspects look at it from now on.
  void watch(std::size_t i, int sign);
  /// Watches it no longer. Cost: of the nearest threshold of a state, the way to the next one that is watched.
  void ignore(std::size_t i);
  /// Returns whether any watched function may vanish within the bounds; true where a bound is not finite. Cost: O(n_x),
  /// and the terms of the forms of several states.
  [[nodiscard]] bool may_vanish(const StepBounds& bounds) const;
  /// Returns whether function i goes from where the step starts into the sign `sign` at once and stays there. At the
  /// start it is zero or has that sign. Bounds of the mean slopes of the states (in place of their values) tell.
  [[nodiscard]] bool leaves(std::size_t i, int sign, const StepBounds& mean_slopes) const;
  /// Appends the watched functions that may, but for thresholds that are reached behind another one of their state, and
  /// later than that; in no particular order.
  void append_suspects(const StepBounds& bounds, std::vector<std::size_t>& suspects) const;

 private:
  struct Form {
    std::size_t first = 0;  ///< term
    std::size_t count = 0;
    std::size_t room = 0;  ///< for so many
    double rate = 0.0;
    double offset = 0.0;
    int sign = 0;  ///< 0 = not watched
    bool known = false;
    bool threshold = false;
  };
  struct Term {
    std::size_t column = 0;
    double coefficient = 0.0;
  };
  struct Threshold {
    double value = 0.0;
    std::size_t function = 0;
    int side = 0;  ///< of the state while watched: +1 above it, -1 below; 0 = not watched
  };
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  [[nodiscard]] bool reaches_zero(const Form& form, const StepBounds& bounds) const;
  [[nodiscard]] double terms(const Form& form, const StepBounds& bounds) const;
  void set_nearest_below(std::size_t state, std::size_t place);
  void set_nearest_above(std::size_t state, std::size_t place);

  Form form_of(const evaluation::AffineRows& rows, std::size_t j);

  std::vector<Form> table_;  ///< loaded rows
  std::size_t loaded_terms_ = 0;
  std::vector<Form> forms_;  ///< one per function
  std::vector<Term> terms_;
  std::vector<Threshold> thresholds_;       ///< state by state, ascending
  std::vector<std::size_t> first_;          ///< of every state among them, and their number
  std::vector<std::size_t> place_;          ///< by function: among them
  std::vector<std::size_t> below_, above_;  ///< by state: places of the nearest watched ones, or none
  std::vector<double> lower_, upper_;       ///< their values
  std::vector<std::size_t> several_;        ///< watched functions that are not thresholds
};

}  // namespace saltus::event_integrator
