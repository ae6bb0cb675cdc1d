#include "saltus/ode/bernstein.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "polynomials.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

long double exact_value(const BernsteinCoefficients& coefficients, long double theta) {
  std::array<long double, event_nodes> b;
  std::copy(coefficients.begin(), coefficients.end(), b.begin());
  for (std::size_t level = b.size() - 1; level > 0; --level) {
    for (std::size_t i = 0; i < level; ++i) b[i] += theta * (b[i + 1] - b[i]);
  }
  return b[0];
}

BernsteinCoefficients random_coefficients(Random& random) {
  BernsteinCoefficients coefficients;
  for (double& value : coefficients) value = random.uniform(-1.0, 1.0);
  return coefficients;
}

TEST(Bernstein, nodes_are_where_they_should_be) {
  const auto& nodes = interpolation_nodes();
  const auto& between = check_nodes();
  EXPECT_EQ(nodes.front(), 0.0);
  EXPECT_EQ(nodes.back(), 1.0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    EXPECT_NEAR(nodes[i], 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / event_degree), epsilon);
  }
  for (std::size_t i = 0; i < between.size(); ++i) {
    EXPECT_LT(nodes[i], between[i]);
    EXPECT_LT(between[i], nodes[i + 1]);
  }
}

TEST(Bernstein, end_coefficients_are_end_values_and_powers_of_two_scale) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto values = random_coefficients(random);
    auto scaled_values = values;
    const int exponent = random.integer(-60, 60);
    for (double& value : scaled_values) value = std::ldexp(value, exponent);
    const auto coefficients = to_bernstein(values);
    const auto scaled = to_bernstein(scaled_values);
    EXPECT_EQ(coefficients.front(), values.front());
    EXPECT_EQ(coefficients.back(), values.back());
    for (std::size_t i = 0; i < scaled.size(); ++i) EXPECT_EQ(scaled[i], std::ldexp(coefficients[i], exponent));
  }
}

TEST(Bernstein, conversion_is_backward_stable) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto exact = random_coefficients(random);
    std::array<double, event_nodes> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = static_cast<double>(exact_value(exact, interpolation_nodes()[i]));
    }
    const auto coefficients = to_bernstein(values);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      // Rounding of the values and of the elimination, amplified by the condition of the basis.
      EXPECT_NEAR(coefficients[i], exact[i], 184 * 4 * epsilon);
    }
    for (int k = 0; k <= 200; ++k) {
      const double theta = k / 200.0;
      EXPECT_NEAR(static_cast<double>(exact_value(coefficients, theta)), static_cast<double>(exact_value(exact, theta)),
                  8 * epsilon);
    }
  }
}

TEST(Bernstein, conversion_is_exact_up_to_degree_eight_only) {
  for (int degree = 0; degree <= event_degree + 1; ++degree) {
    std::array<double, event_nodes> values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::pow(interpolation_nodes()[i] - 0.3, degree);
    const auto coefficients = to_bernstein(values);
    double error = 0.0;
    for (const double theta : check_nodes()) {
      error = std::max(error, std::abs(evaluate(coefficients, theta) - std::pow(theta - 0.3, degree)));
    }
    if (degree <= event_degree) {
      EXPECT_LT(error, 16 * epsilon) << "degree " << degree;
    } else {
      EXPECT_GT(error, 1e-6);
    }
  }
}

TEST(Bernstein, values_are_correct_and_exact_at_the_ends) {
  Random random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto coefficients = random_coefficients(random);
    EXPECT_EQ(evaluate(coefficients, 0.0), coefficients.front());
    EXPECT_EQ(evaluate(coefficients, 1.0), coefficients.back());
    const double theta = random.uniform(0.0, 1.0);
    EXPECT_NEAR(evaluate(coefficients, theta), static_cast<double>(exact_value(coefficients, theta)), 8 * epsilon);
  }
}

TEST(Bernstein, derivative_is_that_of_powers) {
  for (int degree = 1; degree <= event_degree; ++degree) {
    std::array<double, event_nodes> values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::pow(interpolation_nodes()[i] - 0.3, degree);
    const auto coefficients = to_bernstein(values);
    for (const double theta : {0.0, 0.2, 0.3, 0.75, 1.0}) {
      // Differences of coefficients, times the degree.
      EXPECT_NEAR(derivative(coefficients, theta), degree * std::pow(theta - 0.3, degree - 1),
                  event_degree * 184 * 4 * epsilon);
    }
  }
}

}  // namespace
}  // namespace saltus::ode
