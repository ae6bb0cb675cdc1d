// Derivatives of dense and of curved expressions against CasADi's own.
#include <casadi/core/function.hpp>
#include <gtest/gtest.h>

#include "saltus/foreign/derivatives_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::DM;
using casadi::SX;

struct Example {
  SX w = SX::sym("w", 3), factor = SX::sym("factor"), y = SX::sym("y", 3);
  SX c = SX::vertcat({SX(2.0) * w(0) - w(2) + 3.0, w(0) * w(1), 4.0 - w(1)});
};

double difference(const Example& of, const SX& a, const SX& b) {
  const casadi::Function both("both", {of.w, of.factor, of.y}, {SX::densify(a), SX::densify(b)});
  const auto values = both(std::vector<DM>{DM({0.3, -1.7, 2.5}), DM(1.5), DM({0.7, -2.0, 11.0})});
  return static_cast<double>(DM::norm_inf_mul(values[0] - values[1], DM::eye(values[0].size2())));
}

TEST(Derivatives, OfAffineAndCurvedRowsStayInTheirOrder) {
  const Example of;
  const SX jacobian = jacobian_of(of.c, of.w);
  EXPECT_EQ(difference(of, jacobian, SX::jacobian(of.c, of.w)), 0.0);
  EXPECT_EQ(jacobian.nnz(), 5);
}

TEST(Derivatives, OfQuadraticAndOtherObjectives) {
  const Example of;
  const SX quadratic = SX::sumsqr(of.w(0) - 3.0 * of.w(2)) + of.w(1) * (of.w(2) + 1.0);
  for (const SX& f : {quadratic, quadratic + SX::exp(of.w(1)), 2.0 * of.w(0)}) {
    const SX expected = SX::tril(SX::hessian(of.factor * f + SX::dot(of.y, of.c), of.w));
    EXPECT_LE(difference(of, hessian_of(f, of.c, of.w, of.factor, of.y), expected), 1e-14);
  }
}

}  // namespace
}  // namespace saltus::foreign
