// Runs of one system in several threads share its compiled model, and nothing else.
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::problems {
namespace {

using result::Result;

void expect_same_bits(const Result& found, const Result& expected, const std::string& name) {
  EXPECT_EQ(found.status.termination, expected.status.termination) << name;
  EXPECT_EQ(found.final.t, expected.final.t) << name;
  EXPECT_EQ(found.final.x, expected.final.x) << name;
  ASSERT_EQ(found.events.size(), expected.events.size()) << name;
  for (std::size_t i = 0; i < found.events.size(); ++i) {
    EXPECT_EQ(found.events[i].t, expected.events[i].t) << name << ", event " << i;
    EXPECT_EQ(found.events[i].x_after, expected.events[i].x_after) << name << ", event " << i;
  }
}

// Sliding, jumps that accumulate and hold, cells of tables, roots on surfaces, Jacobians, series, contacts.
TEST(Threads, RunsOfOneSystemAreThoseOfOneThread) {
  constexpr int threads = 4;
  for (const std::string name : {"stick-slip", "bouncing-ball", "estimator", "super-twisting", "friction-blocks",
                                 "slide-and-hide", "three-carts", "quadrants"}) {
    const Simulator simulator = Simulator::from_catalogue(name);
    for (const auto& accuracy : {standard, implicit, series}) {
      const auto options = with(simulator.options(), accuracy);
      const Result expected = simulator.run(options);
      pipeline::KernelStore kernels;
      std::vector<Result> found(2 * threads);
      std::vector<std::thread> running;
      for (std::size_t i = 0; i < threads; ++i) {
        running.emplace_back([&, i] {
          found[i] = simulator.run(options, &kernels);
          found[i + threads] = simulator.run(options, &kernels);
        });
      }
      for (auto& thread : running) thread.join();
      for (const auto& result : found) expect_same_bits(result, expected, name);
    }
  }
}

}  // namespace
}  // namespace saltus::problems
