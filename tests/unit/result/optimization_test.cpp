#include "saltus/result/optimization.hpp"

#include <gtest/gtest.h>

namespace saltus::result {
namespace {

TEST(OptimizationNames, AreFoundAgain) {
  for (const auto phase : {HomotopyPhase::relaxed, HomotopyPhase::branch, HomotopyPhase::lpcc}) {
    EXPECT_EQ(homotopy_phase_named(name(phase)), phase);
  }
  using enum StationarityType;
  for (const auto type : {S, M, C, A, W}) EXPECT_EQ(stationarity_type_named(name(type)), type);
  EXPECT_EQ(homotopy_phase_named("S"), std::nullopt);
  EXPECT_EQ(stationarity_type_named("relaxed"), std::nullopt);
}

}  // namespace
}  // namespace saltus::result
