#include <set>

#include <gtest/gtest.h>

#include "saltus/result/result.hpp"

namespace saltus::result {
namespace {

TEST(Names, TerminationsReadBackAndAreThoseOfTheContract) {
  const std::set<std::string> contract{
      "completed",           "stopped_by_user",   "iteration_limit",      "time_limit",    "step_size_too_small",
      "no_admissible_mode",  "evaluation_failed", "factorization_failed", "not_converged", "infeasible",
      "verification_failed", "outside_class",     "stopped_by_event"};
  std::set<std::string> found;
  for (const auto& word : contract) {
    const auto termination = termination_named(word);
    ASSERT_TRUE(termination.has_value()) << word;
    EXPECT_EQ(name(*termination), word);
    found.insert(std::string(name(*termination)));
  }
  EXPECT_EQ(found, contract);
  EXPECT_FALSE(termination_named("Completed").has_value());
  EXPECT_FALSE(termination_named("").has_value());
}

TEST(Names, EventKindsReadBackAndAreThoseOfTheContract) {
  for (const auto* word : {"start", "crossing", "enter_sliding", "leave_sliding", "change_sliding", "accumulation",
                           "jump", "user", "impact", "contact", "lift_off", "stick", "slip"}) {
    const auto kind = event_kind_named(word);
    ASSERT_TRUE(kind.has_value()) << word;
    EXPECT_EQ(name(*kind), word);
  }
  EXPECT_FALSE(event_kind_named("sliding").has_value());
}

TEST(Names, PhasesAndTypesOfStationarityReadBack) {
  for (const auto* word : {"relaxed", "branch", "lpcc"}) {
    const auto phase = homotopy_phase_named(word);
    ASSERT_TRUE(phase.has_value()) << word;
    EXPECT_EQ(name(*phase), word);
  }
  EXPECT_FALSE(homotopy_phase_named("S").has_value());
  for (const auto* word : {"S", "M", "C", "A", "W"}) {
    const auto type = stationarity_type_named(word);
    ASSERT_TRUE(type.has_value()) << word;
    EXPECT_EQ(name(*type), word);
  }
  EXPECT_FALSE(stationarity_type_named("B").has_value());
}

TEST(IsDone, HoldsForCompletionAndAStopTheModelAskedFor) {
  EXPECT_TRUE(is_done(Termination::completed));
  EXPECT_TRUE(is_done(Termination::stopped_by_event));
  EXPECT_FALSE(is_done(Termination::stopped_by_user));
  EXPECT_FALSE(is_done(Termination::outside_class));
  EXPECT_FALSE(is_done(Termination::iteration_limit));
}

struct Switch {
  Mode before, after;
  EventKind kind;
};

class KindOfSwitch : public testing::TestWithParam<Switch> {};

TEST_P(KindOfSwitch, FollowsFromTheComponentsThatBecomeOrLeaveZero) {
  EXPECT_EQ(kind_of_switch(GetParam().before, GetParam().after), GetParam().kind);
}

INSTANTIATE_TEST_SUITE_P(Cases, KindOfSwitch,
                         testing::Values(Switch{{-1}, {1}, EventKind::crossing},
                                         Switch{{-1}, {0}, EventKind::enter_sliding},
                                         Switch{{0}, {1}, EventKind::leave_sliding},
                                         Switch{{0, 1}, {-1, 0}, EventKind::change_sliding},
                                         // Only signs flip, whatever else slides.
                                         Switch{{0, 1}, {0, -1}, EventKind::crossing},
                                         // A flip beside an entry or an exit does not change what it is.
                                         Switch{{-1, 1}, {0, -1}, EventKind::enter_sliding},
                                         Switch{{0, 1}, {1, -1}, EventKind::leave_sliding},
                                         Switch{{0, 0}, {1, -1}, EventKind::leave_sliding},
                                         Switch{{1, 1}, {0, 0}, EventKind::enter_sliding}));

}  // namespace
}  // namespace saltus::result
