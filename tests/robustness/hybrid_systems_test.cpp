// Random systems with jumps, hysteresis, moving surfaces and regions by indicator: every run ends with a status, and
// what it says is true.
#include "hybrid_systems.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "campaign.hpp"
#include "changed_results.hpp"
#include "region_systems.hpp"

namespace saltus::robustness {
namespace {

class HybridSystems : public testing::TestWithParam<HybridFamily> {};

TEST_P(HybridSystems, AreSolvedOrRefusedWithAStatus) {
  const Tally tally = run_campaign(GetParam(), 0, of_short_campaign<std::uint64_t>(100));
  for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  EXPECT_GE(10 * (tally.completed - tally.sensitive), 9 * tally.systems);
  EXPECT_GE(tally.jumps, 50 * tally.systems);
}

INSTANTIATE_TEST_SUITE_P(Families, HybridSystems, testing::ValuesIn(hybrid_families),
                         [](const auto& instance) { return name(instance.param); });

TEST(RegionSystems, AreSolvedOrRefusedWithAStatus) {
  const Tally tally = run_region_campaign(0, 100);
  for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  EXPECT_GE(10 * (tally.completed - tally.not_unique - tally.sensitive), 9 * tally.systems);
  EXPECT_GE(tally.held_by_three, 100);
}

/// Systems that were got wrong once: states went through walls that they had come to rest at; friction in the direction
/// of a wall at which a mass rests, on belts at rest or that stop. In 100348 a threshold is exceeded, undone and
/// exceeded again by three others before it fires, twice, which the check had taken for once.
TEST(HybridSystems, OnesThatFailedOnceAreSolvedOrRefused) {
  for (const std::uint64_t seed :
       {1305U, 1495U, 1727U, 2213U, 510U, 729U, 1013U, 2434U, 2562U, 3036U, 3211U, 10912U, 100348U}) {
    const Tally tally = run_campaign(HybridFamily::jumps, seed, 1);
    for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  }
}

/// Seven regions at a point of space, of which six hold all states: the sign of the seventh indicator is a rounding of
/// theirs.
TEST(RegionSystems, OnesThatFailedOnceAreSolved) {
  const Tally tally = run_region_campaign(10198, 1);
  for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
  EXPECT_EQ(tally.completed, 1);
}

/// Regions of one indicator (908, 11810; 95882 meets a third one there), and six that some weights hold together at a
/// point, but not their own.
TEST(RegionSystems, OnesThatFailedOnceAreRefused) {
  for (const std::uint64_t seed : {908U, 1491U, 11810U, 95882U}) {
    const Tally tally = run_region_campaign(seed, 1);
    for (const auto& failure : tally.failures) ADD_FAILURE() << failure;
    EXPECT_EQ(tally.outside_class, 1);
  }
}

TEST(HybridSystemsJudge, FindsPlantedMistakes) {
  const Hybrid system = draw(HybridFamily::jumps, 0);
  const result::Result good = HybridModel(system).run(HybridIntegrator::dopri5, 1e-8, system.start);
  ASSERT_EQ(complaint(system, good, 1e-8), "");
  std::size_t jump = 0;
  while (good.events[jump].kind != result::EventKind::jump) ++jump;
  ASSERT_EQ(system.walls.size(), 1U);
  const std::size_t v = system.walls[0].velocity;
  const std::function<void(result::Result&)> mistakes[] = {
      [](result::Result& r) { r.status.termination = result::Termination::iteration_limit; },
      [&](result::Result& r) { change_events(r, [&](auto& events) { events[jump].x_after[v] *= 1.0 + 1e-9; }); },
      [&](result::Result& r) {
        change_events(r, [&](auto& events) { events[jump].x[system.walls[0].position] += 1e-6; });
      },
      [](result::Result& r) { r.trajectory.x.change(1)[0] += 1e-6; },
      [](result::Result& r) { change_rows<result::Mode>(r.trajectory.mode, [](auto& rows) { rows[1][0] *= -1; }); },
      [](result::Result& r) { std::swap(r.trajectory.t[1], r.trajectory.t[2]); },
      [](result::Result& r) { r.final.t -= 1.0; },
  };
  for (std::size_t i = 0; i < std::size(mistakes); ++i) {
    result::Result bad = good;
    mistakes[i](bad);
    EXPECT_NE(complaint(system, bad, 1e-8), "") << "mistake " << i;
  }
}

/// In 100348 four thresholds fire at one time, the last one twice.
TEST(HybridSystemsJudge, CountsHowOftenThresholdsFire) {
  const Hybrid system = draw(HybridFamily::jumps, 100348);
  const result::Result good = HybridModel(system).run(HybridIntegrator::dop853, 1e-8, system.start);
  ASSERT_EQ(complaint(system, good, 1e-8), "");
  std::size_t second = 1;
  while (good.events[second].t != good.events[second - 1].t ||
         good.events[second].surfaces != good.events[second - 1].surfaces)
    ++second;
  result::Result once = good;
  change_events(once, [&](auto& events) { events.erase(events.begin() + static_cast<std::ptrdiff_t>(second)); });
  EXPECT_NE(complaint(system, once, 1e-8).find("is exceeded 2 times and fires 1 times"), std::string::npos);
  result::Result thrice = good;
  result::Event third = good.events[second];
  const auto& reset = system.thresholds[std::stoul(third.surfaces.front().substr(9))].reset;
  third.x = third.x_after;
  for (std::size_t i = 0; i < reset.size(); ++i) third.x_after[i] += reset[i];
  change_events(thrice,
                [&](auto& events) { events.insert(events.begin() + static_cast<std::ptrdiff_t>(second) + 1, third); });
  EXPECT_NE(complaint(system, thrice, 1e-8).find("fires below the threshold"), std::string::npos);
}

TEST(RegionSystemsJudge, FindsPlantedMistakes) {
  const RegionSystem system = draw_regions(1);
  const result::Result good = RegionModel(system).run(5, 1e-8, system.start);
  ASSERT_EQ(complaint(system, good, 1e-8), "");
  ASSERT_GT(good.trajectory.t.size(), 4U);
  const std::function<void(result::Result&)> mistakes[] = {
      [](result::Result& r) { r.status.termination = result::Termination::no_admissible_mode; },
      [](result::Result& r) { r.trajectory.x.change(1)[0] += 1e-6; },
      [](result::Result& r) {
        change_rows<std::vector<double>>(r.trajectory.theta, [](auto& rows) { rows[1].front() += 1e-6; });
      },
      [](result::Result& r) {
        const auto other = r.trajectory.regions[1].front().front() == "r0" ? "r1" : "r0";
        change_rows<result::Regions>(r.trajectory.regions, [&](auto& rows) { rows[1].front().front() = other; });
      },
  };
  for (std::size_t i = 0; i < std::size(mistakes); ++i) {
    result::Result bad = good;
    mistakes[i](bad);
    EXPECT_NE(complaint(system, bad, 1e-8), "") << "mistake " << i;
  }
}

}  // namespace
}  // namespace saltus::robustness
