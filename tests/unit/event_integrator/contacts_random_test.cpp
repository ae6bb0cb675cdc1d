// Random bodies with random contacts: nothing passes through, no energy comes from nowhere, every run ends. Modes that
// hold are those of all combinations, tried one after the other.
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "run_model.hpp"
#include "saltus/event_integrator/contact/contact_forces.hpp"
#include "saltus/event_integrator/contact/impact.hpp"
#include "saltus/event_integrator/contact/impact_process_internal.hpp"
#include "saltus/event_integrator/contact/shared_friction.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;

/// Positions at 0 in a potential well, random velocities, mass matrix, and contacts with curved gaps around.
class RandomBodies {
 public:
  explicit RandomBodies(unsigned seed) : generator_(seed), n_(2 + seed % 3), contacts_(1 + seed % 3) {
    for (std::size_t i = 0; i < n_; ++i) {
      positions_.push_back("q" + std::to_string(i));
      q_.push_back(model_.state(positions_.back(), {0.0}));
    }
    for (std::size_t i = 0; i < n_; ++i) {
      velocities_.push_back("v" + std::to_string(i));
      static_cast<void>(model_.state(velocities_.back(), {between(-1.0, 1.0)}));
    }
    SX potential = 0.0;
    for (const SX& q : q_) potential += 0.5 * q * q;
    const auto n = static_cast<casadi_int>(n_);
    SX factor(n, n);
    for (casadi_int i = 0; i < n; ++i) {
      for (casadi_int j = 0; j < n; ++j) factor(i, j) = between(-1.0, 1.0);
    }
    model_.mechanics({.positions = positions_,
                      .velocities = velocities_,
                      .mass = SX::mtimes(factor, factor.T()) + 0.3 * SX::eye(n),
                      .potential = potential});
    for (std::size_t k = 0; k < contacts_; ++k) add_contact("c" + std::to_string(k), seed % 2 == 1);
  }

  [[nodiscard]] Integration run() { return run_model(model_, 5.0, {1e-9, 1e-11}); }
  [[nodiscard]] std::size_t contacts() const { return contacts_; }

 private:
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }

  void add_contact(const std::string& name, bool with_friction) {
    SX gap = between(0.05, 0.5) + 0.1 * q_[0] * q_[0];
    model::ContactOptions options;
    for (std::size_t j = 0; j < n_; ++j) {
      gap += between(-1.0, 1.0) * q_[j];
      if (with_friction) options.tangent[positions_[j]] = between(-1.0, 1.0);
    }
    if (with_friction) options.friction = between(0.0, 1.0);
    options.restitution = between(0.0, 1.0);
    model_.contact(name, gap, options);
  }

  std::mt19937 generator_;
  std::size_t n_, contacts_;
  model::Builder model_{"bodies"};
  std::vector<std::string> positions_, velocities_;
  std::vector<SX> q_;
};

TEST(RandomContacts, NothingPassesThroughAndNoEnergyIsMade) {
  for (unsigned seed = 1; seed <= 18; ++seed) {
    RandomBodies bodies(seed);
    const auto run = bodies.run();
    ASSERT_EQ(run.status.termination, result::Termination::completed) << seed << ": " << run.status.message;
    const std::size_t stride = seed % 2 == 1 ? 4 : 3;  // outputs of a contact, with its friction and without
    double energy = std::numeric_limits<double>::infinity();
    for (const auto& outputs : run.trajectory.outputs) {
      for (std::size_t k = 0; k < bodies.contacts(); ++k) EXPECT_GE(outputs[k * stride], -1e-12) << seed;
      EXPECT_LE(outputs.back(), energy + 1e-8) << seed;  // the tolerance of the steps between
      energy = outputs.back();
    }
  }
}

using Mode = event_integrator::ContactMode;

/// Frictionless contacts at rest of a body with as many positions as `rank`.
ContactPoint random_point(int contacts, int rank, std::mt19937& dice) {
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  linalg::Matrix rows(contacts, rank);
  for (double& entry : rows) entry = part(dice);
  linalg::Vector forces(rank);
  ContactPoint point;
  point.influence = rows * rows.transpose();
  point.velocity.set_zero(contacts);
  for (double& force : forces) force = part(dice);
  point.acceleration = rows * forces;
  point.free_terms = point.terms = point.acceleration.max_abs();
  const auto m = static_cast<std::size_t>(contacts);
  point.friction.assign(m, 0.0);
  point.restitution.assign(m, 0.0);
  point.tangents.assign(m, 0);
  point.has_gap.assign(m, true);
  return point;
}

