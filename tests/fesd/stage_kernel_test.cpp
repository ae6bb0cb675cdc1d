// Functions of one stage: lifted variables are replaced by their products, whatever is lifted.
#include "saltus/discretization/stage_kernel.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fesd_models.hpp"
#include "saltus/base/at.hpp"

namespace saltus::discretization {
namespace {

/// x' = a b c d - x, y' = (1 - a) b c + 0.3 y: products of up to four selections, lifted in chains.
model::System long_products() {
  model::Builder builder("products");
  const SX x = builder.state("x", {});
  const SX y = builder.state("y", {});
  const SX a = builder.step(x - 0.1), b = builder.step(y), c = builder.step(x + y), d = builder.step(x - 2.0 * y);
  builder.dynamics("x", a * b * c * d - x);
  builder.dynamics("y", (1.0 - a) * b * c + 0.3 * y);
  return *builder.build();
}

void expect_same_field(const model::System& system, const std::vector<double>& selection,
                       const std::vector<double>& expected) {
  const double x[2] = {0.6, -0.2};
  for (const std::optional<int> lifting : {std::optional<int>{}, std::optional{2}, std::optional{3}}) {
    const auto dcs = reformulation::reformulate(system, {.reformulation = Form::step, .lifting = lifting});
    ASSERT_TRUE(dcs.has_value());
    const auto kernel = StageKernel::compile(*dcs, system.parameter_values);
    ASSERT_TRUE(kernel.has_value()) << to_text(kernel.error());
    ASSERT_EQ(kernel->selections(), selection.size());
    double f[2] = {};
    kernel->field(0.4, x, selection.data(), nullptr, f);
    EXPECT_NEAR(f[0], expected[0], 1e-15) << "lifting " << lifting.value_or(0);
    EXPECT_NEAR(f[1], expected[1], 1e-15) << "lifting " << lifting.value_or(0);
  }
}

TEST(StageKernel, LiftedProductsAreTheProducts) {
  // Selections in the order of their surfaces: a, b, c, d.
  expect_same_field(long_products(), {0.3, 0.7, 0.9, 0.2}, {0.3 * 0.7 * 0.9 * 0.2 - 0.6, 0.7 * 0.7 * 0.9 - 0.06});
  expect_same_field(long_products(), {1.0, 0.0, 0.5, 1.0}, {-0.6, -0.06});
}

/// Blocks in a row: q_i' = v_i, v_i' = q_(i-1) - 2.5 q_i^3 + q_(i+1) - sign(v_i - 0.2).
model::System blocks(int n) {
  model::Builder builder("blocks");
  std::vector<SX> q, v;
  for (int i = 0; i < n; ++i) {
    q.push_back(builder.state("q" + std::to_string(i), {}));
    v.push_back(builder.state("v" + std::to_string(i), {}));
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    SX force = -2.5 * q[i] * q[i] * q[i] - builder.sign(v[i] - 0.2);
    if (i > 0) force += q[i - 1];
    if (i + 1 < q.size()) force += q[i + 1];
    builder.dynamics("q" + std::to_string(i), v[i]);
    builder.dynamics("v" + std::to_string(i), force);
  }
  return *builder.build();
}

std::vector<std::vector<double>> dense(const EntryPattern& pattern, const std::vector<double>& values) {
  std::vector<std::vector<double>> rows(at(pattern.rows), std::vector<double>(at(pattern.columns), 0.0));
  for (std::size_t j = 0; j < at(pattern.columns); ++j) {
    visit_column(pattern, values, j, [&](std::size_t i, double value) { rows[i][j] += value; });
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {  // the same by rows
    visit_row(pattern, values, i, [&](std::size_t j, double value) { EXPECT_EQ(rows[i][j], value); });
  }
  return rows;
}

TEST(StageKernel, LargeSystemsKeepTheEntriesThatCanBeOtherThanZero) {
  for (const int n : {5, 40}) {
    const auto system = blocks(n);
    const auto dcs = reformulation::reformulate(system, {.reformulation = Form::step, .lifting = std::nullopt});
    ASSERT_TRUE(dcs.has_value());
    const auto kernel = StageKernel::compile(*dcs, system.parameter_values);
    ASSERT_TRUE(kernel.has_value()) << to_text(kernel.error());
    const std::size_t n_x = kernel->states(), n_psi = kernel->selections();
    EXPECT_EQ(kernel->pattern().is_sparse, n == 40);
    EXPECT_EQ(kernel->pattern().f_x.size(), n == 40 ? 4 * n_psi - 2 : n_x * n_x);
    EXPECT_EQ(kernel->pattern().indicator_x.size(), n == 40 ? n_psi : n_psi * n_x);
    std::vector<double> x(n_x), selection(n_psi), f(n_x);
    for (std::size_t i = 0; i < n_x; ++i) x[i] = std::sin(static_cast<double>(i));
    for (std::size_t j = 0; j < n_psi; ++j) selection[j] = 0.5 + 0.4 * std::cos(static_cast<double>(j));
    StageValues values;
    kernel->size(values);
    kernel->evaluate(0.0, x.data(), selection.data(), nullptr, values);
    const auto f_x = dense(values.pattern->f_x, values.f_x);
    const auto f_selection = dense(values.pattern->f_selection, values.f_selection);
    const auto indicator_x = dense(values.pattern->indicator_x, values.indicator_x);
    for (std::size_t j = 0; j < n_x; ++j) {
      const double step = 1e-6, here = x[j];
      x[j] = here + step;
      kernel->field(0.0, x.data(), selection.data(), nullptr, f.data());
      x[j] = here;
      for (std::size_t i = 0; i < n_x; ++i) EXPECT_NEAR((f[i] - values.f[i]) / step, f_x[i][j], 1e-5);
    }
    for (std::size_t j = 0; j < n_psi; ++j) {
      EXPECT_EQ(f_selection[2 * j + 1][j], -2.0);
      EXPECT_EQ(indicator_x[j][2 * j + 1], 1.0);
    }
  }
}

}  // namespace
}  // namespace saltus::discretization
