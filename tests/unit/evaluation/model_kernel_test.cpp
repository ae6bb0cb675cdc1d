#include "saltus/evaluation/model_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <casadi/core/function.hpp>
#include <gtest/gtest.h>

#include "blank_system.hpp"
#include "saltus/evaluation/field_structure.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

model::SwitchingFunction surface(const std::string& name, const SX& psi) {
  model::SwitchingFunction function;
  function.name = name;
  function.psi = psi;
  return function;
}

/// Two states, an input u = p t, a curved, a nested and a time surface, one event expression and one condition.
model::System example() {
  model::System s = blank_system(0.75, 3);
  const SX a = s.x(0);
  const SX b = s.x(1);
  s.switching = {surface("circle", a * a + b * b - 1.0), surface("nested", b + a * s.alpha(0) - s.u),
                 surface("clock", sin(s.t) - 0.5)};
  s.f = SX::vertcat({b + s.alpha(0) * sin(s.t), -a + s.u * s.alpha(1) - s.alpha(2)});
  s.f_as_written = s.f;
  s.outputs = SX::vertcat({a * s.alpha(0)});
  model::UserEvent zero;
  zero.name = "zero";
  zero.value = a - 3.0 * b;
  zero.guards = SX(0, 1);
  model::UserEvent condition;
  condition.name = "condition";
  condition.guards = SX::vertcat({a - 1.0, b + 2.0});
  condition.guard_alpha = SX::sym("g", 2);
  condition.value = condition.guard_alpha(0) * (1.0 - condition.guard_alpha(1));
  condition.true_at_equality = {false, true};
  s.events = {condition, zero};
  return s;
}

/// A ring of x_i' = sin(x_(i-1)) - p x_i + (2 alpha_i - 1) with affine surfaces.
model::System ring(int n) {
  model::System s = blank_system(0.75, n);
  s.x = SX::sym("x", n);
  s.alpha = SX::sym("alpha", n);
  std::vector<SX> f;
  for (int i = 0; i < n; ++i) {
    s.switching.push_back(surface("s" + std::to_string(i), s.x(i) - 0.5 * s.x((i + 1) % n) - 0.25 * s.t));
    f.push_back(sin(s.x((i + n - 1) % n)) - s.p(0) * s.x(i) + (2 * s.alpha(i) - 1));
  }
  s.f = s.f_as_written = SX::vertcat(f);
  s.initial_state.assign(static_cast<std::size_t>(n), 0.0);
  return s;
}

TEST(ModelKernel, RowsHaveTheBitsOfTheField) {
  for (const int n : {3, 100}) {  // of which rate() evaluates all of f, and few rows
    const auto kernel = ModelKernel::compile(ring(n));
    ASSERT_TRUE(kernel.has_value());
    const auto* structure = kernel->field_structure();
    ASSERT_NE(structure, nullptr);
    const auto last = static_cast<std::size_t>(n) - 1;
    EXPECT_EQ(structure->states[0], (std::vector<std::size_t>{0, last}));
    EXPECT_EQ(structure->selections[last], (std::vector<std::size_t>{last}));
    EXPECT_EQ(structure->rows_of_state[0], (std::vector<std::size_t>{0, 1}));
    EXPECT_EQ(structure->rows_of_selection[1], (std::vector<std::size_t>{1}));
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(0.0, 1.0);
    std::vector<double> x(last + 1), alpha(last + 1), field(last + 1), row(last + 1);
    for (auto* values : {&x, &alpha}) {
      for (double& value : *values) value = number(random);
    }
    kernel->field(0.3, x.data(), alpha.data(), field.data());
    for (std::size_t i = 0; i <= last; ++i) EXPECT_EQ(kernel->field_row(i, 0.3, x.data(), alpha.data()), field[i]);
    for (int j = 0; j < n; ++j) {
      double rate = 0.0;
      kernel->gradient(j, 0.3, x.data(), alpha.data(), row.data(), &rate);
      for (std::size_t i = 0; i <= last; ++i) rate += row[i] * field[i];
      EXPECT_EQ(kernel->rate(j, 0.3, x.data(), alpha.data()), rate) << j;
    }
  }
}

