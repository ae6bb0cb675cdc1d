#include "saltus/frontend/best_of_starts.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::frontend {
namespace {

using result::Termination;

/// What a worker found from the start of one seed.
std::shared_ptr<result::Result> optimum(int seed, Termination termination, double objective, double infeasibility) {
  auto found = std::make_shared<result::Result>();
  found->model.settings = {"mu=1", "optimize.mpcc.starts=4", "optimize.mpcc.seed=" + std::to_string(seed)};
  found->options = {{"optimize.mpcc.seed", std::int64_t{seed}}};
  result::Optimization of;
  of.objective = objective;
  of.statistics.iterations = 10 * (seed + 1);
  of.starts = {{.seed = seed,
                .termination = termination,
                .objective = objective,
                .infeasibility = infeasibility,
                .iterations = of.statistics.iterations,
                .is_taken = true}};
  found->optimization = std::move(of);
  return found;
}

TEST(BestOfStarts, IsTheLowestThatIsCompleted) {
  const auto best =
      best_of_starts({optimum(2, Termination::completed, 3.0, 0.0), optimum(0, Termination::infeasible, 1.0, 0.5),
                      optimum(3, Termination::completed, 2.0, 0.0), optimum(1, Termination::completed, 2.0, 0.0)});
  const auto& of = *best.optimization;
  EXPECT_EQ(of.objective, 2.0);
  ASSERT_EQ(of.starts.size(), 4u);
  for (int seed = 0; seed < 4; ++seed) {
    const auto& start = of.starts[static_cast<std::size_t>(seed)];
    EXPECT_EQ(start.seed, seed);
    EXPECT_EQ(start.is_taken, seed == 1) << "of equal ones the first";
  }
  EXPECT_EQ(of.statistics.iterations, 10 + 20 + 30 + 40);
  EXPECT_EQ(best.model.settings, (std::vector<std::string>{"mu=1", "optimize.mpcc.starts=4"}));
  EXPECT_EQ(std::get<std::string>(best.options.front().second), "none");
}

TEST(BestOfStarts, ViolatesTheLeastWhereNoneIsCompleted) {
  const auto best =
      best_of_starts({optimum(0, Termination::infeasible, 1.0, 0.5), optimum(1, Termination::not_converged, 5.0, 0.1)});
  EXPECT_EQ(best.optimization->objective, 5.0);
  EXPECT_TRUE(best.optimization->starts[1].is_taken);
}

}  // namespace
}  // namespace saltus::frontend
