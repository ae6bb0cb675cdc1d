// Many surfaces by finite elements: chains of blocks with dry friction, event by event as the event engine has them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "agreement/networks.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;
using result::Termination;

class BlockChain : public testing::TestWithParam<int> {};

/// Of up to 15 blocks systems are dense, beyond sparse (discretization::StagePattern). It ends before t = 9.884, where
/// block 29 of 50 is back at its surface without crossing it, to rounding: 2 pi / sqrt(2.5) behind the time at which it
/// has left it between neighbours that stick.
TEST_P(BlockChain, HasTheEventsOfTheEventEngine) {
  const Simulator simulator = Simulator::from_text(block_chain(GetParam(), 9.8));
  const Result exact = simulator.run(with(simulator.options(), fine));
  auto options = simulator.options();
  options.method = pipeline::Method::fesd;
  options.fesd.stages = 3;
  options.fesd.steps = 400;
  const Result found = simulator.run(options);
  ASSERT_EQ(exact.status.termination, Termination::completed) << exact.status.message;
  ASSERT_EQ(found.status.termination, Termination::completed) << found.status.message;
  ASSERT_EQ(found.events.size(), exact.events.size());
  EXPECT_GE(exact.events.size(), static_cast<std::size_t>(GetParam()));
  double latest = 0.0, farthest = 0.0;
  for (std::size_t i = 0; i < exact.events.size(); ++i) {
    const Event& is = found.events[i];
    const Event& should = exact.events[i];
    EXPECT_EQ(is.kind, should.kind) << "at " << should.t;
    EXPECT_EQ(is.surfaces, should.surfaces) << "at " << should.t;
    EXPECT_EQ(*is.mode_after, *should.mode_after) << "at " << should.t;
    EXPECT_EQ(is.unique, should.unique) << "at " << should.t;
    latest = std::max(latest, std::abs(is.t - should.t));
    for (std::size_t k = 0; k < is.x.size(); ++k) farthest = std::max(farthest, std::abs(is.x[k] - should.x[k]));
  }
  EXPECT_LT(latest, 1e-8);
  EXPECT_LT(farthest, 1e-8);
  EXPECT_EQ(found.final.mode, exact.final.mode);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BlockChain, testing::Values(5, 10, 20, 35, 50));

}  // namespace
}  // namespace saltus::problems