/// Of every kind of operation; the last one is affine.
model::System curved() {
  model::System s = blank_system(0.75, 8);
  const SX a = s.x(0), b = s.x(1);
  int number = 0;
  s.switching.clear();
  for (const SX& psi : {SX(a * a + b * b - 1.0), SX(sin(3.0 * a) / (2.0 + cos(b))), SX(sqrt(a + 1.0) * exp(b) - s.t),
                        SX(tanh(a * b) + fabs(b) * s.p), SX(1.0 / (a - 3.0)), SX(fmax(a, b) * fmin(a, 2.0 * b)),
                        SX(atan(a) * sin(40.0 * b)), SX(a - 2.0 * b)}) {
    s.switching.push_back(surface("s" + std::to_string(number++), psi));
  }
  s.f = s.f_as_written = SX::vertcat({b, -a});
  return s;
}

TEST(ModelKernel, RangesHoldTheValuesOfAllPointsWithinBounds) {
  const auto kernel = ModelKernel::compile(curved());
  ASSERT_TRUE(kernel.has_value());
  const std::vector<double> alpha(8, 1.0);
  std::vector<double> middle(8), radius(8), values(8), least(8), largest(8);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inside(-1.0, 1.0);
  for (int box = 0; box < 200; ++box) {
    const double t = inside(random), x[] = {0.9 * inside(random), inside(random)};
    const double size = std::exp2(-1.0 - box / 10.0);
    const double radii[] = {size, 0.2 * size, size};
    kernel->ranges(t, x, alpha.data(), radii, middle.data(), radius.data());
    least = largest = middle;
    for (int point = 0; point < 50; ++point) {
      const double moved[] = {x[0] + radii[1] * inside(random), x[1] + radii[2] * inside(random)};
      kernel->functions(t + radii[0] * inside(random), moved, alpha.data(), values.data());
      for (std::size_t j = 0; j + 1 < values.size(); ++j) {
        if (std::isnan(radius[j])) continue;  // sqrt(a + 1) where a may be below -1
        EXPECT_LE(std::abs(values[j] - middle[j]), radius[j] + 1e-14) << j;
        least[j] = std::min(least[j], values[j]);
        largest[j] = std::max(largest[j], values[j]);
      }
    }
    for (const std::size_t j : {0U, 1U, 2U, 4U}) {
      if (std::isnan(radius[j])) continue;
      EXPECT_LE(radius[j], 0.1 * size + 5.0 * (largest[j] - least[j])) << j;
    }
    EXPECT_EQ(middle.back(), 0.0);
    EXPECT_EQ(radius.back(), 0.0);
  }
}

TEST(ModelKernel, RangesThatHoldAPoleAreNotFinite) {
  const auto kernel = ModelKernel::compile(curved());
  ASSERT_TRUE(kernel.has_value());
  const std::vector<double> alpha(8, 1.0);
  std::vector<double> middle(8), radius(8);
  const double x[] = {3.1, 0.0}, near[] = {0.0, 0.05, 0.0}, beyond[] = {0.0, 0.2, 0.0};
  kernel->ranges(0.0, x, alpha.data(), near, middle.data(), radius.data());
  EXPECT_NEAR(middle[4], 10.0, 1e-12);
  EXPECT_NEAR(radius[4], 10.0, 1e-12);  // 1/0.05 is 10 more
  kernel->ranges(0.0, x, alpha.data(), beyond, middle.data(), radius.data());
  EXPECT_FALSE(std::isfinite(radius[4]));
}

TEST(ModelKernel, NumbersFunctionsAndEvaluatesThem) {
  const auto kernel = ModelKernel::compile(example());
  ASSERT_TRUE(kernel.has_value());
  EXPECT_EQ(kernel->states(), 2);
  EXPECT_EQ(kernel->switching_functions(), 3);
  EXPECT_EQ(kernel->event_functions(), 6);
  const double t = 0.5;
  const double x[] = {0.3, -0.4};
  const double alpha[] = {0.25, 1.0, 0.0};
  double values[6];
  kernel->functions(t, x, alpha, values);
  EXPECT_DOUBLE_EQ(values[0], 0.09 + 0.16 - 1.0);
  EXPECT_DOUBLE_EQ(values[1], -0.4 + 0.3 * 0.25 - 0.375);
  EXPECT_DOUBLE_EQ(values[3], 0.3 + 1.2);  // expressions come before guards
  EXPECT_DOUBLE_EQ(values[4], 0.3 - 1.0);
  double f[2];
  kernel->field(t, x, alpha, f);
  EXPECT_DOUBLE_EQ(f[1], -0.3 + 0.375);
  double u = 0.0;
  kernel->inputs(t, alpha, &u);
  EXPECT_DOUBLE_EQ(u, 0.375);
  const double guards_true[] = {1.0, 0.0};
  const double guards_false[] = {1.0, 1.0};
  EXPECT_TRUE(kernel->condition(0, t, x, alpha, guards_true));
  EXPECT_FALSE(kernel->condition(0, t, x, alpha, guards_false));
  EXPECT_EQ(kernel->field_evaluations(), 1);
}

