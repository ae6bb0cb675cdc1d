// The Jacobian of a field, against differences.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

/// States in a chain, each moved by its neighbours and by the selection of a surface; the last one is discrete.
model::System chain(int n) {
  model::System s;
  s.t = SX::sym("t");
  s.x = SX::sym("x", n);
  s.u = SX(0, 1);
  s.p = SX::sym("p", 1);
  s.alpha = SX::sym("alpha", 1);
  s.parameter_names = {"k"};
  s.parameter_values = {1.5};
  s.discrete_states.assign(static_cast<std::size_t>(n), false);
  s.discrete_states.back() = true;
  model::SwitchingFunction surface;
  surface.name = "surface";
  surface.psi = s.x(0) - 0.5;
  s.switching = {surface};
  std::vector<SX> rows;
  for (int i = 0; i < n; ++i) {
    s.state_names.push_back("x" + std::to_string(i));
    s.initial_state.push_back(0.1);
    const SX right = s.x(i + 1 < n ? i + 1 : 0);
    rows.push_back(i + 1 < n ? s.p * sin(s.x(i) * right) - s.t * right + s.alpha * s.x(i) : SX(0.0));
  }
  s.f = s.f_as_written = SX::vertcat(rows);
  s.outputs = SX(0, 1);
  s.input = SX(0, 1);
  return s;
}

/// All of it, column by column.
std::vector<double> dense(const ModelKernel& kernel, double t, const std::vector<double>& x) {
  const std::size_t n = x.size();
  const auto* pattern = kernel.jacobian_pattern();
  const double alpha = 0.25;
  std::vector<double> entries(pattern != nullptr ? pattern->row.size() : n * n), all(n * n, 0.0);
  EXPECT_TRUE(kernel.field_jacobian(t, x.data(), &alpha, entries.data()));
  if (pattern == nullptr) return entries;
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = pattern->start[j]; k < pattern->start[j + 1]; ++k) all[j * n + pattern->row[k]] = entries[k];
  }
  return all;
}

TEST(FieldJacobian, AgreesWithDifferencesWhereverThereIsAPattern) {
  for (const int n : {4, 40}) {
    const auto kernel = ModelKernel::compile(chain(n));
    ASSERT_TRUE(kernel.has_value());
    EXPECT_EQ(kernel->jacobian_pattern() != nullptr, n == 40);
    const double t = 0.3, alpha = 0.25, h = 1e-6;
    const auto size = static_cast<std::size_t>(n);
    std::vector<double> x(size), before(size), behind(size);
    for (std::size_t i = 0; i < size; ++i) x[i] = std::cos(static_cast<double>(3 * i));
    const auto jacobian = dense(*kernel, t, x);
    for (std::size_t j = 0; j < size; ++j) {
      auto moved = x;
      moved[j] = x[j] - h;
      kernel->field(t, moved.data(), &alpha, before.data());
      moved[j] = x[j] + h;
      kernel->field(t, moved.data(), &alpha, behind.data());
      for (std::size_t i = 0; i < size; ++i) {
        // The discrete state does not move: what depends on it need not be known.
        const double exact = j + 1 < size ? (behind[i] - before[i]) / (2.0 * h) : 0.0;
        EXPECT_NEAR(jacobian[j * size + i], exact, 1e-8) << i << " " << j;
      }
    }
  }
}

TEST(FieldJacobian, IsNotKnownWhereItIsNotFinite) {
  auto system = chain(4);
  system.f(0) = sqrt(system.x(1));
  system.f_as_written = system.f;
  const auto kernel = ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  const double alpha = 0.0, x[] = {1.0, 0.0, 1.0, 1.0};
  double entries[16];
  EXPECT_FALSE(kernel->field_jacobian(0.0, x, &alpha, entries));
}

}  // namespace
}  // namespace saltus::evaluation
