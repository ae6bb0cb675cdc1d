#include "saltus/solver/homotopy/lead.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::solver::homotopy {
namespace {

std::vector<Level> levels(const Schedule& schedule) {
  std::vector<Level> all{{.sigma = schedule.sigma_initial, .mu = 1e-8}};
  while (const auto next = next_level(schedule, all.back())) all.push_back(*next);
  return all;
}

TEST(LeadingSigma, MuIsAHundredthOfSigma) {
  const auto all = levels({.sigma_initial = 1.0, .sigma_factor = 0.1, .sigma_final = 1e-10});
  for (std::size_t k = 1; k < all.size(); ++k) {
    EXPECT_TRUE(all[k].sigma < all[k - 1].sigma || all[k].mu < all[k - 1].mu);  // or the loop would never end
    EXPECT_LE(all[k].mu, std::max(1e-11, 1.0001e-2 * all[k].sigma));
  }
  EXPECT_DOUBLE_EQ(all[1].sigma, 0.1);
  EXPECT_DOUBLE_EQ(all[1].mu, 1e-3);
  EXPECT_DOUBLE_EQ(all.back().sigma, 1e-10);
  EXPECT_DOUBLE_EQ(all.back().mu, 1e-11);
}

TEST(LeadingSigma, TheLastFactorIsCutShort) {
  std::vector<double> sigmas;
  for (const Level& level : levels({.sigma_initial = 0.5, .sigma_factor = 0.2, .sigma_final = 3e-3})) {
    if (sigmas.empty() || level.sigma != sigmas.back()) sigmas.push_back(level.sigma);
  }
  ASSERT_EQ(sigmas.size(), 5u);
  const double expected[] = {0.5, 0.1, 0.02, 0.004, 0.003};
  for (std::size_t k = 0; k < sigmas.size(); ++k) EXPECT_DOUBLE_EQ(sigmas[k], expected[k]);
}

TEST(LeadingSigma, AtTheLastSigmaMuFallsAlone) {
  auto level =
      next_level({.sigma_initial = 1e-2, .sigma_factor = 0.1, .sigma_final = 1e-2}, {.sigma = 1e-2, .mu = 1e-4});
  ASSERT_TRUE(level);
  EXPECT_DOUBLE_EQ(level->sigma, 1e-2);
  EXPECT_DOUBLE_EQ(level->mu, 1e-6);  // 1e-4^1.5
  EXPECT_FALSE(
      next_level({.sigma_initial = 1.0, .sigma_factor = 0.1, .sigma_final = 1e-2}, {.sigma = 1e-2, .mu = 1e-11}));
}

TEST(LeadingSigma, TheFirstProblemIsSolvedToATenthOfItsBarrier) {
  EXPECT_DOUBLE_EQ(first_tolerance(0.1), 1e-4);
  EXPECT_DOUBLE_EQ(first_tolerance(1e-8), 1e-11);
  EXPECT_DOUBLE_EQ(first_tolerance(100.0), 1e-3);  // residuals do not grow with sigma
}

}  // namespace
}  // namespace saltus::solver::homotopy
