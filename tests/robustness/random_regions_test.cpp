// Random groups of modes by indicator, as Voronoi cells with affine fields: none stops without having come to its end,
// every row has the smallest indicators and a convex combination of their fields, and numbering changes nothing.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;

struct Cell {
  std::vector<double> centre, constant;
  std::vector<std::vector<double>> matrix;
};

struct RandomRegions {
  std::vector<double> x0;
  std::vector<Cell> cells;
};

/// Two or three states, three to six cells; most fields pull or turn towards the other cells, so that they meet.
RandomRegions random_regions(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto draw = [&](std::size_t count) {
    std::vector<double> values(count);
    for (double& value : values) value = unit(random);
    return values;
  };
  const std::size_t n = 2 + random() % 2, count = 3 + random() % 4;
  const double pull = std::vector{-1.0, 0.0, 0.7, 1.5}[random() % 4],
               turn = std::vector{0.0, 0.0, 1.0, 3.0}[random() % 4];
  RandomRegions system{draw(n), {}};
  for (std::size_t i = 0; i < count; ++i) {
    Cell cell{draw(n), draw(n), {}};
    for (std::size_t k = 0; k < n; ++k) {
      cell.constant[k] -= pull * cell.centre[k];
      cell.matrix.push_back(draw(n));
      for (double& entry : cell.matrix.back()) entry *= 0.6;
      cell.matrix.back()[k] -= 0.5;
    }
    cell.constant[0] -= turn * cell.centre[1];
    cell.constant[1] += turn * cell.centre[0];
    system.cells.push_back(std::move(cell));
  }
  return system;
}

Integration run(const RandomRegions& system) {
  model::Builder b("random regions");
  std::vector<SX> x;
  for (std::size_t k = 0; k < system.x0.size(); ++k) x.push_back(b.state("x" + std::to_string(k), {system.x0[k]}));
  for (const Cell& cell : system.cells) {
    SX indicator = 0.0;
    std::map<std::string, SX> rates;
    for (std::size_t k = 0; k < x.size(); ++k) {
      indicator += pow(x[k] - cell.centre[k], 2);
      SX rate = cell.constant[k];
      for (std::size_t l = 0; l < x.size(); ++l) rate += cell.matrix[k][l] * x[l];
      rates["x" + std::to_string(k)] = rate;
    }
    b.region(indicator, rates);
  }
  const auto built = b.build();
  EXPECT_TRUE(built.has_value()) << (built ? "" : to_text(built.error()));
  auto kernel = evaluation::ModelKernel::compile(*built);
  EXPECT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.tolerances = {1e-8, 1e-10};
  options.until = 10.0;
  return integrate(*kernel, options);
}

double indicator(const Cell& cell, const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) sum += (x[k] - cell.centre[k]) * (x[k] - cell.centre[k]);
  return sum;
}

/// Empty if every row is as it should be.
std::string complaint(const RandomRegions& system, const result::Trajectory& rows) {
  for (std::size_t row = 0; row < rows.t.size(); ++row) {
    const auto& x = rows.x[row];
    const auto& active = rows.regions[row].front();
    double smallest = indicator(system.cells.front(), x), sum = 0.0;
    for (const Cell& cell : system.cells) smallest = std::min(smallest, indicator(cell, x));
    for (std::size_t i = 0; i < system.cells.size(); ++i) {
      const bool is_active = std::find(active.begin(), active.end(), "mode" + std::to_string(i + 1)) != active.end();
      const double theta = rows.theta[row][i];
      sum += theta;
      if (!(theta >= -1e-9) || (!is_active && theta != 0.0)) return "weight at t = " + std::to_string(rows.t[row]);
      // Located and projected to rounding: 1e-9 is far above, and far below what a lost border would leave.
      const double above = indicator(system.cells[i], x) - smallest;
      if (is_active && above > 1e-9) return "not the smallest at t = " + std::to_string(rows.t[row]);
    }
    if (std::abs(sum - 1.0) > 1e-12) return "sum of weights at t = " + std::to_string(rows.t[row]);
  }
  return "";
}

TEST(RandomRegions, RunToTheirEndInTheRightRegionsHoweverTheyAreNumbered) {
  std::size_t held_by_three = 0, switches = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const auto system = random_regions(seed);
    const auto forward = run(system);
    ASSERT_EQ(forward.status.termination, result::Termination::completed) << seed << ": " << forward.status.message;
    EXPECT_EQ(complaint(system, forward.trajectory), "") << seed;
    switches += forward.events.size();
    if (forward.final.regions.front().size() >= 3) ++held_by_three;
    const bool unique =
        std::all_of(forward.events.begin(), forward.events.end(), [](const auto& e) { return e.unique == true; });
    if (!unique) continue;
    RandomRegions other = system;
    std::reverse(other.cells.begin(), other.cells.end());
    const auto backward = run(other);
    ASSERT_EQ(backward.status.termination, result::Termination::completed) << seed << ": " << backward.status.message;
    ASSERT_EQ(backward.events.size(), forward.events.size()) << seed;
    for (std::size_t k = 0; k < system.x0.size(); ++k) {
      EXPECT_NEAR(backward.final.x[k], forward.final.x[k], 1e-6) << seed;
    }
  }
  EXPECT_GE(held_by_three, 20U);
  EXPECT_GE(switches, 300U);
}

}  // namespace
}  // namespace saltus::event_integrator
