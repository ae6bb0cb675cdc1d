#include "hybrid_systems.hpp"

#include <cmath>

#include "dice.hpp"

namespace saltus::robustness {
namespace {

Course random_course(Dice& dice, double size) {
  Course course;
  course.constant = dice.coefficient(size);
  if (dice.chance(0.4)) {
    course.amplitude = dice.coefficient(size);
    course.frequency = dice.uniform(0.5, 4.0);
  } else if (dice.chance(0.3)) {
    double t = dice.uniform(-1.0, 1.0);
    for (std::size_t k = 3 + dice.below(6); k > 0; --k) {
      course.times.push_back(t);
      course.values.push_back(dice.coefficient(size));
      t += dice.uniform(0.3, 3.0);
    }
  }
  return course;
}

/// Masses with springs to rest, to each other, dampers and drives; friction on some, walls at one or two sides.
void draw_masses(Dice& dice, Hybrid& system) {
  const std::size_t m = 1 + dice.below(3), n = 2 * m;
  system.A.assign(n, std::vector<double>(n));
  system.b.assign(n, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    auto& row = system.A[m + i];
    system.A[i][m + i] = 1.0;
    row[i] = dice.chance(0.5) ? -dice.uniform(0.0, 4.0) : 0.0;
    row[m + i] = -dice.uniform(0.0, 0.3);
    const double spring = i + 1 < m ? dice.uniform(0.0, 2.0) : 0.0;
    if (i + 1 < m) {
      row[i] -= spring;
      row[i + 1] += spring;
      system.A[m + i + 1][i] += spring;
      system.A[m + i + 1][i + 1] -= spring;
    }
    system.b[m + i] = dice.coefficient(2.0);
    if (dice.chance(0.5)) system.drives.emplace_back(m + i, random_course(dice, 2.0));
    if (dice.chance(0.4)) {
      Course belt = dice.chance(0.5) ? Course{} : random_course(dice, 0.5);
      system.laws.push_back({m + i, dice.uniform(0.1, 1.0), std::move(belt)});
    }
    system.start.push_back(dice.coefficient(0.4));
  }
  for (std::size_t i = 0; i < m; ++i) {
    system.start.push_back(dice.coefficient(1.0));
    const bool both = dice.chance(0.5);
    const double side = dice.chance(0.5) ? 1.0 : -1.0;
    for (const double s : {side, -side}) {
      if (s != side && !both) continue;
      system.walls.push_back({i, m + i, -s * dice.uniform(0.5, 1.2), s, dice.uniform(0.2, 0.95)});
    }
  }
}

/// Integrators that fire at thresholds and push others, less in all than what they lose: chains end.
void draw_thresholds(Dice& dice, Hybrid& system) {
  const std::size_t n = 2 + dice.below(4);
  system.A.assign(n, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (auto& a : system.A[i]) a = dice.coefficient(0.3);
    system.A[i][i] = -dice.uniform(0.0, 0.5);
    system.b.push_back(dice.uniform(0.2, 1.5));
    system.start.push_back(dice.uniform(-0.5, 0.9));
    if (dice.chance(0.3)) system.drives.emplace_back(i, random_course(dice, 0.5));
    Threshold threshold{i, 1.0, std::vector<double>(n)};
    for (auto& push : threshold.reset) push = dice.coefficient(0.8 / static_cast<double>(n));
    threshold.reset[i] = -1.0;
    system.thresholds.push_back(std::move(threshold));
  }
}

/// Stable affine motion with relays across it and laws on moving surfaces.
void draw_relays(Dice& dice, Hybrid& system) {
  const std::size_t n = 2 + dice.below(11);
  system.A.assign(n, std::vector<double>(n));
  const double coupling = dice.uniform(0.2, 1.2) / std::sqrt(static_cast<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (auto& a : system.A[i]) a = dice.coefficient(coupling);
    system.A[i][i] -= dice.uniform(0.5, 2.0);
    system.b.push_back(dice.coefficient(1.0));
    system.start.push_back(dice.coefficient(1.5));
    if (dice.chance(0.3)) system.drives.emplace_back(i, random_course(dice, 1.5));
  }
  for (std::size_t k = 1 + dice.below(3); k > 0; --k) {
    Relay relay;
    relay.slope.assign(n, 0.0);
    relay.row = dice.below(n);
    relay.slope[dice.chance(0.5) ? relay.row : dice.below(n)] = 1.0;
    if (dice.chance(0.4)) relay.slope[dice.below(n)] += dice.coefficient(1.0);
    const double middle = dice.coefficient(0.5), half = dice.uniform(0.02, 0.5);
    relay.low = middle - half;
    relay.high = middle + half;
    relay.gain = dice.uniform(0.5, 4.0);
    relay.start = dice.chance(0.5) ? 1.0 : -1.0;
    system.relays.push_back(std::move(relay));
  }
  // Additive laws: each in a row of its own, or two in one.
  const std::size_t laws = dice.below(9);
  for (std::size_t k = 0; k < laws; ++k) {
    system.laws.push_back({dice.below(n), dice.uniform(0.2, 3.0), random_course(dice, 1.0)});
  }
}

}  // namespace

std::string name(HybridFamily family) { return family == HybridFamily::jumps ? "jumps" : "relays"; }

Hybrid draw(HybridFamily family, std::uint64_t seed) {
  Dice dice(seed * 2 + static_cast<std::uint64_t>(family) + (std::uint64_t{1} << 41));
  dice.round_numbers = dice.chance(0.2);
  Hybrid system;
  system.family = family;
  system.seed = seed;
  if (family == HybridFamily::relays) {
    draw_relays(dice, system);
  } else if (dice.chance(0.7)) {
    draw_masses(dice, system);
  } else {
    draw_thresholds(dice, system);
  }
  return system;
}

}  // namespace saltus::robustness
