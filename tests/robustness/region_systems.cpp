#include "region_systems.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "dice.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "states.hpp"

namespace saltus::robustness {
namespace {

using casadi::SX;
using result::Result;
using result::Termination;

std::vector<double> point(Dice& dice, std::size_t n) {
  std::vector<double> x(n);
  for (auto& entry : x) entry = dice.coefficient(1.0);
  return x;
}

}  // namespace

RegionSystem draw_regions(std::uint64_t seed) {
  Dice dice(seed + (std::uint64_t{1} << 42));
  RegionSystem system;
  system.seed = seed;
  system.kind = std::vector{RegionKind::cells, RegionKind::sectors, RegionKind::cones}[dice.below(3)];
  dice.round_numbers = system.kind == RegionKind::cells && dice.chance(0.2);
  const std::size_t n = system.kind == RegionKind::sectors ? 2
                        : system.kind == RegionKind::cones ? 3
                                                           : 2 + dice.below(2);
  system.start = point(dice, n);
  system.quadratic = system.kind == RegionKind::cells ? 1.0 : 0.0;
  const bool about_one_point = system.kind == RegionKind::sectors || dice.chance(0.4);
  const double pull = std::vector{-1.0, 0.0, 0.7, 1.5}[dice.below(4)];
  const double turn = std::vector{0.0, 0.0, 1.0, 3.0}[dice.below(4)];
  for (std::size_t count = 3 + dice.below(5); count > 0; --count) {
    Region region;
    auto centre = point(dice, n);
    if (system.kind == RegionKind::sectors) {
      const double angle = dice.uniform(0.0, 2.0 * M_PI), size = dice.chance(0.5) ? 1.0 : dice.uniform(0.5, 1.5);
      centre = {size * std::cos(angle), size * std::sin(angle)};
    }
    for (const double c : centre) {
      region.slope.push_back(-2.0 * c);
      region.offset += system.kind == RegionKind::cells ? c * c : 0.0;
    }
    if (system.kind == RegionKind::cones && !about_one_point) region.offset = dice.coefficient(1.0);
    region.b = point(dice, n);
    for (std::size_t i = 0; i < n; ++i) {
      region.b[i] -= pull * centre[i];
      region.A.push_back(point(dice, n));
      for (auto& entry : region.A.back()) entry *= 0.6;
      region.A.back()[i] -= 0.7;
    }
    region.b[0] -= turn * centre[1];
    region.b[1] += turn * centre[0];
    system.regions.push_back(std::move(region));
  }
  return system;
}

struct RegionModel::Parts {
  model::System system;
  evaluation::ModelKernel kernel;
};

RegionModel::RegionModel(const RegionSystem& random) {
  model::Builder b("regions " + std::to_string(random.seed));
  std::vector<SX> x;
  for (std::size_t i = 0; i < random.start.size(); ++i) {
    x.push_back(b.state("x" + std::to_string(i), {random.start[i]}));
  }
  for (std::size_t r = 0; r < random.regions.size(); ++r) {
    const Region& region = random.regions[r];
    SX indicator = region.offset;
    std::map<std::string, SX> rates;
    for (std::size_t i = 0; i < x.size(); ++i) {
      indicator += region.slope[i] * x[i] + random.quadratic * x[i] * x[i];
      SX rate = region.b[i];
      for (std::size_t j = 0; j < x.size(); ++j) rate += region.A[i][j] * x[j];
      rates["x" + std::to_string(i)] = rate;
    }
    b.region(indicator, rates, "r" + std::to_string(r));
  }
  auto system = b.build();
  if (!system) throw std::runtime_error(to_text(system.error()));
  auto kernel = evaluation::ModelKernel::compile(*system);
  if (!kernel) throw std::runtime_error(to_text(kernel.error()));
  parts_ = std::make_unique<Parts>(Parts{std::move(*system), std::move(*kernel)});
}

RegionModel::~RegionModel() = default;

Result RegionModel::run(int order, double rtol, const std::vector<double>& start) const {
  event_integrator::IntegrationOptions options;
  options.method = order == 5 ? ode::Method::dopri5 : order == 8 ? ode::Method::dop853 : ode::Method::taylor;
  options.tolerances = {rtol, rtol / 100.0};
  options.until = end_time;
  options.max_steps = 200000;
  std::vector<double> x = parts_->system.initial_state;
  std::copy(start.begin(), start.end(), x.begin());
  parts_->kernel.set_initial_state(std::move(x));
  auto run = event_integrator::integrate(parts_->kernel, options);
  Result result;
  result.status = std::move(run.status);
  result.final = std::move(run.final);
  result.events = std::move(run.events);
  result.trajectory = std::move(run.trajectory);
  return result;
}

Tally run_region_campaign(std::uint64_t first, std::uint64_t count) {
  Tally tally;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const RegionSystem system = draw_regions(seed);
    const auto fail = [&](const std::string& what) {
      tally.failures.push_back(fmt::format("regions {} {}", seed, what));
    };
    try {
      const RegionModel model(system);
      ++tally.systems;
      std::vector<Result> results;
      for (const int order : {5, 8, 16}) {
        results.push_back(model.run(order, 1e-8, system.start));
        const auto problem = complaint(system, results.back(), 1e-8);
        if (!problem.empty()) fail(fmt::format("order {}: {}", order, problem));
        tally.events += static_cast<long>(results.back().events.size());
        for (const auto& regions : results.back().trajectory.regions) tally.held_by_three += regions.front().size() > 2;
      }
      const auto ended_with = [&](Termination termination) {
        return [termination](const Result& result) { return result.status.termination == termination; };
      };
      if (std::any_of(results.begin(), results.end(), ended_with(Termination::outside_class))) ++tally.outside_class;
      if (!std::all_of(results.begin(), results.end(), ended_with(Termination::completed))) continue;
      ++tally.completed;
      if (!std::all_of(results.begin(), results.end(), is_unique)) {
        ++tally.not_unique;
        continue;
      }
      double worst = 0.0;
      for (const auto& result : results) worst = std::max(worst, distance(results[1].final.x, result.final.x));
      const double bound = 1e-8 * (10.0 + static_cast<double>(results[1].events.size()));
      if (worst <= bound) continue;
      double factor = 1.0;
      for (std::size_t i = 0; i < 2 * system.start.size(); ++i) {
        auto start = system.start;
        start[i / 2] += i % 2 == 0 ? bound : -bound;
        const auto neighbour = model.run(8, 1e-11, start);
        const bool same_fate = neighbour.events.size() == results[1].events.size();
        factor = std::max(factor, same_fate ? distance(neighbour.final.x, results[1].final.x) / bound : INFINITY);
      }
      if (factor > 1e6) {
        ++tally.sensitive;
      } else if (worst > bound * factor) {
        fail(fmt::format("end: integrators differ by {} where neighbours part by a factor {}", worst, factor));
      }
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }
  return tally;
}

}  // namespace saltus::robustness
