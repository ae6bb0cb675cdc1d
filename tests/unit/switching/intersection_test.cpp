#include "saltus/switching/plane/intersection.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "saltus/switching/plane/spiral.hpp"
#include "switching_cases.hpp"

namespace saltus::switching {
namespace {

/// The decision that belongs to the situation of a case.
PlaneDecision decide(const SwitchingCase& c, const Velocities& f, const Relabelling& relabelling) {
  const PlaneTable table = plane_table(f);
  if (c.situation == "enter_codim2_from_codim1") return decide_entering(table, relabelling.signs(c.incoming));
  if (c.situation == "exit_codim2_b") return decide_exit_fold(table);
  if (c.situation == "exit_codim2_c2") return decide_exit_unstable(table);
  const auto lambda = relabelling.signs(c.lambda_event);
  const std::size_t surface = std::abs(lambda[0]) > std::abs(lambda[1]) ? 0 : 1;
  return decide_exit_edge(table, {surface, lambda[surface] > 0.0 ? 1 : -1});
}

bool is_decision(const SwitchingCase& c) {
  return c.situation.starts_with("enter") || c.situation == "exit_codim2_a" || c.situation == "exit_codim2_b" ||
         c.situation == "exit_codim2_c2";
}

void expect_outcome(const PlaneContinuation& found, const CaseOutcome& expected, const Relabelling& relabelling) {
  EXPECT_EQ(found.mode, relabelling.signs(expected.mode));
  const auto lambda = relabelling.signs(expected.lambda);
  for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(2.0 * found.alpha[j] - 1.0, lambda[j], 1e-9);
}

TEST(Intersection, VerifiedCasesInAllSymmetriesAndScalings) {
  int decisions = 0;
  for (const SwitchingCase& c : plane_cases()) {
    if (!is_decision(c)) continue;
    for (unsigned i = 0; i < 8; ++i) {
      const Relabelling relabelling(i);
      for (const std::array<double, 2> scaling : {std::array{1.0, 1.0}, {1e8, 1e-8}, {1e-8, 1e8}, {3e5, 7e5}}) {
        SCOPED_TRACE(c.id + " symmetry " + std::to_string(i) + " scaling " + std::to_string(scaling[0]));
        Velocities f = relabelling.fields(c.f);
        for (std::size_t j = 0; j < 2; ++j) {
          for (double& velocity : f[j]) velocity *= scaling[j];
        }
        const PlaneDecision decision = decide(c, f, relabelling);
        EXPECT_EQ(decision.undecided, "");
        EXPECT_EQ(decision.spirals_out, c.spiral_out);
        if (!c.spiral_out) {
          const bool second = c.expected.size() > 1 && c.leaf == "C9-4" &&
                              decision.chosen.mode == relabelling.signs(c.expected[1].mode);
          expect_outcome(decision.chosen, c.expected[second ? 1 : 0], relabelling);
        }
        ++decisions;
      }
    }
  }
  EXPECT_EQ(decisions, 4 * 8 * 300);
}

/// Leaves that a symmetry turns into each other: the first symmetry that fits names them.
std::string family(std::string leaf) {
  if (leaf.starts_with("B-")) leaf = leaf.substr(2);
  const std::map<std::string, std::string> same{
      {"A3", "A2"}, {"DD2", "UU1"}, {"DD1", "UU2"}, {"UD3", "UD1"}, {"C9-3", "C9-2"}};
  return same.contains(leaf) ? same.at(leaf) : leaf;
}

TEST(Intersection, VerifiedCasesHaveTheLeafOfTheirName) {
  for (const SwitchingCase& c : plane_cases()) {
    if (!is_decision(c)) continue;
    EXPECT_EQ(family(std::string(name(decide(c, c.f, Relabelling(0)).leaf))), family(c.leaf)) << c.id;
  }
}

/// The usual passage is decided before the tree is asked: all symmetric tables of one situation have one answer, with
/// its mode the only admissible one, whether or not the table is clear enough for that.
TEST(Intersection, PassagesHaveTheOnlyAdmissibleModeOnBothWays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> size(0.1, 1.0);
  int passages = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    // Of one field hardly anything leads across: in every other trial less than the fast path wants (1e-4).
    const double slow = trial % 2 == 0 ? 1.0 : 1e-5;
    const Velocities f{{{size(random), -size(random), size(random), -size(random)},
                        {slow * size(random), size(random), size(random), size(random)}}};
    for (unsigned i = 0; i < 8; ++i) {
      const Relabelling relabelling(i);
      const PlaneTable table = plane_table(relabelling.fields(f));
      const PlaneDecision decision = decide_entering(table, relabelling.signs(PlaneMode{0, -1}));
      const PlaneModes admissible = admissible_modes(table);
      ASSERT_EQ(decision.undecided, "");
      EXPECT_EQ(decision.leaf, Leaf::E3);
      EXPECT_EQ(decision.reason, "no sliding on the intersection: sliding goes on across the surface reached");
      EXPECT_TRUE(decision.unique() && !decision.ambiguous && !decision.by_scaling);
      ASSERT_EQ(admissible.size(), 1U);
      const PlaneContinuation& only = *admissible.begin();
      EXPECT_EQ(decision.chosen.mode, only.mode);
      EXPECT_EQ(decision.chosen.mode, relabelling.signs(PlaneMode{0, 1}));
      EXPECT_EQ(decision.chosen.alpha, only.alpha);
      EXPECT_EQ(decision.chosen.attracts, only.attracts);
      ++passages;
    }
  }
  EXPECT_EQ(passages, 16000);
}

}  // namespace
}  // namespace saltus::switching
