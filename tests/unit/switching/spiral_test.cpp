#include "saltus/switching/plane/spiral.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "random_fields.hpp"
#include "saltus/switching/plane/intersection.hpp"
#include "switching_cases.hpp"

namespace saltus::switching {
namespace {

using Real = long double;

/// The solution of constant fields from (psi_1, psi_2) = (-delta, 0), surface by surface.
struct Cycle {
  Real time = 0, psi_1 = 0;
  std::array<Real, 4> in_region{};
};

Cycle cycle_by_hand(const Velocities& f, Real delta) {
  Cycle cycle;
  Real psi_1 = -delta;
  Real psi_2 = 0;
  constexpr std::array<std::size_t, 4> regions{0, 1, 3, 2};
  for (std::size_t i = 0; i < 4; ++i) {
    const Real v_1 = f[0][regions[i]];
    const Real v_2 = f[1][regions[i]];
    const Real time = i % 2 == 0 ? -psi_1 / v_1 : -psi_2 / v_2;
    psi_1 = i % 2 == 0 ? 0 : psi_1 + time * v_1;
    psi_2 = i % 2 == 0 ? psi_2 + time * v_2 : 0;
    cycle.in_region[i] = time;
    cycle.time += time;
  }
  cycle.psi_1 = psi_1;
  return cycle;
}

TEST(Spiral, LimitIsThatOfCycleByCycleSimulation) {
  RandomFields random(21);
  int inward = 0;
  while (inward < 500) {
    const Velocities f = random.spiral();
    const auto cycle = spiral_cycle(plane_table(f), 0);
    ASSERT_TRUE(cycle);
    EXPECT_EQ(turning(plane_table(f)), Turning::counterclockwise);
    if (cycle->cycle_ratio > 0.95) continue;
    ++inward;
    std::array<Real, 4> total{};
    Real delta = 0.01L;
    while (delta > 1e-25L) {
      const Cycle next = cycle_by_hand(f, delta);
      EXPECT_NEAR(static_cast<double>(-next.psi_1 / delta), cycle->cycle_ratio, 1e-14 * cycle->cycle_ratio);
      for (std::size_t i = 0; i < 4; ++i) total[i] += next.in_region[i];
      delta = -next.psi_1;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const double time = 0.01 * cycle->durations[i] / (1.0 - cycle->cycle_ratio);  // (6.4)
      EXPECT_NEAR(time / static_cast<double>(total[i]), 1.0, 1e-13);
    }
  }
}

TEST(Spiral, DurationOfACycleNotThePrintedOne) {
  RandomFields random(22);
  int printed_wrong = 0;
  for (int n = 0; n < 1000; ++n) {
    const Velocities f = random.spiral();
    const auto cycle = spiral_cycle(plane_table(f), 0);
    const double simulated = static_cast<double>(cycle_by_hand(f, 1.0L).time);
    EXPECT_NEAR(cycle->duration() / simulated, 1.0, 1e-14);
    // (6.3) with the last factor corrected, and as printed.
    const auto kappa = [&f](double last) {
      return (1.0 - f[1][0] / f[1][1] * (1.0 - f[0][1] / f[0][3] * (1.0 - f[1][3] / last))) / f[0][0];
    };
    EXPECT_NEAR(kappa(f[1][2]) / simulated, 1.0, 1e-13);
    printed_wrong += std::abs(kappa(f[1][1]) / simulated - 1.0) > 0.01 ? 1 : 0;
  }
  EXPECT_GT(printed_wrong, 950);
}

TEST(Spiral, FactsThatTheDecisionsUse) {
  RandomFields random(23);
  int inward = 0;
  int unstable = 0;
  for (int n = 0; n < 5000; ++n) {
    const Velocities f = random.spiral();
    const PlaneTable table = plane_table(f);
    const auto roots = intersection_roots(table);
    ASSERT_TRUE(roots.rising && roots.rising->inside());
    EXPECT_FALSE(roots.falling && roots.falling->inside());
    const auto& g = roots.rising->sliding_jacobian;
    const double rho_1 = f[0][2] * f[0][1] / (f[0][3] * f[0][0]);
    const double rho_2 = f[1][3] * f[1][0] / (f[1][2] * f[1][1]);
    const double gamma = spiral_cycle(table, 0)->cycle_ratio;
    EXPECT_NEAR(rho_1 * rho_2 / gamma, 1.0, 1e-13);
    if (std::abs(rho_1 - 1.0) > 1e-12) {
      EXPECT_EQ(rho_1 > 1.0, g[0][0] > 0.0);
    }
    if (std::abs(rho_2 - 1.0) > 1e-12) {
      EXPECT_EQ(rho_2 > 1.0, g[1][1] > 0.0);
    }
    if (gamma < 1.0 - 1e-9) {
      ++inward;
      EXPECT_TRUE(roots.rising->stabilisable());
      const auto decision = decide_spiral_in(table);
      EXPECT_EQ(decision.chosen.mode, (PlaneMode{0, 0}));
      EXPECT_EQ(decision.undecided, "");
      EXPECT_TRUE(decision.unique());
    } else {
      EXPECT_FALSE(decide_spiral_in(table).undecided.empty());
      const auto start = decide_intersection_start(table);
      EXPECT_EQ(start.spirals_out, !roots.rising->stabilisable());
      unstable += start.spirals_out ? 1 : 0;
    }
  }
  EXPECT_GT(inward, 2000);
  EXPECT_GT(unstable, 500);
}

TEST(Spiral, VerifiedCases) {
  int cases = 0;
  for (const SwitchingCase& c : plane_cases()) {
    if (c.situation != "spiral_in" && c.situation != "spiral_out") continue;
    ++cases;
    const double delta = c.all["delta"];
    for (unsigned i = 0; i < 8; ++i) {
      SCOPED_TRACE(c.id + " symmetry " + std::to_string(i));
      const Relabelling relabelling(i);
      // Canonically it starts beside (-delta, 0) in (--); reversed orientation by one reflection of the first surface.
      const bool clockwise = c.all["orientation"] == "clockwise";
      const auto first = relabelling.signs(std::array<int, 2>{clockwise ? 1 : -1, -1});
      const PlaneTable table = plane_table(relabelling.fields(c.f));
      const auto cycle = spiral_cycle(table, (first[0] > 0 ? 1U : 0U) + (first[1] > 0 ? 2U : 0U));
      ASSERT_TRUE(cycle);
      const bool reversed = (i == 1 || i == 2 || i == 4 || i == 7);
      EXPECT_EQ(turning(table) == Turning::clockwise, clockwise != reversed);
      EXPECT_NEAR(cycle->cycle_ratio, c.all["gamma"], 1e-13 * cycle->cycle_ratio);
      EXPECT_NEAR(cycle->duration(), c.all["kappa"], 1e-13 * cycle->duration());
      for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(delta * cycle->durations[j], c.all["t_j"][j], 1e-15);
      if (c.situation == "spiral_out") {
        EXPECT_GT(cycle->cycle_ratio, 1.0);
        EXPECT_NEAR(delta * cycle->duration(), c.all["elapsed"], 1e-14);
        continue;
      }
      EXPECT_NEAR(delta * cycle->duration() / (1.0 - cycle->cycle_ratio), c.all["arrival_time"], 1e-13);
      const auto decision = decide_spiral_in(table);
      EXPECT_EQ(decision.chosen.mode, (PlaneMode{0, 0}));
      const auto lambda = relabelling.signs(c.expected[0].lambda);
      for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(2.0 * decision.chosen.alpha[j] - 1.0, lambda[j], 1e-9);
    }
  }
  EXPECT_EQ(cases, 20);
}

TEST(Spiral, LeavesByTheFamilyOfSolutions) {
  // psi along the cycle that (6.5) adds up: on psi_2 = 0 at distance delta (gamma - 1).
  RandomFields random(24);
  for (int n = 0; n < 1000; ++n) {
    const Velocities f = random.spiral();
    const auto cycle = spiral_cycle(plane_table(f), 0);
    std::array<double, 2> psi{};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 2; ++j) psi[j] += cycle->durations[i] * f[j][cycle->corners[i]];
    }
    EXPECT_NEAR(psi[0], 1.0 - cycle->cycle_ratio, 1e-13 * (1.0 + cycle->cycle_ratio));
    EXPECT_NEAR(psi[1], 0.0, 1e-13 * (1.0 + cycle->cycle_ratio));
  }
}

TEST(Spiral, NoneWhereOneFieldDoesNotTurn) {
  Velocities f = RandomFields(25).spiral();
  f[1][3] = -f[1][3];
  EXPECT_FALSE(turning(plane_table(f)));
  EXPECT_FALSE(spiral_cycle(plane_table(f), 0));
  EXPECT_FALSE(decide_spiral_in(plane_table(f)).undecided.empty());
}

}  // namespace
}  // namespace saltus::switching
