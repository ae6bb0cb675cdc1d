// The steps of a Radau IIA method: what is kept between them.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/ode/radau_internal.hpp"
#include "saltus/ode/sparse/radau_systems_internal.hpp"

namespace saltus::ode {

/// Solves for the increments z_j = x(t + c_j h) - x(t) of the stages by a simplified Newton iteration. Its variables
/// are those that split it into real and complex systems of size n.
///
/// The iteration ends at rounding level, not at a share of the tolerance: steps of different lengths from one start
/// then end on one smooth curve, on which events are located. The Jacobian belongs to the start of this or an
/// earlier step; it is kept over steps while the iteration converges fast, and for all lengths of a retaken step. Its
/// columns are differences, together those without a common row if the pattern is known. Where the iteration fails with
/// them at several lengths, the Jacobian itself is asked for.
template <class Tableau>
class RadauSteps final : public Radau {
 public:
  explicit RadauSteps(int n);

  Attempt attempt(const RadauTrial& trial, double* x_new, double* slope_new, long& evaluations) override;
  [[nodiscard]] double error_norm() const override { return error_norm_; }
  void dense(double* coefficients) const override;
  [[nodiscard]] double spectral_radius() override;
  [[nodiscard]] Stages stages_of_attempt() const override { return outcome_; }
  [[nodiscard]] double contraction() const override { return rate_; }
  void restart() override;

 private:
  using Matrix = linalg::Matrix;
  using Vector = linalg::Vector;
  static constexpr std::size_t stages = Tableau::stages;
  static constexpr auto last = static_cast<linalg::Index>(stages) - 1;

  void begin(const RadauTrial& trial);
  Stages solve(const RadauTrial& trial);
  void start_values(double h);
  void transform_start();
  [[nodiscard]] bool factorize(double h);
  Stages iterate(const RadauTrial& trial);
  bool stage_slopes(const RadauTrial& trial);
  void solve_systems(double h);
  double correct(const RadauTrial& trial);
  bool differentiate(const RadauTrial& trial);
  bool take_derivatives(const RadauTrial& trial);
  bool take_differences(const RadauTrial& trial);
  [[nodiscard]] double increment(const RadauTrial& trial, linalg::Index column, double largest) const;
  bool difference(const RadauTrial& trial, const std::vector<std::size_t>& columns, double direction);
  double estimate(const RadauTrial& trial, const double* x_new);
  bool evaluate(const RadauTrial& trial, double t, const Vector& x, double* slope);

  linalg::Index n_;
  long* evaluations_ = nullptr;
  double error_norm_ = 0.0;

  // The start of the step, and the last length tried from it.
  bool started_ = false;                ///< false after restart()
  Stages outcome_ = Stages::undefined;  ///< of the last attempt; `found`: z_ is its solution
  double t_ = 0.0;
  double h_ = 0.0;
  Vector start_;

  // The step before, whose polynomial gives starting values.
  struct Previous {
    bool known = false;
    double h = 0.0;
    std::vector<double> polynomial;  ///< as from dense()
  };
  Previous previous_;

  // Jacobian and factors.
  bool jacobian_known_ = false;
  bool jacobian_here_ = false;  ///< it belongs to start_
  int failures_ = 0;            ///< of differences, from this start or, if there were too many, one since restart()
  struct Factors {
    bool known = false;
    double h = 0.0;
  };
  Factors factors_;
  double rate_ = 0.0;  ///< of convergence of the last iteration
  double next_ = 0.0;  ///< the largest component that is expected of the next correction
  RadauSystems<stages / 2> systems_;
  double largest_ = 0.0;  ///< component of start_
  std::vector<std::size_t> one_column_;

  Matrix z_, w_, slopes_;  ///< n x stages: increments, transformed increments, f at the stages
  Matrix corrections_;     ///< of w_
  struct Work {
    explicit Work(linalg::Index n)
        : argument(n), difference_slope(n), right(n), solution(n), changes(n), all_right(n, last + 1) {}
    Vector argument, difference_slope, right, solution;
    Vector changes;    ///< of the last correction, relative to sizes
    Vector direction;  ///< to which powers of the Jacobian turn; empty before they are asked for
    Matrix all_right;
  };
  Work work_;
};

}  // namespace saltus::ode