std::set<std::vector<Mode>> modes_by_all_combinations(const ContactPoint& point, const std::vector<int>& resting) {
  std::set<std::vector<Mode>> found;
  for (unsigned closed = 0; closed < 1U << resting.size(); ++closed) {
    std::vector<Mode> modes(resting.size(), Mode::open);
    for (std::size_t k = 0; k < modes.size(); ++k) {
      if ((closed >> k & 1U) != 0) modes[k] = Mode::closed;
    }
    ContactForces forces;
    if (forces_in(point, resting, modes, forces) && forces.margin >= -1e-8) found.insert(modes);
  }
  return found;
}

void expect_the_same_modes(const ContactPoint& point) {
  std::vector<int> resting;
  for (int i = 0; i < point.contacts(); ++i) resting.push_back(i);
  std::set<std::vector<Mode>> found;
  const std::vector<std::vector<Mode>> none(resting.size());
  for (const auto& forces : switching::solve_point(problem_of(point, resting), {none, {}}).all) {
    found.insert(forces.faces);
  }
  EXPECT_FALSE(found.empty());
  EXPECT_EQ(found, modes_by_all_combinations(point, resting));
}

TEST(ContactForces, WithoutFrictionTheModesThatHoldAreThoseOfAllCombinations) {
  std::mt19937 dice(5);
  for (int run = 0; run < 60; ++run) {
    const int contacts = 3 + run % 3;
    expect_the_same_modes(random_point(contacts, contacts, dice));
    expect_the_same_modes(random_point(contacts, contacts - 1, dice));  // forces are open
  }
}

TEST(ContactForces, WhatTouchesWithoutAForceMayBeOpenAndClosed) {
  std::mt19937 dice(7);
  for (int run = 0; run < 40; ++run) {
    auto point = random_point(4, 4, dice);
    // The first one presses, the second one neither presses nor leaves.
    point.acceleration = linalg::Vector{0.0, 0.0, 0.0, 1.0} - point.influence * linalg::Vector{1.0, 0.0, 0.5, 0.0};
    expect_the_same_modes(point);
  }
}

/// m contacts with friction of a chain of bodies, all of them at rest or closing.
ContactPoint falling_pile(int contacts, std::mt19937& dice) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const int n = contacts + 2;
  linalg::Matrix rows = linalg::Matrix::zero(2 * contacts, n);
  for (int i = 0; i < 2 * contacts; ++i) {
    for (int k = i % contacts; k < std::min(n, i % contacts + 3); ++k) rows(i, k) = number(dice);
  }
  ContactPoint point;
  point.influence = rows * rows.transpose();
  linalg::Vector velocity(n);
  for (double& one : velocity) one = number(dice);
  point.velocity = rows * velocity;
  point.acceleration = linalg::Vector::zero(2 * contacts);
  const auto m = static_cast<std::size_t>(contacts);
  for (int i = 0; i < contacts; ++i) {
    point.velocity(i) = -std::abs(point.velocity(i));
    if (i % 2 == 0) point.velocity(i) = point.velocity(contacts + i) = 0.0;
    point.friction.push_back(0.3 * std::abs(number(dice)));
  }
  point.restitution.assign(m, 0.0);
  point.tangents.assign(m, 1);
  point.has_gap.assign(m, true);
  return point;
}

/// By all combinations where contacts are few, by pivots where they are many.
TEST(Impacts, NothingClosesBehindThemAndNoEnergyIsGained) {
  std::mt19937 dice(3);
  int ended = 0;
  for (int run = 0; run < 60; ++run) {
    const ContactPoint point = falling_pile(1 + run % 12, dice);
    std::vector<int> touching;
    for (int i = 0; i < point.contacts(); ++i) touching.push_back(i);
    const auto impulse = impact(point, touching);
    if (!impulse) continue;
    ++ended;
    const linalg::Vector behind = point.velocity + point.influence * *impulse;
    const double gained = 0.5 * impulse->dot(point.velocity + behind);
    EXPECT_LE(gained, 1e-9) << run;
    for (int i = 0; i < point.contacts(); ++i) {
      EXPECT_GE(behind(i), -1e-8) << run;
      EXPECT_GE((*impulse)(i), -1e-9) << run;
    }
  }
  EXPECT_GE(ended, 55);
}

