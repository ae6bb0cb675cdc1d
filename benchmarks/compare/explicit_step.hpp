// One step of an explicit Runge-Kutta method as an expert writes it for a fixed number of states: no memory, no calls
// that the compiler cannot see through, every coefficient a constant. Only the coefficients are shared with Saltus.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "protocol.hpp"
#include "saltus/ode/explicit/dop853_tableau.hpp"
#include "saltus/ode/explicit/dopri5_tableau.hpp"

namespace compare {

using Dopri5 = saltus::ode::Dopri5Tableau;
using Dop853 = saltus::ode::Dop853Tableau;

template <class Tableau, std::size_t n>
class ExplicitStep {
 public:
  using State = std::array<double, n>;
  static constexpr std::size_t last = Tableau::stages - 1;

  /// The slope at the start of the next step.
  State& first_slope() { return stages_[0]; }
  [[nodiscard]] const State& first_slope() const { return stages_[0]; }
  [[nodiscard]] const State& x_new() const { return x_new_; }
  [[nodiscard]] const State& slope_new() const { return stages_[last]; }
  void keep_slope() { stages_[0] = stages_[last]; }

  template <class Field>
  void take(const Field& field, const State& x, double h) {
    stages(field, x, h, std::make_index_sequence<last>{});
  }

  /// Root mean square of the error estimate in units of the tolerances.
  [[nodiscard]] double error(const State& x, double h, Tolerances tolerances) const {
    const double fifth = squared<0>(x, h, tolerances);
    if constexpr (Tableau::error.size() == 1) {
      return std::sqrt(fifth / n);
    } else {
      const double third = squared<1>(x, h, tolerances);
      return fifth == 0.0 ? 0.0 : fifth / std::sqrt(n * (fifth + 0.01 * third));
    }
  }

 private:
  template <const auto& rows, std::size_t row, std::size_t... stage>
  [[nodiscard]] double sum(std::size_t i, std::index_sequence<stage...>) const {
    double total = 0.0;
    ((rows[row][stage] != 0.0 ? void(total += rows[row][stage] * stages_[stage][i]) : void()), ...);
    return total;
  }
  template <std::size_t row, class Field>
  void stage(const Field& field, const State& x, double h) {
    for (std::size_t i = 0; i < n; ++i) {
      x_new_[i] = x[i] + h * sum<Tableau::a, row>(i, std::make_index_sequence<row>{});
    }
    field(x_new_.data(), stages_[row].data());
  }
  template <class Field, std::size_t... offset>
  void stages(const Field& field, const State& x, double h, std::index_sequence<offset...>) {
    (stage<offset + 1>(field, x, h), ...);
  }
  template <std::size_t row>
  [[nodiscard]] double squared(const State& x, double h, Tolerances tolerances) const {
    double total = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double scale = tolerances.atol + tolerances.rtol * std::max(std::abs(x[i]), std::abs(x_new_[i]));
      const double ratio = h * sum<Tableau::error, row>(i, std::make_index_sequence<Tableau::stages>{}) / scale;
      total += ratio * ratio;
    }
    return total;
  }

  std::array<State, Tableau::stages> stages_{};
  State x_new_{};
};

/// Step size controllers of the codes DOPRI5 and DOP853 of Hairer & Wanner.
template <class Tableau>
class Controller;

template <>
class Controller<Dopri5> {
 public:
  double accepted(double error) {
    const double logarithm = std::log(std::max(error, 1e-10));
    const double factor = 0.9 * std::exp(-0.17 * logarithm + 0.04 * before_);
    before_ = std::max(logarithm, std::log(1e-4));
    return std::clamp(factor, 0.2, 10.0);
  }
  static double rejected(double error) { return std::max(0.2, 0.9 * std::pow(error, -0.17)); }

 private:
  double before_ = std::log(1e-4);
};

template <>
class Controller<Dop853> {
 public:
  static double accepted(double error) { return std::clamp(0.9 / eighth_root(error), 0.333, 6.0); }
  static double rejected(double error) { return std::max(0.333, 0.9 / eighth_root(error)); }

 private:
  static double eighth_root(double error) { return std::sqrt(std::sqrt(std::sqrt(error))); }
};

}  // namespace compare
