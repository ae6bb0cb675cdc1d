// More than ten thousand random systems, a tenth of them in `make test`: what random_systems_test.cpp does with a few
// hundred.
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "campaign.hpp"
#include "random_systems_campaign.hpp"

namespace saltus::robustness {
namespace {

class TenThousandSystems : public testing::TestWithParam<Family> {};

TEST_P(TenThousandSystems, AreSolvedOrRefusedWithAStatus) {
  const auto first = systems_of_short_campaign;
  const Tally tally = run_campaign(GetParam(), first, of_campaign<std::uint64_t>(2500) - first);
  for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  fmt::print("{}: {} systems, {} completed, {} outside the class; of the completed {} not unique, {} sensitive\n",
             name(GetParam()), tally.systems, tally.completed, tally.outside_class, tally.not_unique, tally.sensitive);
  // Codimension 2 is met by a fifth of the coupled systems.
  EXPECT_GE(tally.completed - tally.not_unique - tally.sensitive, tally.systems * 7 / 10);
}

INSTANTIATE_TEST_SUITE_P(Families, TenThousandSystems, testing::ValuesIn(families),
                         [](const auto& instance) { return name(instance.param); });

/// Systems that were got wrong once and take long.
TEST(LongRandomSystems, OnesThatFailedOnceAreSolvedOrRefused) {
  constexpr std::pair<Family, std::uint64_t> systems[] = {
      {Family::affine, 1579},     {Family::affine, 48107},    {Family::affine, 667},
      {Family::affine, 98864},    {Family::constant, 204603}, {Family::constant, 212232},
      {Family::constant, 228883}, {Family::constant, 4496},   {Family::nested, 9661}};
  for (const auto& [family, seed] : systems) {
    const Tally tally = run_campaign(family, seed, 1);
    for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  }
}

}  // namespace
}  // namespace saltus::robustness
