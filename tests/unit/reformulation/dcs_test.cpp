// Dynamic complementarity systems of models stated in C++, against their definitions.
#include "saltus/reformulation/dcs.hpp"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "dcs_tools.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/sizes.hpp"

namespace saltus::reformulation {
namespace {

using casadi::SX;
using model::Builder;

/// sum over the 2^n sign patterns of field i times its multiplier, by a nest of if: every pattern has a field.
model::System patterns_as_field(int n) {
  Builder builder("patterns");
  std::vector<SX> alpha;
  for (int j = 0; j < n; ++j) {
    const SX x = builder.state("x" + std::to_string(j), {0.0});
    alpha.push_back(builder.step(x, "c" + std::to_string(j)));
  }
  SX sum = 0;
  for (int i = 0; i < 1 << n; ++i) {
    SX theta = 1;
    for (int j = 0; j < n; ++j) theta *= (i >> j & 1) == 0 ? alpha[at(j)] : 1 - alpha[at(j)];
    sum += (1.0 + i * 0.37) * theta;
  }
  builder.dynamics("x0", sum);
  for (int j = 1; j < n; ++j) builder.dynamics("x" + std::to_string(j), 1);
  return built(builder);
}

TEST(Sizes, AreThoseOfThePapersTable4) {
  for (int n = 2; n <= 10; ++n) {
    const auto system = patterns_as_field(n);
    const int regions = 1 << n;
    for (const int factors : {2, 3, 5}) {
      const auto sizes = sizes_of(system, {.reformulation = Form::step, .lifting = factors});
      ASSERT_TRUE(sizes) << to_text(sizes.error());
      ASSERT_EQ(sizes->groups.size(), 1u);
      const Counts& counts = sizes->total;
      const int beta = factors <= n ? regions - (1 << factors) : 0;
      EXPECT_EQ(counts.alpha, n);
      EXPECT_EQ(counts.theta, regions);
      EXPECT_EQ(counts.beta, beta) << n << " " << factors;
      EXPECT_EQ(counts.algebraic, regions + 3 * n + beta);
      EXPECT_EQ(counts.complementarities, 2 * n);
      EXPECT_EQ(counts.equations, n + beta + regions);
    }
    const auto stewart = sizes_of(system, as_stewart);
    ASSERT_TRUE(stewart) << to_text(stewart.error());
    EXPECT_EQ(stewart->total.theta, regions);
    EXPECT_EQ(stewart->total.algebraic, 2 * regions + 1);
    EXPECT_EQ(stewart->total.complementarities, regions);
    EXPECT_EQ(stewart->total.equations, regions + 1);
  }
}

TEST(Lifted, HasTheSameFieldForAllSelections) {
  for (int n = 2; n <= 10; n += 2) {
    const auto system = patterns_as_field(n);
    const Dcs plain = dcs_of(system, as_step);
    for (const int factors : {2, 3}) {
      const Dcs lifted = dcs_of(system, {.reformulation = Form::step, .lifting = factors});
      ASSERT_EQ(lifted.lifted.numel(), factors <= n ? (1 << n) - (1 << factors) : 0);
      ASSERT_EQ(lifted.lifting.numel(), lifted.lifted.numel());
      for (unsigned seed = 1; seed <= 5; ++seed) {
        const auto alpha = uniform(n, seed);
        const std::vector<double> x(at(n), 0.3);
        const double expected = field(plain, x, alpha)[0];
        EXPECT_NEAR(field(lifted, x, alpha)[0], expected, 1e-12 * expected) << n << " " << factors;
      }
    }
  }
}

/// A group of modes by `when`, with a field (i + 1) each.
SX weights(Builder& builder, const std::vector<model::Condition>& regions) {
  SX sum = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) sum += builder.if_(regions[i], static_cast<double>(i + 1), 0.0);
  return sum;
}

/// Example 4 of [nurkanovic2024]: R_1 is a union of three base regions, theta_1 = alpha_1 + (1 - alpha_1) alpha_2.
TEST(UnionsOfRegions, AreOneMultiplier) {
  Builder builder("union");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  const auto in_first = model::greater(x, 0, "c1") || model::greater(y, 0, "c2");
  builder.dynamics("x", builder.if_(in_first, x + y, x - y));
  builder.dynamics("y", 1);
  const auto system = built(builder);
  const auto sizes = sizes_of(system, as_step);
  ASSERT_TRUE(sizes);
  EXPECT_EQ(sizes->total.theta, 2);
  EXPECT_EQ(sizes->total.algebraic, 2 + 3 * 2);
  EXPECT_EQ(sizes_of(system, as_stewart)->total.theta, 4) << "Stewart's form cannot join them";
  const Dcs dcs = dcs_of(system, as_step);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto alpha = uniform(2, seed);
    const double theta = alpha[0] + (1.0 - alpha[0]) * alpha[1];
    EXPECT_NEAR(field(dcs, {0.5, 2.0}, alpha)[0], theta * 2.5 - (1.0 - theta) * 1.5, 1e-14);
  }
}