/// So fast that no impact stops them, by combinations or by pivots.
TEST(Impacts, WhatRestsAndSlipsRubsAgainstItsSlip) {
  std::mt19937 dice(4);
  int ended = 0;
  for (int run = 0; run < 40; ++run) {
    ContactPoint point = falling_pile(2 + run % 18, dice);
    const int m = point.contacts();
    std::vector<int> touching;
    for (int i = 0; i < m; ++i) {
      touching.push_back(i);
      if (i % 4 == 2) point.velocity(m + i) = i % 8 == 2 ? 100.0 : -100.0;
    }
    const auto impulse = impact(point, touching);
    if (!impulse) continue;
    ++ended;
    for (int i = 2; i < m; i += 4) {
      const double limit = point.friction[static_cast<std::size_t>(i)] * (*impulse)(i);
      EXPECT_NEAR((*impulse)(m + i), i % 8 == 2 ? -limit : limit, 1e-9) << run;
    }
  }
  EXPECT_GE(ended, 35);
}

/// A pile of which no contact does anything to those of another one.
TEST(Impacts, PartsThatDoNothingToEachOtherHaveTheirOwn) {
  std::mt19937 dice(5);
  for (int run = 0; run < 10; ++run) {
    const std::array piles{falling_pile(2, dice), falling_pile(3, dice)};
    ContactPoint both;
    both.influence = linalg::Matrix::zero(10, 10);
    both.velocity = linalg::Vector::zero(10);
    std::vector<std::vector<int>> rows{{0, 1, 5, 6}, {2, 3, 4, 7, 8, 9}};
    for (std::size_t pile = 0; pile < piles.size(); ++pile) {
      const auto& own = piles[pile];
      for (std::size_t i = 0; i < rows[pile].size(); ++i) {
        both.velocity(rows[pile][i]) = own.velocity(index(i));
        for (std::size_t k = 0; k < rows[pile].size(); ++k) {
          both.influence(rows[pile][i], rows[pile][k]) = own.influence(index(i), index(k));
        }
      }
      both.friction.insert(both.friction.end(), own.friction.begin(), own.friction.end());
    }
    both.restitution.assign(5, 0.0);
    both.tangents.assign(5, 1);
    both.has_gap.assign(5, true);
    EXPECT_EQ(parts_of(both, {0, 1, 2, 3, 4}).size(), 2U);
    const auto together = impact(both, {0, 1, 2, 3, 4});
    for (std::size_t pile = 0; pile < piles.size(); ++pile) {
      const auto alone = impact_of_all(piles[pile], std::nullopt);
      ASSERT_EQ(together.has_value(), alone.has_value());
      for (std::size_t i = 0; alone && i < rows[pile].size(); ++i) {
        EXPECT_EQ((*together)(rows[pile][i]), (*alone)(index(i)));
      }
    }
  }
}

/// Two feet at one height: of their friction one part is open, and follows the share of one of them.
TEST(SharedFriction, AsManyRowsFollowAsForcesAreOpen) {
  const linalg::Matrix rows{{0.0, 1.0, -1.0}, {0.0, 1.0, 1.0}, {1.0, 0.0, 0.5}, {1.0, 0.0, 0.5}};
  ContactPoint point;
  point.influence = rows * rows.transpose();
  point.acceleration = rows * linalg::Vector{1.0, -10.0, 0.0};
  point.velocity = linalg::Vector::zero(4);
  point.terms = point.free_terms = 10.0;
  point.friction.assign(2, 0.5);
  point.restitution.assign(2, 0.0);
  point.tangents.assign(2, 1);
  point.has_gap.assign(2, true);
  ContactForces forces;
  ASSERT_TRUE(forces_in(point, {0, 1}, {Mode::stick, Mode::stick}, forces));
  EXPECT_TRUE(forces.is_open);
  EXPECT_EQ(rows_that_follow(point, {0, 1}, forces).size(), 1U);
}

}  // namespace
}  // namespace saltus::event_integrator::testing
