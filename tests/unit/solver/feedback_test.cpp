#include "saltus/solver/feedback.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace saltus::solver {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// min sum_k r u_k^2 + q x_N^2 with x_{j+1} = a x_j + b u_k in each element: a chain of intervals of u_k and states.
class Regulator final : public mpcc::Problem {
 public:
  static constexpr int intervals = 4;
  static constexpr double a = 1.5, b = 0.5, r = 0.2, q = 3.0, start_value = 1.0;

  explicit Regulator(int elements = 1) : elements_(elements) {
    const int n = variables(), rows = constraints();
    bounds_.lower = linalg::Vector::constant(n, -inf);
    bounds_.upper = linalg::Vector::constant(n, inf);
    rows_.lower = rows_.upper = linalg::Vector::zero(rows);
    rows_.lower[0] = rows_.upper[0] = a * start_value;
    for (int k = 0; k < intervals; ++k) {
      chain_.intervals.push_back({{control(k), 1}, k * elements, elements});
      hessian_.add(control(k), control(k));
    }
    for (int j = 0; j < rows; ++j) {
      chain_.elements.push_back({{end(j), 1}, {j, 1}, {0, 0}, {end(j)}, {}});
      jacobian_.add(j, end(j));
      jacobian_.add(j, control(j / elements));
      if (j > 0) jacobian_.add(j, end(j - 1));
    }
    hessian_.add(n - 1, n - 1);
  }
  void fix_control(int k, double value) { bounds_.upper[control(k)] = value; }

  [[nodiscard]] int control(int k) const { return k * (1 + elements_); }
  [[nodiscard]] int end(int j) const { return control(j / elements_) + 1 + j % elements_; }  ///< of element j

  [[nodiscard]] int variables() const override { return control(intervals); }
  [[nodiscard]] int constraints() const override { return intervals * elements_; }
  [[nodiscard]] int pairs() const override { return 0; }
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override { return bounds_; }
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override { return rows_; }
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override { return signs_; }
  [[nodiscard]] double objective(mpcc::ConstVectorView w) override {
    double sum = q * w[variables() - 1] * w[variables() - 1];
    for (int k = 0; k < intervals; ++k) sum += r * w[control(k)] * w[control(k)];
    return sum;
  }
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override {
    gradient.set_zero();
    for (int k = 0; k < intervals; ++k) gradient[control(k)] = 2.0 * r * w[control(k)];
    gradient[variables() - 1] = 2.0 * q * w[variables() - 1];
  }
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override {
    for (int j = 0; j < constraints(); ++j)
      c[j] = w[end(j)] - b * w[control(j / elements_)] - (j > 0 ? a * w[end(j - 1)] : 0.0);
  }
  void jacobian(mpcc::ConstVectorView, mpcc::VectorView values) override {
    for (int e = 0, j = 0; j < constraints(); ++j) {
      values[e++] = 1.0;
      values[e++] = -b;
      if (j > 0) values[e++] = -a;
    }
  }
  void hessian(mpcc::ConstVectorView, double factor, mpcc::ConstVectorView, mpcc::VectorView values) override {
    values.set_constant(2.0 * factor * r);
    values[intervals] = 2.0 * factor * q;
  }
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override { return jacobian_; }
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override { return hessian_; }
  [[nodiscard]] const mpcc::Chain* chain() const override { return &chain_; }

 private:
  int elements_;
  mpcc::Bounds bounds_, rows_;
  std::vector<mpcc::Sign> signs_;
  mpcc::Pattern jacobian_, hessian_;
  mpcc::Chain chain_;
};

/// Without controls but the last.
Solution at_zero(const Regulator& problem, double u_of_last) {
  Solution solution;
  solution.w = linalg::Vector::zero(problem.variables());
  solution.w[problem.control(Regulator::intervals - 1)] = u_of_last;
  solution.multipliers.rows = linalg::Vector::zero(problem.constraints());
  // Rows hold: each state is what the one before makes of it.
  double x = Regulator::start_value;
  const int elements = problem.constraints() / Regulator::intervals;
  for (int j = 0; j < problem.constraints(); ++j) {
    x = Regulator::a * x + Regulator::b * solution.w[problem.control(j / elements)];
    solution.w[problem.end(j)] = x;
  }
  return solution;
}

TEST(Feedback, GainsAreThoseOfTheRiccatiRecursion) {
  Regulator problem;
  const auto gains = feedback_gains(problem, at_zero(problem, 0.0), 1, 1);
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
  const auto gains = feedback_gains(problem, at_zero(problem, 2.0), 1, 1, TrackingScales{{state}, {control}});
  constexpr double a = Regulator::a, b = Regulator::b, q = 1.0 / (state * state), r = 1.0 / (control * control);
  double p = q;
  for (int k = Regulator::intervals - 1; k > 0; --k) {
    const double gain = -b * p * a / (r + b * p * b);
    EXPECT_NEAR(gains[static_cast<std::size_t>(k)](0, 0), gain, 1e-6) << k;
    p = q + r * gain * gain + p * (a + b * gain) * (a + b * gain);
  }
}

/// u acts until the end of its interval, where deviations count: n elements take x to a^n x + (1 + ... + a^(n-1)) b u.
TEST(Feedback, TrackingCorrectsAtElementsInsideOfIntervals) {
  constexpr int elements = 3;
  Regulator problem(elements);
  const auto gains = feedback_gains(problem, at_zero(problem, 0.0), 1, 1, TrackingScales{{2.0}, {0.5}});
  ASSERT_EQ(gains.size(), 12U);
  constexpr double q = 1.0 / 4.0, r = 4.0;
  double p = q;
  for (int k = Regulator::intervals - 1; k >= 0; --k) {
    double power = 1.0, sum = 0.0, gain = 0.0;
    for (int e = elements - 1; e >= 0; --e) {
      sum += power * Regulator::b;
      power *= Regulator::a;
      gain = -sum * p * power / (r + sum * p * sum);
      const auto j = static_cast<std::size_t>(k * elements + e);
      EXPECT_NEAR(gains[j](0, 0), j == 0 ? 0.0 : gain, 1e-6) << j;
    }
    p = q + r * gain * gain + p * (power + sum * gain) * (power + sum * gain);
  }
}

TEST(Feedback, AnOptimumIsCorrectedAtNodes) {
  Regulator problem(2);
  const auto gains = feedback_gains(problem, at_zero(problem, 0.0), 1, 1);
  ASSERT_EQ(gains.size(), 8U);
  for (std::size_t j = 0; j < gains.size(); ++j) EXPECT_EQ(gains[j].size(), j % 2 == 0 ? 1 : 0) << j;
  constexpr double a = Regulator::a * Regulator::a, b = Regulator::b * (1.0 + Regulator::a), q = Regulator::q;
  EXPECT_NEAR(gains[6](0, 0), -b * q * a / (Regulator::r + b * q * b), 1e-6);
}

TEST(Feedback, AControlAtItsBoundStaysThere) {
  Regulator problem;
  problem.fix_control(3, 2.0);
  const auto gains = feedback_gains(problem, at_zero(problem, 2.0), 1, 1);
  EXPECT_EQ(gains[3](0, 0), 0.0);
  // The one before knows that nobody helps it behind.
  const double p = Regulator::q * Regulator::a * Regulator::a;
  const double gain = -Regulator::b * p * Regulator::a / (Regulator::r + Regulator::b * p * Regulator::b);
  EXPECT_NEAR(gains[2](0, 0), gain, 1e-6);
}

}  // namespace
}  // namespace saltus::solver
