// Random systems with jumps as models, and what their runs add up to.
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "hybrid_systems.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "states.hpp"

namespace saltus::robustness {
namespace {

using casadi::SX;
using result::Result;
using result::Termination;

SX course_of(model::Builder& builder, const Course& course, int& tables) {
  if (course.times.empty()) return course.constant + course.amplitude * sin(course.frequency * builder.time());
  return builder.table("course" + std::to_string(tables++), course.times, course.values)(builder.time());
}

void add_jumps(model::Builder& builder, const Hybrid& hybrid, const std::vector<SX>& x, const std::vector<SX>& n) {
  const auto named = [](const char* kind, std::size_t k) {
    model::JumpOptions options;
    options.name = kind + std::to_string(k);
    options.values = model::JumpValues::at_execution;
    return options;
  };
  const auto state = [](std::size_t i) { return "x" + std::to_string(i); };
  for (std::size_t k = 0; k < hybrid.walls.size(); ++k) {
    const Wall& wall = hybrid.walls[k];
    builder.jump(wall.side * (x[wall.position] - wall.place), model::Direction::down,
                 {{state(wall.velocity), -wall.restitution * x[wall.velocity]}}, named("wall", k));
  }
  for (std::size_t k = 0; k < hybrid.thresholds.size(); ++k) {
    const Threshold& threshold = hybrid.thresholds[k];
    std::map<std::string, SX> set;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (threshold.reset[i] != 0.0) set[state(i)] = x[i] + threshold.reset[i];
    }
    builder.jump(model::greater(x[threshold.state], threshold.value), set, named("threshold", k));
  }
  for (std::size_t k = 0; k < hybrid.relays.size(); ++k) {
    const Relay& relay = hybrid.relays[k];
    SX y = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) y += relay.slope[i] * x[i];
    auto high = named("high", k), low = named("low", k);
    high.at_start = low.at_start = true;
    builder.jump(model::greater(y, relay.high), {{"n" + std::to_string(k), -1.0}}, high);
    builder.jump(model::less(y, relay.low), {{"n" + std::to_string(k), 1.0}}, low);
  }
  static_cast<void>(n);
}

model::System to_model(const Hybrid& hybrid) {
  model::Builder builder(name(hybrid.family) + " " + std::to_string(hybrid.seed));
  std::vector<SX> x, n, rates;
  for (std::size_t i = 0; i < hybrid.start.size(); ++i) {
    x.push_back(builder.state("x" + std::to_string(i), {hybrid.start[i]}));
  }
  for (std::size_t k = 0; k < hybrid.relays.size(); ++k) {
    n.push_back(builder.discrete_state("n" + std::to_string(k), hybrid.relays[k].start));
  }
  int tables = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    rates.push_back(hybrid.b[i]);
    for (std::size_t j = 0; j < x.size(); ++j) rates[i] += hybrid.A[i][j] * x[j];
  }
  for (const auto& [row, course] : hybrid.drives) rates[row] += course_of(builder, course, tables);
  for (std::size_t k = 0; k < hybrid.laws.size(); ++k) {
    const Law& law = hybrid.laws[k];
    const SX psi = builder.switching("s" + std::to_string(k), x[law.row] - course_of(builder, law.course, tables));
    rates[law.row] -= law.size * builder.sign(psi);
  }
  for (std::size_t k = 0; k < n.size(); ++k) rates[hybrid.relays[k].row] += hybrid.relays[k].gain * n[k];
  for (std::size_t i = 0; i < x.size(); ++i) builder.dynamics("x" + std::to_string(i), rates[i]);
  add_jumps(builder, hybrid, x, n);
  auto system = builder.build();
  if (!system) throw std::runtime_error(to_text(system.error()));
  return std::move(*system);
}

/// How far neighbours of the start part, per unit of their distance; infinite where one meets another fate.
double sensitivity(const HybridModel& model, const Hybrid& hybrid, const Result& reference, double bound) {
  double largest = 1.0;
  for (const double nearby : {1e-8, bound}) {
    for (std::size_t i = 0; i < 2 * hybrid.start.size(); ++i) {
      auto start = hybrid.start;
      start[i / 2] += i % 2 == 0 ? nearby : -nearby;
      const auto neighbour = model.run(HybridIntegrator::dop853, 1e-11, start);
      if (neighbour.events.size() != reference.events.size()) return INFINITY;
      largest = std::max(largest, distance(neighbour.final.x, reference.final.x) / nearby);
    }
  }
  return largest;
}

