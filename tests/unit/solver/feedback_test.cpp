#include "saltus/solver/feedback.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace saltus::solver {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// min sum_k r u_k^2 + q x_N^2 with x_{k+1} = a x_k + b u_k: a chain of intervals (u_k, x_{k+1}) with one row each.
class Regulator final : public mpcc::Problem {
 public:
  static constexpr int intervals = 4;
  static constexpr double a = 1.5, b = 0.5, r = 0.2, q = 3.0, start_value = 1.0;

  Regulator() {
    const int n = 2 * intervals;
    bounds_.lower = Eigen::VectorXd::Constant(n, -inf);
    bounds_.upper = Eigen::VectorXd::Constant(n, inf);
    rows_.lower = rows_.upper = Eigen::VectorXd::Zero(intervals);
    rows_.lower[0] = rows_.upper[0] = a * start_value;
    for (int k = 0; k < intervals; ++k) {
      chain_.intervals.push_back({{2 * k, 1}, k, 1});
      chain_.elements.push_back({{2 * k + 1, 1}, {k, 1}, {0, 0}, {2 * k + 1}, {}});
      jacobian_.add(k, 2 * k + 1);
      jacobian_.add(k, 2 * k);
      if (k > 0) jacobian_.add(k, 2 * k - 1);
      hessian_.add(2 * k, 2 * k);
    }
    hessian_.add(n - 1, n - 1);
  }
  void fix_control(int k, double value) { bounds_.upper[2 * k] = value; }

  [[nodiscard]] int variables() const override { return 2 * intervals; }
  [[nodiscard]] int constraints() const override { return intervals; }
  [[nodiscard]] int pairs() const override { return 0; }
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override { return bounds_; }
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override { return rows_; }
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override { return signs_; }
  [[nodiscard]] double objective(mpcc::ConstVectorView w) override {
    double sum = q * w[2 * intervals - 1] * w[2 * intervals - 1];
    for (int k = 0; k < intervals; ++k) sum += r * w[2 * k] * w[2 * k];
    return sum;
  }
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override {
    gradient.setZero();
    for (int k = 0; k < intervals; ++k) gradient[2 * k] = 2.0 * r * w[2 * k];
    gradient[2 * intervals - 1] = 2.0 * q * w[2 * intervals - 1];
  }
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override {
    for (int k = 0; k < intervals; ++k) c[k] = w[2 * k + 1] - b * w[2 * k] - (k > 0 ? a * w[2 * k - 1] : 0.0);
  }
  void jacobian(mpcc::ConstVectorView, mpcc::VectorView values) override {
    for (int e = 0, k = 0; k < intervals; ++k) {
      values[e++] = 1.0;
      values[e++] = -b;
      if (k > 0) values[e++] = -a;
    }
  }
  void hessian(mpcc::ConstVectorView, double factor, mpcc::ConstVectorView, mpcc::VectorView values) override {
    values.setConstant(2.0 * factor * r);
    values[intervals] = 2.0 * factor * q;
  }
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override { return jacobian_; }
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override { return hessian_; }
  [[nodiscard]] const mpcc::Chain* chain() const override { return &chain_; }

 private:
  mpcc::Bounds bounds_, rows_;
  std::vector<mpcc::Sign> signs_;
  mpcc::Pattern jacobian_, hessian_;
  mpcc::Chain chain_;
};

Solution at_zero(double u_of_last) {
  Solution solution;
  solution.w = Eigen::VectorXd::Zero(2 * Regulator::intervals);
  solution.w[2 * Regulator::intervals - 2] = u_of_last;
  solution.multipliers.rows = Eigen::VectorXd::Zero(Regulator::intervals);
  // Rows hold: each state is what the one before makes of it.
  double x = Regulator::start_value;
  for (int k = 0; k < Regulator::intervals; ++k) {
    x = Regulator::a * x + Regulator::b * solution.w[2 * k];
    solution.w[2 * k + 1] = x;
  }
  return solution;
}

TEST(Feedback, GainsAreThoseOfTheRiccatiRecursion) {
  Regulator problem;
  const auto gains = feedback_gains(problem, at_zero(0.0), 1, 1);
  ASSERT_EQ(gains.size(), 4U);
  EXPECT_EQ(gains[0](0, 0), 0.0);  // its node is given
  constexpr double a = Regulator::a, b = Regulator::b;
  double p = Regulator::q;
  for (int k = Regulator::intervals - 1; k > 0; --k) {
    const double gain = -b * p * a / (Regulator::r + b * p * b);
    EXPECT_NEAR(gains[static_cast<std::size_t>(k)](0, 0), gain, 1e-6) << k;
    p = Regulator::r * gain * gain + p * (a + b * gain) * (a + b * gain);
  }
}

/// Whatever the cost is, and at bounds, too.
TEST(Feedback, TrackingMinimisesScaledDeviations) {
  Regulator problem;
  problem.fix_control(3, 2.0);
  constexpr double state = 2.0, control = 0.5;
  const auto gains = feedback_gains(problem, at_zero(2.0), 1, 1, TrackingScales{{state}, {control}});
  constexpr double a = Regulator::a, b = Regulator::b, q = 1.0 / (state * state), r = 1.0 / (control * control);
  double p = q;
  for (int k = Regulator::intervals - 1; k > 0; --k) {
    const double gain = -b * p * a / (r + b * p * b);
    EXPECT_NEAR(gains[static_cast<std::size_t>(k)](0, 0), gain, 1e-6) << k;
    p = q + r * gain * gain + p * (a + b * gain) * (a + b * gain);
  }
}

TEST(Feedback, AControlAtItsBoundStaysThere) {
  Regulator problem;
  problem.fix_control(3, 2.0);
  const auto gains = feedback_gains(problem, at_zero(2.0), 1, 1);
  EXPECT_EQ(gains[3](0, 0), 0.0);
  // The one before knows that nobody helps it behind.
  const double p = Regulator::q * Regulator::a * Regulator::a;
  const double gain = -Regulator::b * p * Regulator::a / (Regulator::r + Regulator::b * p * Regulator::b);
  EXPECT_NEAR(gains[2](0, 0), gain, 1e-6);
}

}  // namespace
}  // namespace saltus::solver
