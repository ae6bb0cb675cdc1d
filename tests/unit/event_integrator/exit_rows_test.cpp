// Exit functions that are kept are those that the kernel makes.
#include "saltus/event_integrator/sliding/exit_rows.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;

/// The exit function of x0 depends on the selection of x1, linear in x1; that of x1 is linear in x0 alone.
model::System two_surfaces() {
  auto s = testing::blank(2, 2);
  testing::add_surface(s, "x0", s.x(0));
  testing::add_surface(s, "x1", s.x(1));
  const SX sign_0 = 2 * s.alpha(0) - 1, sign_1 = 2 * s.alpha(1) - 1;
  testing::set_field(s, {3 * s.x(1) - 2 * sign_0 + (5 + s.x(1)) * sign_1, 7 * s.x(0) - sign_1}, {0.0, 0.0});
  return s;
}

TEST(ExitRows, AreThoseOfTheSelectionsAskedFor) {
  const auto kernel = evaluation::ModelKernel::compile(two_surfaces());
  ASSERT_TRUE(kernel.has_value());
  ExitRows rows(*kernel);
  // More selections beside the surface than are kept; each comes back.
  for (int pass = 0; pass < 3; ++pass) {
    for (const auto how : {ExitRows::Rows::lasting, ExitRows::Rows::changing}) {
      for (const double beside : {0.0, 1.0, 0.25, 0.5, 0.75, 0.125}) {
        for (const double side : {0.0, 1.0}) {
          const auto* row = rows.of(0, side, {}, {0.5, beside}, how);
          ASSERT_NE(row, nullptr);
          EXPECT_EQ(row->column, (std::vector<std::size_t>{1}));
          EXPECT_DOUBLE_EQ(row->coefficient.front(), 3.0 + (2.0 * beside - 1.0));
          EXPECT_DOUBLE_EQ(row->offset, -2.0 * (2.0 * side - 1.0) + 5.0 * (2.0 * beside - 1.0));
        }
      }
    }
  }
}

TEST(ExitRows, AStateHeldFixedIsInTheOffset) {
  const auto kernel = evaluation::ModelKernel::compile(two_surfaces());
  ASSERT_TRUE(kernel.has_value());
  ExitRows rows(*kernel);
  for (const double value : {2.0, -1.0, 2.0}) {
    const auto* row = rows.of(1, 1.0, {0, value}, {0.0, 0.5}, ExitRows::Rows::lasting);
    ASSERT_NE(row, nullptr);
    EXPECT_DOUBLE_EQ(row->offset, 7.0 * value - 1.0);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