TEST(ModelKernel, KernelsOfOneCompiledModelDoNotSeeEachOther) {
  auto first = ModelKernel::compile(example());
  ASSERT_TRUE(first.has_value());
  auto second = ModelKernel::of(first->compiled(), NativeCode::off);
  ASSERT_TRUE(second.has_value());
  auto changed = example();
  changed.parameter_values = {7.0};
  changed.initial_state[0] += 1.0;
  ASSERT_TRUE(second->set_values(changed));
  EXPECT_EQ(second->initial_state(), changed.initial_state);
  EXPECT_EQ(first->initial_state(), example().initial_state);
  const double t = 0.5;
  const double x[] = {0.3, -0.4};
  const double alpha[] = {0.25, 1.0, 0.0};
  double u = 0.0;
  first->inputs(t, alpha, &u);
  EXPECT_DOUBLE_EQ(u, 0.375);
  second->inputs(t, alpha, &u);
  EXPECT_DOUBLE_EQ(u, 3.5);
  const double rate = second->lie_derivative(0, 2, t, x, alpha);
  first.emplace(std::move(*ModelKernel::of(second->compiled(), NativeCode::off)));
  EXPECT_NE(first->lie_derivative(0, 2, t, x, alpha), rate);  // of other parameters
  ASSERT_TRUE(first->set_values(changed));
  EXPECT_EQ(first->lie_derivative(0, 2, t, x, alpha), rate);
  EXPECT_EQ(first->field_evaluations(), 0);
}

TEST(ModelKernel, KnowsTheStructure) {
  const auto kernel = ModelKernel::compile(example());
  ASSERT_TRUE(kernel.has_value());
  EXPECT_FALSE(kernel->is_affine(0));
  EXPECT_TRUE(kernel->is_affine(1));
  EXPECT_EQ(kernel->inner(1), (std::vector<int>{0}));
  EXPECT_TRUE(kernel->depends(0, 0));
  EXPECT_TRUE(kernel->depends(0, 2));
  EXPECT_FALSE(kernel->depends(2, 0));
}

TEST(ModelKernel, DerivativesAgreeWithFiniteDifferences) {
  const auto kernel = ModelKernel::compile(example());
  ASSERT_TRUE(kernel.has_value());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int trial = 0; trial < 20; ++trial) {
    const double t = uniform(random);
    const double x[] = {uniform(random), uniform(random)};
    const double alpha[] = {std::abs(uniform(random)), std::abs(uniform(random)), std::abs(uniform(random))};
    double f[2];
    kernel->field(t, x, alpha, f);
    const double h = 1e-6;  // central difference: error h^2 |third derivative| + eps/h, both below 1e-9
    for (int j = 0; j < 6; ++j) {
      double row[2];
      double rate = 0.0;
      kernel->gradient(j, t, x, alpha, row, &rate);
      const auto value = [&](double dt, double d0, double d1) {
        const double moved[] = {x[0] + d0, x[1] + d1};
        double values[6];
        kernel->functions(t + dt, moved, alpha, values);
        return values[j];
      };
      EXPECT_NEAR(row[0], (value(0, h, 0) - value(0, -h, 0)) / (2 * h), 1e-8);
      EXPECT_NEAR(row[1], (value(0, 0, h) - value(0, 0, -h)) / (2 * h), 1e-8);
      EXPECT_NEAR(rate, (value(h, 0, 0) - value(-h, 0, 0)) / (2 * h), 1e-8);
      EXPECT_NEAR(kernel->lie_derivative(j, 1, t, x, alpha), row[0] * f[0] + row[1] * f[1] + rate, 1e-14);
      const auto first = [&](double s) {
        const double moved[] = {x[0] + s * f[0], x[1] + s * f[1]};
        return kernel->lie_derivative(j, 1, t + s, moved, alpha);
      };
      EXPECT_NEAR(kernel->lie_derivative(j, 2, t, x, alpha), (first(h) - first(-h)) / (2 * h), 1e-7);
    }
    double magnitude[6];
    double slope[6];
    kernel->scales(t, x, alpha, magnitude, slope);
    double row[2];
    double rate = 0.0;
    kernel->gradient(0, t, x, alpha, row, &rate);
    EXPECT_NEAR(magnitude[0], std::abs(row[0] * x[0]) + std::abs(row[1] * x[1]) + std::abs(rate * t), 1e-14);
    EXPECT_NEAR(slope[0], std::abs(row[0]) + std::abs(row[1]), 1e-14);
  }
}

