#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "ode_tools.hpp"
#include "saltus/ode/bernstein.hpp"

namespace saltus::ode {
namespace {

using saltus::tests::allocations;

using namespace trial;

TEST(Allocation, is_counted) {
  const long before = allocations;
  const std::vector<double> vector(10);
  EXPECT_EQ(allocations, before + 1);
  EXPECT_EQ(vector.size(), 10U);
}

TEST(Allocation, none_in_the_loop_over_steps) {
  for (const Method method : all_methods) {
    Stepper stepper(method, Kepler::n);
    StepControl control(method);
    DenseStep dense;
    std::vector<double> x = Kepler::exact(0.0);
    std::vector<double> slope(x.size());
    std::vector<double> point(x.size());
    Kepler{}(0.0, x.data(), slope.data());
    double h = 0.01;
    long before = 0;
    for (int k = 0; k < 20; ++k) {
      ASSERT_EQ(stepper.attempt(Kepler{}, 0.0, x.data(), slope.data(), h, {}), Attempt::finite);
      h *= stepper.error_norm() > 1.0 ? control.rejected(stepper.error_norm()) : control.accepted(stepper.error_norm());
      ASSERT_EQ(stepper.dense(Kepler{}, dense), Attempt::finite);
      dense.evaluate(0.3, point.data());
      dense.derivative(0.3, point.data());
      if (k == 0) before = allocations;  // the dense output has got its storage now
    }
    EXPECT_EQ(allocations, before);
  }
}

TEST(Allocation, none_in_the_search_for_sign_changes) {
  const long before = allocations;
  const std::array<double, event_nodes> values{1.0, 0.5, -0.5, -1.0, 0.1, 1.0, 1.0, -0.2, -1.0};
  EXPECT_TRUE(first_sign_change(to_bernstein(values), 1, 0, 1e-15).has_value());
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace saltus::ode
