// The hidden dynamics of any number of surfaces, against a plain integration and against symmetries.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hidden_instances.hpp"
#include "saltus/switching/selections/selection_newton.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::switching {
namespace {

/// Classical Runge-Kutta with a fixed small step for the regularised system itself: surfaces at distance psi_j = eps
/// u_j, with the selections pi(psi_j / eps). Modes after that many steps; empty if it has not settled by then.
std::vector<int> modes_of_regularised_system(const HiddenInstance& one, int steps) {
  constexpr double eps = 1e-3;
  constexpr double h = 0.02 * eps;
  const auto m = static_cast<std::size_t>(one.g.rows());
  std::vector<double> kappa(m);
  for (std::size_t j = 0; j < m; ++j) {
    double largest = 0.0;
    for (std::size_t k = 0; k < one.g.corners(); ++k) {
      largest = std::max(largest, std::abs(one.g.value(static_cast<int>(j), k)));
    }
    kappa[j] = 1.0 / largest;
  }
  std::vector<double> psi(m);
  for (std::size_t j = 0; j < m; ++j) psi[j] = eps * one.situation.alpha[j];
  std::vector<double> alpha(m);
  const auto f = [&](const std::vector<double>& at, std::vector<double>& result) {
    for (std::size_t j = 0; j < m; ++j) alpha[j] = std::clamp(at[j] / eps, 0.0, 1.0);
    one.g.evaluate(alpha.data(), result.data());
    for (std::size_t j = 0; j < m; ++j) result[j] *= kappa[j];
  };
  std::array<std::vector<double>, 4> k;
  for (auto& stage : k) stage.resize(m);
  std::vector<double> at(m);
  std::vector<double> before(m);
  std::vector<double> low(m, 1e9);
  std::vector<double> high(m, -1e9);
  for (int step = 0; step < steps; ++step) {
    if (step == steps * 3 / 4) before = psi;
    f(psi, k[0]);
    for (const std::size_t stage : {1U, 2U, 3U}) {
      const double c = stage == 3 ? h : 0.5 * h;
      for (std::size_t j = 0; j < m; ++j) at[j] = psi[j] + c * k[stage - 1][j];
      f(at, k[stage]);
    }
    for (std::size_t j = 0; j < m; ++j) {
      psi[j] += h / 6.0 * (k[0][j] + 2.0 * k[1][j] + 2.0 * k[2][j] + k[3][j]);
      if (step < steps * 3 / 4) continue;
      low[j] = std::min(low[j], psi[j]);
      high[j] = std::max(high[j], psi[j]);
    }
  }
  std::vector<int> modes(m);
  for (std::size_t j = 0; j < m; ++j) {
    // Away during the whole last quarter and further at its end than at its begin; or seen in the layer and not
    // drifting.
    if (low[j] > eps && psi[j] > before[j]) {
      modes[j] = 1;
    } else if (high[j] < 0.0 && psi[j] < before[j]) {
      modes[j] = -1;
    } else if (!(low[j] < eps && high[j] > 0.0 && std::max(high[j] - eps, -low[j]) < 10.0 * eps)) {
      return {};
    }
  }
  return modes;
}

class AgainstRegularised : public testing::TestWithParam<int> {};

TEST_P(AgainstRegularised, EntriesEndInTheSameMode) {
  constexpr std::size_t count = 80;
  std::size_t compared = 0;
  for (const auto& one : random_entries(GetParam(), count, 7)) {
    const auto decision = one.decide();
    auto modes = modes_of_regularised_system(one, 15000);
    // A long transient looks like oscillation for a while.
    if (modes != decision.mode) modes = modes_of_regularised_system(one, 300000);
    if (modes.empty() || decision.limit > HiddenLimit::oscillating) continue;
    ++compared;
    EXPECT_EQ(decision.mode, modes) << decision.reason;
  }
  EXPECT_GE(compared, count * 95 / 100);
}
INSTANTIATE_TEST_SUITE_P(HiddenDynamics, AgainstRegularised, testing::Values(2, 3, 4),
                         [](const auto& value) { return "surfaces" + std::to_string(value.param); });

TEST(HiddenSurfaces, SlidingSelectionsAreStableRoots) {
  for (const auto& one : random_entries(3, 500, 11)) {
    const auto decision = one.decide();
    if (decision.limit != HiddenLimit::settled) continue;
    std::array<double, 3> g{};
    one.g.evaluate(decision.alpha.data(), g.data());
    for (std::size_t j = 0; j < 3; ++j) {
      if (decision.mode[j] == 0) {
        EXPECT_NEAR(g[j], 0.0, 1e-13);
        EXPECT_GT(decision.alpha[j], 0.0);
        EXPECT_LT(decision.alpha[j], 1.0);
      } else {
        EXPECT_GT(g[j] * decision.mode[j], 0.0);
        EXPECT_EQ(decision.alpha[j], decision.mode[j] > 0 ? 1.0 : 0.0);
      }
    }
  }
}

/// Where three surfaces meet all outcomes are common. An independent classification of 300 instances found 21, 28, 22,
/// 25 % with none, one, two, three surfaces sliding; 0.125 is five standard deviations of that sample.
TEST(HiddenSurfaces, SharesOfOutcomesForThreeSurfaces) {
  std::array<int, 4> codimension{};
  int oscillating = 0;
  int undecided = 0;
  constexpr int count = 1000;
  for (const auto& one : random_entries(3, count, 3)) {
    const auto decision = one.decide();
    if (decision.limit > HiddenLimit::oscillating) {
      ++undecided;
      continue;
    }
    oscillating += decision.limit == HiddenLimit::oscillating ? 1 : 0;
    ++codimension[static_cast<std::size_t>(std::count(decision.mode.begin(), decision.mode.end(), 0))];
  }
  const std::array<double, 4> reference{0.21, 0.28, 0.22, 0.25};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(codimension[k] / 1000.0, reference[k], 0.125) << k;
  EXPECT_GT(oscillating, 5);
  EXPECT_LT(oscillating, 80);
  EXPECT_LE(undecided, 20);
}

/// The instance with surfaces exchanged (new surface i is the old order[i]) and reflected where `reflect` says.
HiddenInstance relabelled(const HiddenInstance& one, const std::vector<int>& order, const std::vector<bool>& reflect) {
  const int m = one.g.rows();
  HiddenInstance image{MultiAffine(m, m), {}};
  for (int i = 0; i < m; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int old = order[at];
    const auto from = static_cast<std::size_t>(old);
    const double sign = reflect[at] ? -1.0 : 1.0;
    const Arrival arrival = one.situation.arrival[from];
    image.situation.arrival.push_back(!reflect[at] || arrival == Arrival::along ? arrival
                                      : arrival == Arrival::from_below          ? Arrival::from_above
                                                                                : Arrival::from_below);
    image.situation.alpha.push_back(reflect[at] ? 1.0 - one.situation.alpha[from] : one.situation.alpha[from]);
    for (std::size_t corner = 0; corner < image.g.corners(); ++corner) {
      std::size_t before = 0;
      for (int k = 0; k < m; ++k) {
        const bool bit = ((corner >> k & 1U) != 0) != reflect[static_cast<std::size_t>(k)];
        if (bit) before |= std::size_t{1} << order[static_cast<std::size_t>(k)];
      }
      image.g.set_value(i, corner, sign * one.g.value(old, before));
    }
  }
  return image;
}

TEST(HiddenSurfaces, DoNotDependOnNamesAndSignsOfSurfaces) {
  const std::vector<std::vector<int>> orders{{0, 1, 2}, {1, 0, 2}, {2, 1, 0}, {1, 2, 0}};
  const std::vector<std::vector<bool>> reflections{{false, true, false}, {true, false, true}, {false, false, true}};
  int compared = 0;
  for (const auto& one : random_entries(3, 60, 5)) {
    const auto decision = one.decide();
    if (decision.limit == HiddenLimit::undecided) continue;
    for (const auto& order : orders) {
      for (const auto& reflect : reflections) {
        const auto image = relabelled(one, order, reflect).decide();
        ASSERT_EQ(image.limit, decision.limit);
        if (decision.limit == HiddenLimit::spirals_out) continue;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto from = static_cast<std::size_t>(order[i]);
          EXPECT_EQ(image.mode[i], reflect[i] ? -decision.mode[from] : decision.mode[from]);
          EXPECT_NEAR(image.alpha[i], reflect[i] ? 1.0 - decision.alpha[from] : decision.alpha[from], 1e-9);
        }
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 600);
}

TEST(HiddenSurfaces, DoNotDependOnTheUnitsOfSurfaces) {
  for (auto& one : random_entries(3, 100, 6)) {
    const auto decision = one.decide();
    HiddenInstance scaled = one;
    for (const int j : {0, 2}) {
      const double unit = j == 0 ? 1e8 : 1e-8;
      for (std::size_t k = 0; k < one.g.corners(); ++k) scaled.g.set_value(j, k, unit * one.g.value(j, k));
    }
    const auto other = scaled.decide();
    EXPECT_EQ(other.limit, decision.limit);
    if (decision.limit > HiddenLimit::oscillating) continue;
    EXPECT_EQ(other.mode, decision.mode);
    // What is oscillated about is found to the accuracy to which cycles repeat.
    const double tolerance = decision.limit == HiddenLimit::oscillating ? 1e-3 : 1e-9;
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(other.alpha[j], decision.alpha[j], tolerance);
  }
}

TEST(HiddenSurfaces, GroupsThatDoNotFeelEachOtherAreDecidedApart) {
  // Surfaces 0, 2, 4 and 1, 3 belong together; each group alone must be decided the same.
  const auto three = random_entries(3, 50, 8);
  const auto two = random_entries(2, 50, 9);
  for (std::size_t i = 0; i < three.size(); ++i) {
    HiddenSituation situation;
    for (const std::size_t j : {0U, 1U, 2U, 3U, 4U}) {
      const HiddenInstance& part = j % 2 == 0 ? three[i] : two[i];
      situation.arrival.push_back(part.situation.arrival[j / 2]);
      situation.alpha.push_back(part.situation.alpha[j / 2]);
    }
    const auto g = [&](const double* alpha, double* velocity) {
      std::array<double, 3> own{alpha[0], alpha[2], alpha[4]};
      std::array<double, 3> result{};
      three[i].g.evaluate(own.data(), result.data());
      for (const std::size_t j : {0U, 1U, 2U}) velocity[2 * j] = result[j];
      own = {alpha[1], alpha[3], 0.0};
      two[i].g.evaluate(own.data(), result.data());
      velocity[1] = result[0];
      velocity[3] = result[1];
    };
    const auto whole = decide_by_hidden_dynamics(5, g, situation);
    const auto first = three[i].decide();
    const auto second = two[i].decide();
    EXPECT_EQ(whole.limit, std::max(first.limit, second.limit));
    if (whole.limit > HiddenLimit::oscillating) continue;
    for (std::size_t j = 0; j < 5; ++j) {
      const auto& part = j % 2 == 0 ? first : second;
      EXPECT_EQ(whole.mode[j], part.mode[j / 2]);
      EXPECT_NEAR(whole.alpha[j], part.alpha[j / 2], 1e-12);
    }
  }
}

TEST(HiddenSurfaces, TwentyAdditiveFrictionLawsCostTwentyDecisions) {
  constexpr int m = 20;
  HiddenSituation situation;
  for (int j = 0; j < m; ++j) {
    situation.arrival.push_back(j % 3 == 0 ? Arrival::along : j % 3 == 1 ? Arrival::from_below : Arrival::from_above);
    situation.alpha.push_back(0.4);
  }
  const auto force = [](int j) { return 1.5 * std::sin(1.0 + j); };
  long calls = 0;
  const auto g = [&](const double* alpha, double* velocity) {
    ++calls;
    for (int j = 0; j < m; ++j) velocity[j] = force(j) + 1.0 - 2.0 * alpha[j];
  };
  const auto decision = decide_by_hidden_dynamics(m, g, situation);
  ASSERT_EQ(decision.limit, HiddenLimit::settled);
  EXPECT_LT(calls, 10 * m);
  for (int j = 0; j < m; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const auto drift = [](double v) { return v > 0.0 ? Drift::up : Drift::down; };
    const double below = force(j) + 1.0;
    const double above = force(j) - 1.0;
    const auto single = decide_surface({{below, drift(below)}, {above, drift(above)}, situation.arrival[at]});
    EXPECT_EQ(decision.mode[at], single.mode) << j;
    EXPECT_NEAR(decision.alpha[at], single.alpha, 1e-14) << j;
  }
}

TEST(HiddenSurfaces, TwelveSurfacesCoupledByAMassMatrixRestTogether) {
  // g = b - A alpha with A diagonally dominant: the one root inside is stable; 2^12 corners are not needed.
  constexpr int m = 12;
  const auto root = [](int j) { return 0.5 + 0.3 * std::cos(2.0 * j); };
  const auto entry = [](int i, int j) { return i == j ? 2.0 : 0.1 * std::sin(1.0 + i + 3 * j); };
  long calls = 0;
  const auto g = [&](const double* alpha, double* velocity) {
    ++calls;
    for (int i = 0; i < m; ++i) {
      velocity[i] = 0.0;
      for (int j = 0; j < m; ++j) velocity[i] += entry(i, j) * (root(j) - alpha[j]);
    }
  };
  HiddenSituation situation;
  situation.arrival.assign(m, Arrival::along);
  situation.alpha.assign(m, 0.5);
  const auto decision = decide_by_hidden_dynamics(m, g, situation);
  ASSERT_EQ(decision.limit, HiddenLimit::settled);
  EXPECT_EQ(decision.mode, std::vector<int>(m, 0));
  for (int j = 0; j < m; ++j) EXPECT_NEAR(decision.alpha[static_cast<std::size_t>(j)], root(j), 1e-12);
  EXPECT_LT(calls, 4000);
}

TEST(HiddenSurfaces, SelectionsThatEnterOtherThanAffinely) {
  // g_1 = 0.3 - alpha_1^3 + 0.1 alpha_2, g_2 = 0.5 - alpha_2^2: rests at alpha_2 = sqrt(1/2).
  const auto g = [](const double* alpha, double* velocity) {
    velocity[0] = 0.3 - alpha[0] * alpha[0] * alpha[0] + 0.1 * alpha[1];
    velocity[1] = 0.5 - alpha[1] * alpha[1];
  };
  HiddenOptions options;
  options.interpolation = Interpolation::general;
  const auto decision =
      decide_by_hidden_dynamics(2, g, {{Arrival::along, Arrival::from_below}, {std::cbrt(0.3), 0.0}}, options);
  ASSERT_EQ(decision.limit, HiddenLimit::settled);
  EXPECT_NEAR(decision.alpha[1], std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(decision.alpha[0], std::cbrt(0.3 + 0.1 * std::sqrt(0.5)), 1e-9);
}

TEST(HiddenSurfaces, StartOnARepellingIntersectionIsNotUnique) {
  const auto g = [](const double* alpha, double* velocity) {
    velocity[0] = 2.0 * alpha[0] - 1.0 + 0.1 * alpha[1];
    velocity[1] = 2.0 * alpha[1] - 1.0 - 0.1 * alpha[0];
  };
  const auto decision = decide_by_hidden_dynamics(2, g, {{Arrival::at_start, Arrival::at_start}, {}});
  EXPECT_EQ(decision.mode, (std::vector<int>{1, 1}));
  EXPECT_TRUE(decision.structurally_unstable);
  EXPECT_EQ(decision.other_modes.size(), 3U);
}

TEST(HiddenSurfaces, TwoSurfacesReachedAtOnceAreUnfolded) {
  // Whichever is reached first is crossed and takes the solution back from the other.
  const auto g = [](const double* alpha, double* velocity) {
    velocity[0] = 1.0 - 4.0 * alpha[1] + 4.0 * alpha[0] * alpha[1];
    velocity[1] = 1.0 - 4.0 * alpha[0] + 4.0 * alpha[0] * alpha[1];
  };
  const auto decision = decide_by_hidden_dynamics(2, g, {{Arrival::from_below, Arrival::from_below}, {}});
  EXPECT_TRUE(decision.structurally_unstable);
  ASSERT_EQ(decision.other_modes.size(), 1U);
  const std::vector<int> first{1, -1};
  const std::vector<int> second{-1, 1};
  EXPECT_EQ(std::min(decision.mode, decision.other_modes[0]), second);
  EXPECT_EQ(std::max(decision.mode, decision.other_modes[0]), first);
}

/// Velocities -1, 0, 1: rest on boundaries, continua of roots, ties of everything.
TEST(HiddenSurfaces, DegenerateTablesEndWithAnAnswerOrADoubt) {
  std::mt19937 random(1);
  HiddenOptions options;
  options.budget = 2000;
  int decided = 0;
  for (int i = 0; i < 300; ++i) {
    const int m = 1 + i % 2;
    HiddenInstance one{MultiAffine(m, m), {}};
    for (int j = 0; j < m; ++j) {
      for (std::size_t k = 0; k < one.g.corners(); ++k) one.g.set_value(j, k, static_cast<int>(random() % 3) - 1);
      one.situation.arrival.push_back(i % 3 == 0   ? Arrival::along
                                      : i % 3 == 1 ? Arrival::at_start
                                                   : Arrival::from_below);
      one.situation.alpha.push_back(static_cast<double>(random() % 5) / 4.0);
    }
    const auto decision = one.decide(options);
    for (const double alpha : decision.alpha) EXPECT_TRUE(alpha >= 0.0 && alpha <= 1.0);
    decided += decision.limit == HiddenLimit::undecided ? 0 : 1;
  }
  EXPECT_GT(decided, 200);
}

/// Two roots of three surfaces coalesced a little before: what is left is a cycle around no root.
TEST(HiddenSurfaces, ACycleOfThreeSurfacesAboutNoRootIsToldApart) {
  constexpr double velocities[3][8] = {{0.04, -0.93, -0.06, 1.75, 1.97, -0.90, 0.015, -1.30},
                                       {1.17, 1.05, -1.84, -1.62, -1.17, 2.03, 0.54, 3.02},
                                       {-0.33, 3.08, 2.01, -0.51, -0.92, -1.50, -2.49, 0.57}};
  HiddenInstance one{MultiAffine(3, 3), {{Arrival::from_below, Arrival::along, Arrival::along}, {0.0, 0.33, 0.23}}};
  for (int j = 0; j < 3; ++j) {
    for (std::size_t k = 0; k < 8; ++k) one.g.set_value(j, k, velocities[j][k]);
  }
  EXPECT_EQ(one.decide().limit, HiddenLimit::rootless);
  // No root anywhere in the cube: Newton's method from a grid finds none.
  SelectionNewton newton(3);
  for (int start = 0; start < 1000; ++start) {
    std::vector<double> alpha{0.05 + 0.1 * (start % 10), 0.05 + 0.1 * (start / 10 % 10), 0.05 + 0.1 * (start / 100)};
    const bool found = newton.solve([&](const double* a, double* v) { one.g.evaluate(a, v); }, alpha.data());
    const auto inside = [](double a) { return a >= 0.0 && a <= 1.0; };
    EXPECT_FALSE(found && std::all_of(alpha.begin(), alpha.end(), inside)) << start;
  }
}

TEST(HiddenSurfaces, VelocitiesThatAreNotFiniteAreNotDecided) {
  for (auto& one : random_entries(2, 10, 1)) {
    one.g.set_value(0, 1, NAN);
    const auto decision = one.decide();
    EXPECT_EQ(decision.limit, HiddenLimit::undecided);
    EXPECT_EQ(decision.reason, "the velocities are not finite");
  }
}

}  // namespace
}  // namespace saltus::switching
