// Roots of switching functions are 0 on their surfaces, whatever the rounding of the state.
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;
using model::Builder;

/// x' = -root of (x - 0.8 y) with a sign, y' = 1.
ModelKernel kernel_of(const std::function<SX(Builder&, const SX&)>& root) {
  Builder b("roots");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {1});
  const SX e = x - 0.8 * y;
  b.dynamics("x", -root(b, e) - b.sign(e));
  b.dynamics("y", 1);
  auto kernel = ModelKernel::compile(*b.build());
  EXPECT_TRUE(kernel.has_value());
  return std::move(*kernel);
}

const std::vector<std::function<SX(Builder&, const SX&)>> roots{
    [](Builder& b, const SX& e) { return sqrt(b.abs(e)) * b.sign(e); },
    [](Builder& b, const SX& e) { return pow(b.abs(e), 1.0 / 3.0) * b.sign(e); },
    [](Builder& b, const SX& e) { return sqrt(b.max(e, 0)); },
    [](Builder& b, const SX& e) { return sqrt(2.0 * b.abs(-e)); },
    [](Builder& b, const SX& e) { return sqrt(b.abs(e) * (2.0 + sin(e))); },
};

TEST(RootLimits, AreZeroWithinTheRoundingOfTheSurface) {
  for (std::size_t i = 0; i < roots.size(); ++i) {
    SCOPED_TRACE(i);
    const ModelKernel kernel = kernel_of(roots[i]);
    EXPECT_TRUE(kernel.has_root(0));
    for (const double off : {-1e-16, 0.0, 1e-16, 4e-16}) {
      const double x[] = {0.8 * 0.7 + off, 0.7};
      for (const double alpha : {0.0, 1.0}) {
        double f[2];
        kernel.field(0.0, x, &alpha, f);
        EXPECT_EQ(f[0], alpha > 0.5 ? -1.0 : 1.0);
        // psi = x - 0.8 y along (-+1, 1): second derivatives vanish where the root does.
        EXPECT_EQ(kernel.lie_derivative(0, 2, 0.0, x, &alpha), 0.0);
      }
    }
  }
}

// y + sqrt(|x|) sign(x) with x held at 0, beside it, too: y. With the selections of a region it is as it was.
TEST(RootLimits, OfFunctionsThatHoldSignsAreZeroWhereTheseAreHeld) {
  Builder b("nested");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {1});
  const SX psi = y + sqrt(b.abs(x)) * b.sign(x);
  b.dynamics("x", y);
  b.dynamics("y", -2 * b.sign(psi));
  auto kernel = ModelKernel::compile(*b.build());
  ASSERT_TRUE(kernel.has_value());
  const int nested = kernel->inner(0).empty() ? 1 : 0;
  const int inside = kernel->inner(nested).front();
  EXPECT_TRUE(kernel->has_root_inside(nested, inside));
  EXPECT_FALSE(kernel->has_root_inside(nested, nested));
  const int form = kernel->with_limited_roots(nested);
  EXPECT_EQ(form, kernel->with_limited_roots(nested));
  std::vector<double> alpha{0.5, 0.5};
  double row[2], rate = 1.0;
  for (const double off : {0.0, 1e-30, -1e-9, 0.3}) {
    const double point[] = {off, 0.7};
    EXPECT_EQ(kernel->lie_derivative(form, 0, 0.0, point, alpha.data()), 0.7);
    kernel->lie_gradient(form, 0, 0.0, point, alpha.data(), row, &rate);
    EXPECT_EQ(row[0], 0.0);
    EXPECT_EQ(row[1], 1.0);
    EXPECT_EQ(rate, 0.0);
  }
  const double point[] = {0.25, 0.7};
  alpha[static_cast<std::size_t>(inside)] = 1.0;
  EXPECT_EQ(kernel->lie_derivative(form, 0, 0.0, point, alpha.data()), 1.2);
  // x' = y: the first derivative along the field, at selections of 1/2 for the outer one.
  EXPECT_NEAR(kernel->lie_derivative(form, 1, 0.0, point, alpha.data()), 0.7, 1e-15);
}

TEST(RootLimits, LeaveTheRegionsAsTheyAre) {
  const ModelKernel kernel = kernel_of(roots[0]);
  for (const double off : {1e-10, 1e-3, 0.5}) {
    const double x[] = {0.56 + off, 0.7};
    double f[2];
    const double above = 1.0, below = 0.0;
    kernel.field(0.0, x, &above, f);
    EXPECT_EQ(f[0], -std::sqrt(x[0] - 0.8 * x[1]) - 1.0);
    // Beyond its own surface a field goes on as it is there.
    kernel.field(0.0, x, &below, f);
    EXPECT_EQ(f[0], 1.0);
  }
}

TEST(RootLimits, AreThoseOfSurfacesOnly) {
  const auto other = [](Builder& b, const SX& e) { return sqrt(b.abs(e) + 1.0) + sqrt(e + 0.5) + pow(b.abs(e), 2.0); };
  EXPECT_FALSE(kernel_of(other).has_root(0));
}

// With a parameter as exponent, and of a surface that is named the other way round.
TEST(RootLimits, FindExponentsAndMultiples) {
  Builder b("exponent");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {1});
  const SX q = b.parameter("q", 0.4);
  b.dynamics("x", -b.sign(x - y) - pow(b.abs(2.0 * y - 2.0 * x), q));
  b.dynamics("y", 0);
  const auto kernel = ModelKernel::compile(*b.build());
  ASSERT_TRUE(kernel.has_value());
  EXPECT_TRUE(kernel->has_root(0));
}

}  // namespace
}  // namespace saltus::evaluation
