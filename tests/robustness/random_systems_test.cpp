// Random systems of four families: every run ends with a status, solves its system, and agrees between integrators.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "random_systems_campaign.hpp"

namespace saltus::robustness {
namespace {

class RandomSystems : public testing::TestWithParam<Family> {};

TEST_P(RandomSystems, AreSolvedOrRefusedWithAStatus) {
  const Tally tally = run_campaign(GetParam(), 0, 100);
  for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  // Enough of them must be solved and compared for the rest of the test to mean something.
  EXPECT_GE(2 * (tally.completed - tally.not_unique - tally.sensitive), tally.systems);
}

INSTANTIATE_TEST_SUITE_P(Families, RandomSystems, testing::ValuesIn(families),
                         [](const auto& instance) { return name(instance.param); });

}  // namespace
}  // namespace saltus::robustness
