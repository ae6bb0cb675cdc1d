// What a problem of many intervals needs grows with their number and no faster. Without a clock: times are measured by
// benchmarks/micro/io_optimal_control_size.
#include <algorithm>
#include <array>
#include <malloc.h>
#include <string>

#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "source_folder.hpp"

namespace saltus::ocp_tests {
namespace {

pipeline::StatedProblem cart_pole(long intervals) {
  auto read = io::read_model(tests::source_folder("models/cart-pole.toml"));
  EXPECT_TRUE(read) << (read ? "" : to_text(read.error()));
  auto ocp = model::build_ocp(read->description);
  EXPECT_TRUE(ocp) << (ocp ? "" : to_text(ocp.error()));
  auto options = *read->optimize;
  options.control_intervals = intervals;
  auto made = pipeline::state_problem(*ocp, options);
  EXPECT_TRUE(made) << (made ? "" : to_text(made.error()));
  return std::move(*made);
}

/// Variables, equations, pairs, entries of Jacobian and Hessian.
std::array<int, 5> sizes(long intervals) {
  const auto made = cart_pole(intervals);
  const auto& problem = *made.problem;
  return {problem.variables(), problem.constraints(), problem.pairs(), problem.jacobian_pattern().entries(),
          problem.hessian_pattern().entries()};
}

TEST(OcpSize, EveryIntervalAddsTheSame) {
  const auto few = sizes(20), more = sizes(21), many = sizes(200);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(many[i] - few[i], 180 * (more[i] - few[i])) << i;
  // Three elements of four stages: at each, four states, one selection and two multipliers; their lengths; the control.
  EXPECT_EQ(more[0] - few[0], 3 * (4 * (4 + 1 + 2) + 1) + 1);
  EXPECT_EQ(more[2] - few[2], 3 * 2);
  // Entries that are there but always zero would be as expensive as others.
  EXPECT_LE(more[3] - few[3], 600);
  EXPECT_LE(more[4] - few[4], 600);
}

double used_bytes() {
  const auto used = mallinfo2();
  return static_cast<double>(used.uordblks) + static_cast<double>(used.hblkhd);
}

/// Of a problem with its places, patterns and work space.
double bytes(long intervals) {
  const double before = used_bytes();
  const auto made = cart_pole(intervals);
  return used_bytes() - before;
}

TEST(OcpSize, MemoryIsLinear) {
  static_cast<void>(bytes(20));  // what is kept for the next problem is not counted
  const double few = bytes(20), more = bytes(200), many = bytes(2000);
  const double slope = (more - few) / 180.0;
  EXPECT_NEAR((many - more) / 1800.0, slope, 0.1 * slope);
}

}  // namespace
}  // namespace saltus::ocp_tests
