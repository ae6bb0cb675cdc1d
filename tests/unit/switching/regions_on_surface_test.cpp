// Regions that slide on a surface together: every set that is found solves the system, and none is missed.
#include "saltus/switching/regions/regions_on_surface.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::switching {
namespace {

RegionsOnSurface random_point(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto draw = [&](int count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& value : values) value = unit(random);
    return values;
  };
  return {{n, draw(n * n)}, {n, draw(n * n)}, draw(n), draw(n)};
}

/// The regions alone at a given selection, and how fast psi is with their weights.
double velocity_at(const RegionsOnSurface& point, double alpha, const std::vector<int>& active, RegionSet& set) {
  RegionRates rates = point.below;
  for (std::size_t i = 0; i < rates.rates.size(); ++i) {
    rates.rates[i] += alpha * (point.above.rates[i] - point.below.rates[i]);
  }
  if (!solve_region_set(rates, active, set)) return NAN;
  double velocity = 0.0;
  for (std::size_t k = 0; k < active.size(); ++k) {
    const auto j = static_cast<std::size_t>(active[k]);
    velocity +=
        set.weights[k] * (point.velocity_below[j] + alpha * (point.velocity_above[j] - point.velocity_below[j]));
  }
  return velocity;
}

TEST(RegionsOnSurface, EverySlideSolvesTheSystem) {
  std::mt19937 random(21);
  std::size_t found = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const auto point = random_point(2 + trial % 4, random);
    for (const auto& slide : admissible_region_slides(point, 0.0)) {
      RegionSet alone;
      EXPECT_NEAR(velocity_at(point, slide.alpha, slide.regions.active, alone), 0.0, 1e-9) << trial;
      ASSERT_EQ(alone.weights.size(), slide.regions.weights.size());
      for (std::size_t k = 0; k < alone.weights.size(); ++k) {
        EXPECT_NEAR(alone.weights[k], slide.regions.weights[k], 1e-8) << trial;
      }
      EXPECT_GE(alone.margin, -1e-9) << trial;
      EXPECT_TRUE(slide.alpha >= 0.0 && slide.alpha <= 1.0) << trial;
      ++found;
    }
  }
  EXPECT_GE(found, 200U);
}

TEST(RegionsOnSurface, SignChangesOfPsiOverTheSelectionAreAllFound) {
  std::mt19937 random(22);
  std::size_t found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto point = random_point(3, random);
    const auto slides = admissible_region_slides(point, 0.0);
    for (const auto& active : {std::vector{0}, {1, 2}, {0, 1, 2}}) {
      RegionSet before, after;
      constexpr int parts = 400;
      for (int i = 0; i < parts; ++i) {
        const double a = static_cast<double>(i) / parts, b = static_cast<double>(i + 1) / parts;
        const double below = velocity_at(point, a, active, before), above = velocity_at(point, b, active, after);
        // Admissible on both ends: the zero between them is, and there is no pole.
        if (!(before.margin > 0.0 && after.margin > 0.0 && below * above < 0.0)) continue;
        const bool known = std::any_of(slides.begin(), slides.end(), [&](const RegionSlide& slide) {
          return slide.regions.active == active && slide.alpha >= a - 1e-9 && slide.alpha <= b + 1e-9;
        });
        EXPECT_TRUE(known) << trial << " between " << a << " and " << b;
        ++found;
      }
    }
  }
  EXPECT_GE(found, 50U);
}

}  // namespace
}  // namespace saltus::switching