void compare(const HybridModel& model, const Hybrid& hybrid, const std::vector<Result>& results, Tally& tally) {
  const double bound =
      1e-8 * (10.0 + static_cast<double>(results.front().events.size())) * size_of(results.front().final.x);
  const bool agree = std::all_of(results.begin(), results.end(), [&](const Result& result) {
    return distance(results.front().final.x, result.final.x) <= bound;
  });
  if (agree && hybrid.seed % 4 != 0) return;
  const auto fail = [&](const std::string& what) {
    tally.failures.push_back(fmt::format("{} {} end: {}", name(hybrid.family), hybrid.seed, what));
  };
  const Result reference = model.run(HybridIntegrator::dop853, 1e-11, hybrid.start);
  if (const auto problem = complaint(hybrid, reference, 1e-11); !problem.empty()) return fail("fine: " + problem);
  double worst = 0.0;
  for (const auto& result : results) worst = std::max(worst, distance(result.final.x, reference.final.x));
  if (worst <= bound) return;
  const double factor = sensitivity(model, hybrid, reference, bound);
  if (factor > 1e6) {
    ++tally.sensitive;
  } else if (worst > bound * factor) {
    fail(fmt::format("differs by {} from the run at 1e-11 where neighbours part by a factor {}", worst, factor));
  }
}

}  // namespace

struct HybridModel::Parts {
  model::System system;
  evaluation::ModelKernel kernel;
};

HybridModel::HybridModel(const Hybrid& hybrid) {
  auto system = to_model(hybrid);
  auto kernel = evaluation::ModelKernel::compile(system);
  if (!kernel) throw std::runtime_error(to_text(kernel.error()));
  parts_ = std::make_unique<Parts>(Parts{std::move(system), std::move(*kernel)});
}

HybridModel::~HybridModel() = default;

Result HybridModel::run(HybridIntegrator integrator, double rtol, const std::vector<double>& start) const {
  event_integrator::IntegrationOptions options;
  options.method = integrator == HybridIntegrator::dopri5   ? ode::Method::dopri5
                   : integrator == HybridIntegrator::dop853 ? ode::Method::dop853
                                                            : ode::Method::taylor;
  options.tolerances = {rtol, rtol / 100.0};
  options.until = end_time;
  options.max_steps = 200000;
  std::vector<double> x = parts_->system.initial_state;
  std::copy(start.begin(), start.end(), x.begin());
  parts_->kernel.set_initial_state(std::move(x));
  auto run = event_integrator::integrate(parts_->kernel, options);
  Result result;
  for (const auto& column : parts_->system.columns) result.switching_functions.push_back(column.name);
  result.status = std::move(run.status);
  result.final = std::move(run.final);
  result.events = std::move(run.events);
  result.trajectory = std::move(run.trajectory);
  result.statistics = run.statistics;
  return result;
}

Tally run_campaign(HybridFamily family, std::uint64_t first, std::uint64_t count) {
  Tally tally;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const Hybrid hybrid = draw(family, seed);
    try {
      const HybridModel model(hybrid);
      std::vector<Result> results;
      ++tally.systems;
      for (const auto integrator : {HybridIntegrator::dopri5, HybridIntegrator::dop853, HybridIntegrator::taylor}) {
        results.push_back(model.run(integrator, 1e-8, hybrid.start));
        const auto& result = results.back();
        const auto problem = complaint(hybrid, result, 1e-8);
        if (!problem.empty()) {
          tally.failures.push_back(fmt::format("{} {} {}: {}", name(family), seed,
                                               integrator_names[static_cast<std::size_t>(integrator)], problem));
        }
        tally.events += static_cast<long>(result.events.size());
        for (const auto& event : result.events) {
          if (event.kind == result::EventKind::jump) ++tally.jumps;
          if (event.kind == result::EventKind::accumulation) ++tally.accumulations;
        }
      }
      const auto ended_with = [&](Termination termination) {
        return [termination](const Result& result) { return result.status.termination == termination; };
      };
      if (std::any_of(results.begin(), results.end(), ended_with(Termination::outside_class))) ++tally.outside_class;
      if (!std::all_of(results.begin(), results.end(), ended_with(Termination::completed))) continue;
      ++tally.completed;
      compare(model, hybrid, results, tally);
    } catch (const std::exception& error) {
      tally.failures.push_back(fmt::format("{} {}: {}", name(family), seed, error.what()));
    }
  }
  return tally;
}

}  // namespace saltus::robustness
