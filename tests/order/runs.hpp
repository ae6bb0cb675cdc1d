// Runs of finite elements at many lengths, and their errors against references.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"
#include "study.hpp"

namespace saltus::problems {

using pipeline::Method;
using pipeline::Reformulation;
using pipeline::Scheme;

struct Problem {
  const char* name;
  const char* model;
  double until;
  /// By method: elements from which on the leading term of the error dominates.
  std::array<long, runge_kutta_methods.size()> first_elements;
  /// By method: whether end states have no error but roundings, at rest on a surface or by an invariant of Gauss
  /// methods.
  std::array<bool, runge_kutta_methods.size()> exact_ends;
  /// Largest step of a state to which the roundings of a run add up, and the same of a time.
  double state_rounding, time_rounding;
};

inline constexpr std::array<bool, runge_kutta_methods.size()> none{},
    all{true, true, true, true, true, true, true, true}, of_gauss{false, false, false, false, true, true, true, true};

/// Problems 1(b), 3, 4, 8, 14 of the literature (models/README), and a circle as surface.
inline constexpr std::array<Problem, 6> problems{
    {{"Sliding", "sliding", 2.0, {200, 20, 4, 4, 20, 4, 4, 4}, all, 1e-13, 2e-13},
     {"RotatingOscillator", "rotating-oscillator", 1.5707963, {2000, 60, 10, 8, 144, 16, 8, 8}, none, 2e-13, 2e-13},
     {"DryFriction", "dry-friction-oscillator", 15.0, {2000, 60, 12, 8, 94, 18, 10, 6}, of_gauss, 1e-13, 2e-13},
     {"StickSlip", "stick-slip", 40.0, {2000, 200, 80, 50, 328, 140, 60, 190}, none, 3e-14, 2e-13},
     {"Irma", "irma", 100.0, {2000, 40, 8, 9, 40, 21, 6, 9}, none, 5e-15, 3e-13},
     {"Circle", "circle", 10.0, {800, 20, 14, 17, 22, 40, 12, 24}, none, 5e-14, 5e-14}}};

inline const ReferenceProblem& reference_of(const Problem& wanted) {
  for (const bool with_variants : {false, true}) {
    for (const ReferenceProblem& problem : references()) {
      if (problem.model != wanted.model || std::abs(problem.until - wanted.until) > 1e-3) continue;
      if (with_variants || problem.variant.empty()) return problem;
    }
  }
  throw std::runtime_error(std::string("no reference of ") + wanted.model);
}

struct Errors {
  double state = 0.0;         ///< largest of a component of the end state
  double times = 0.0;         ///< largest of a switching time
  double first_time = 0.0;    ///< of the first switch
  double first_switch = 0.0;  ///< of the state at the time where the first switch should be
};

struct Wanted {
  Method method = Method::fesd;
  Scheme scheme = Scheme::radau_iia;
  long stages = 2;
  Reformulation form = Reformulation::step;
};

/// Runs are compared by their elements of equal length but for those at switches.
struct Grid {
  long steps = 0;
  long elements = 2;  ///< per simulation step
};

inline double distance(const std::vector<double>& found, const std::vector<double>& expected) {
  double largest = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) largest = std::max(largest, std::abs(found[i] - expected[i]));
  return largest;
}

inline Errors errors_with(const Simulator& model, const ReferenceProblem& problem, const Wanted& wanted,
                          const Grid& grid) {
  const auto behind_start = [](const auto& event) { return event.t > 0.0; };
  const auto first = std::find_if(problem.events.begin(), problem.events.end(), behind_start);
  if (first == problem.events.end()) throw std::runtime_error("no switch");
  pipeline::SimulateOptions options = model.options();
  options.method = wanted.method;
  options.fesd.error_limit.reset();  // elements of the length that is studied
  options.output = pipeline::AtTimes{{first->t, problem.until}};
  for (auto* part : {&options.fesd, &options.timestepping}) {
    part->scheme = wanted.scheme;
    part->stages = wanted.stages;
    part->steps = grid.steps;
    part->elements = grid.elements;
    part->reformulation = wanted.form;
  }
  const result::Result result = model.run(options);
  if (result.status.termination != result::Termination::completed) throw std::runtime_error(result.status.message);
  Errors errors;
  errors.state = distance(result.final.x, problem.final_x);
  const auto found = std::find_if(result.events.begin(), result.events.end(), behind_start);
  if (found == result.events.end()) throw std::runtime_error("no switch found");
  errors.first_time = std::abs(found->t - first->t);
  const auto row = std::find(result.trajectory.t.begin(), result.trajectory.t.end(), first->t);
  if (row == result.trajectory.t.end()) throw std::runtime_error("no row at the first switch");
  errors.first_switch =
      distance(result.trajectory.x[static_cast<std::size_t>(row - result.trajectory.t.begin())], first->x);
  // Time-stepping sees some switches in pieces and others not at all.
  if (wanted.method == Method::timestepping) return errors;
  EXPECT_EQ(result.events.size(), problem.events.size()) << grid.steps << " steps of " << grid.elements;
  for (std::size_t i = 0; i < std::min(result.events.size(), problem.events.size()); ++i) {
    errors.times = std::max(errors.times, std::abs(result.events[i].t - problem.events[i].t));
  }
  return errors;
}

/// Root mean squares of errors over grids of about the same length of elements. Where a switch lies in its simulation
/// step decides how long the elements around it are (twice the others at most with two to a step, half as much again
/// with three); over the runs of a level that averages out.
struct Level {
  double elements = 0.0;  ///< geometric mean
  Errors mean_squares;
  long runs = 0;

  void add(const Grid& grid, const Errors& errors) {
    const auto runs_before = static_cast<double>(runs++), all_runs = static_cast<double>(runs);
    const auto mean = [&](double before, double now) { return (runs_before * before + now) / all_runs; };
    const auto n = static_cast<double>(grid.steps * grid.elements);
    elements = std::exp(mean(runs_before > 0.0 ? std::log(elements) : 0.0, std::log(n)));
    for (double Errors::*error : {&Errors::state, &Errors::times, &Errors::first_time, &Errors::first_switch}) {
      mean_squares.*error = mean(mean_squares.*error, errors.*error * errors.*error);
    }
  }
  [[nodiscard]] double rms(double Errors::*error) const { return std::sqrt(mean_squares.*error); }
};

/// Those with this number of elements to a step whose elements are in [first, end), `most` at most.
inline void add_grids(std::vector<Grid>& grids, long per_step, double first, double end, long most) {
  const auto lowest = static_cast<long>(std::ceil(first / static_cast<double>(per_step)));
  const auto above = static_cast<long>(std::ceil(end / static_cast<double>(per_step)));
  const long stride = std::max(1L, (above - lowest) / most);
  for (long i = 0, n = lowest; i < most && n < above; ++i, n += stride) grids.push_back({n, per_step});
}

inline Study study_of(const std::vector<Level>& levels, double Errors::*error, double rounding) {
  Study study;
  study.rounding = rounding;
  for (const Level& level : levels) {
    study.steps.push_back(level.elements);
    study.errors.push_back(level.rms(error));
  }
  study.stop_at_rounding();
  return study;
}

inline void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.name; }

inline const char* name(Reformulation form) { return form == Reformulation::step ? "Step" : "Stewart"; }

}  // namespace saltus::problems
