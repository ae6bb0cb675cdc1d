// Functions of one stage: lifted variables are replaced by their products, whatever is lifted.
#include "saltus/discretization/stage_kernel.hpp"

#include <array>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "fesd_models.hpp"

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

}  // namespace
}  // namespace saltus::discretization