TEST(ModelKernel, RowsOfAffineFunctionsAreTheFunctions) {
  auto system = example();
  system.events[1].value = floor(system.x(0)) + system.x(1);  // flat where it is smooth, and not affine
  const auto kernel = ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  const bool affine[] = {false, true, false, false, true, true};
  const double t = 0.5;
  const double x[] = {0.3, -0.4};
  const double alpha[] = {0.25, 1.0, 0.0};
  double values[6];
  kernel->functions(t, x, alpha, values);
  AffineRows rows;
  kernel->affine_rows(alpha, rows);
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_EQ(kernel->is_affine(static_cast<int>(j)), affine[j]) << j;
    EXPECT_EQ(std::isnan(rows.offset[j]), !affine[j]) << j;
    double sum = rows.offset[j] + rows.rate[j] * t;
    for (std::size_t k = rows.start[j]; k < rows.start[j + 1]; ++k) sum += rows.coefficient[k] * x[rows.column[k]];
    if (affine[j]) {
      EXPECT_NEAR(sum, values[j], 1e-15) << j;
    }
  }
}

TEST(ModelKernel, RowsOfLieDerivatives) {
  auto system = example();
  system.switching[1].psi = system.x(1);
  const SX a = system.x(0);
  const SX b = system.x(1);
  system.f = SX::vertcat({b, a * b * b + system.t});
  const auto kernel = ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  const double alpha[] = {0.25, 1.0, 0.0};
  AffineRow row;
  EXPECT_FALSE(kernel->lie_row(1, {}, alpha, row));
  ASSERT_TRUE(kernel->lie_row(1, {1, 0.7}, alpha, row));  // affine where b is held
  const double x[] = {0.3, 0.7};
  const double expected = kernel->lie_derivative(1, 1, 2.0, x, alpha);
  double value = row.offset + row.rate * 2.0;
  for (std::size_t k = 0; k < row.column.size(); ++k) {
    value += row.coefficient[k] * x[row.column[k]];
    if (row.column[k] == 1) {
      EXPECT_EQ(row.coefficient[k], 0.0);
    }
  }
  EXPECT_NEAR(value, expected, 1e-15);
}

TEST(ModelKernel, PreparedFieldsHaveTheSameBits) {
  const auto system = example();
  const auto kernel = ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  const casadi::Function whole("whole", {system.t, system.x, system.p, system.alpha},
                               {SX::substitute(system.f, system.u, system.input)});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  for (int trial = 0; trial < 100; ++trial) {
    const double t = uniform(random);
    const std::vector<double> x{uniform(random), uniform(random)};
    const std::vector<double> alpha{uniform(random), uniform(random), uniform(random)};
    FieldConstants constants;
    kernel->prepare_field(alpha.data(), constants);
    std::vector<double> prepared(2);
    std::vector<double> field(2);
    kernel->prepared_field(t, x.data(), constants, prepared.data());
    kernel->field(t, x.data(), alpha.data(), field.data());
    const auto expected = whole(std::vector<casadi::DM>{t, x, 0.75, alpha}).front().nonzeros();
    EXPECT_EQ(prepared, expected);
    EXPECT_EQ(field, expected);
  }
}

}  // namespace
}  // namespace saltus::evaluation