/// Regions that not every function bounds: c2 matters for c1 < 0 only, c3 for c1 < 0 and c2 < 0.
TEST(SparseSignMatrices, NeedFewerLiftedVariables) {
  Builder builder("sparse");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0}), z = builder.state("z", {0.0});
  const auto c1 = model::greater(x, 0, "c1"), c2 = model::greater(y, 0, "c2"), c3 = model::greater(z, 0, "c3");
  builder.dynamics("x", weights(builder, {c1, !c1 && c2, !c1 && !c2 && c3, !c1 && !c2 && !c3}));
  builder.dynamics("y", 1);
  builder.dynamics("z", 1);
  const auto system = built(builder);
  const ReformulationOptions lifting{.reformulation = Form::step, .lifting = 2};
  const auto sizes = sizes_of(system, lifting);
  ASSERT_TRUE(sizes);
  EXPECT_EQ(sizes->total.theta, 4);
  EXPECT_EQ(sizes->total.beta, 1) << "(1 - alpha_1)(1 - alpha_2); all patterns need 2^3 - 2^2";
  const Dcs plain = dcs_of(system, as_step), lifted = dcs_of(system, lifting);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto alpha = uniform(3, seed);
    EXPECT_NEAR(field(lifted, {0, 0, 0}, alpha)[0], field(plain, {0, 0, 0}, alpha)[0], 1e-14);
  }
}

/// With zeros in S, g = -S psi compares sums of different lengths: at psi = (0.1, 10) the region psi_1 > 0 has g = -0.1
/// and (psi_1 < 0, psi_2 > 0), where the point is not, has g = -9.9. So every pattern is a region in Stewart's form.
TEST(SparseSignMatrices, AreNoIndicatorsOfStewartsForm) {
  const linalg::Matrix signs{{1, 0}, {-1, 1}, {-1, -1}};
  const linalg::Vector psi{0.1, 10.0}, all_g = -signs * psi;
  EXPECT_EQ(all_g.index_of_min(), 1);

  Builder builder("sparse");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  const auto c1 = model::greater(x, 0, "c1"), c2 = model::greater(y, 0, "c2");
  builder.dynamics("x", weights(builder, {c1, !c1 && c2, !c1 && !c2}));
  builder.dynamics("y", 1);
  const Dcs dcs = dcs_of(built(builder), as_stewart);
  ASSERT_EQ(dcs.parts.size(), 1u);
  ASSERT_EQ(dcs.parts[0].signs.rows(), 4);
  const auto g = indicators(dcs, {0.1, 10.0});
  const auto active = std::min_element(g.begin(), g.end()) - g.begin();
  EXPECT_TRUE(std::ranges::equal(dcs.parts[0].signs.row(active), std::array{1, 1}));
}

TEST(IndependentGroups, AreSummed) {
  Builder builder("sum");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0}), z = builder.state("z", {0.0});
  const SX a = builder.step(x), b = builder.step(y), c = builder.step(z);
  builder.dynamics("x", 2 * (a * y + b) - (c * b) / 2);
  builder.dynamics("y", 1 - a);
  builder.dynamics("z", -a);
  const auto system = built(builder);
  const auto stewart = sizes_of(system, as_stewart);
  ASSERT_TRUE(stewart);
  ASSERT_EQ(stewart->groups.size(), 2u) << "x alone, y with z";
  EXPECT_EQ(stewart->groups[0].counts.theta, 2);
  EXPECT_EQ(stewart->groups[1].counts.theta, 4);
  EXPECT_EQ(stewart->total.theta, 6);
  const Dcs dcs = dcs_of(system, as_stewart);
  // Products of the multipliers a x b x c of the corners: f is linear in each simplex.
  const auto alpha = uniform(3, 1);
  std::vector<double> theta{alpha[0], 1 - alpha[0]};
  for (const double one : {alpha[1], 1 - alpha[1]}) {
    theta.push_back(one * alpha[2]);
    theta.push_back(one * (1 - alpha[2]));
  }
  const auto f = field(dcs, {0.2, 0.3, 0.4}, theta);
  EXPECT_NEAR(f[0], 2 * (alpha[0] * 0.3 + alpha[1]) - alpha[2] * alpha[1] / 2, 1e-15);
  EXPECT_NEAR(f[1], 1 - alpha[0], 1e-15);
  EXPECT_NEAR(f[2], -alpha[0], 1e-15);
}

TEST(StewartForm, RefusesWhatItIsNotFor) {
  Builder nonlinear("nonlinear");
  const SX x = nonlinear.state("x", {0.0});
  const SX alpha = nonlinear.step(x);
  nonlinear.set_inclusion(model::Inclusion::aizerman_pyatnitskii);
  nonlinear.dynamics("x", (1 + 3 * alpha) * (2 * alpha - 1));
  const auto system = built(nonlinear);
  const auto refused = reformulate(system, as_stewart);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_available);
  EXPECT_NE(refused.error().message.find("enter the dynamics of x nonlinearly"), std::string::npos);
  EXPECT_NEAR(field(dcs_of(system, as_step), {0.0}, {0.25})[0], (1 + 0.75) * (0.5 - 1), 1e-15);

  const auto many = reformulate(patterns_as_field(10), as_stewart);
  EXPECT_TRUE(many) << "ten are covered";
  Builder eleven("eleven");
  SX product = 1;
  for (int j = 0; j < 11; ++j) {
    const std::string name = "x" + std::to_string(j);
    product *= eleven.step(eleven.state(name, {0.0}));
    if (j > 0) eleven.dynamics(name, 1);
  }
  eleven.dynamics("x0", product);
  const auto too_many = reformulate(built(eleven), as_stewart);
  ASSERT_FALSE(too_many);
  EXPECT_NE(too_many.error().message.find("2^11"), std::string::npos) << too_many.error().message;
}

}  // namespace
}  // namespace saltus::reformulation
