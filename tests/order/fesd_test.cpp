// Finite elements with switch detection keep the order of their method in end state and switching times, through
// crossings, sliding on lines and curves, and exits, in both forms; without switch detection all fall to order 1.
#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"
#include "study.hpp"

namespace saltus::problems {
namespace {

using pipeline::Method;
using pipeline::Reformulation;
using pipeline::Scheme;

struct Problem {
  const char* name;
  const char* model;
  double until;
  /// By method: simulation steps from which on the leading term of the error dominates.
  std::array<double, runge_kutta_methods.size()> first_steps;
};

/// Problems 1(b), 3, 4, 8, 14 of the literature (models/README), and a circle as surface.
constexpr std::array<Problem, 6> problems{
    {{"Sliding", "sliding", 2.0, {12, 12, 6, 3, 60, 10, 3, 2}},
     {"RotatingOscillator", "rotating-oscillator", 1.5707963, {1500, 26, 18, 9, 38, 18, 12, 7}},
     {"DryFriction", "dry-friction-oscillator", 15.0, {2000, 35, 24, 12, 35, 17, 12, 8}},
     {"StickSlip", "stick-slip", 40.0, {2000, 104, 50, 35, 217, 50, 35, 24}},
     {"Irma", "irma", 100.0, {20, 20, 5, 3, 20, 12, 4, 14}},
     {"Circle", "circle", 10.0, {1000, 38, 26, 9, 38, 26, 18, 16}}}};

const ReferenceProblem& reference_of(const Problem& wanted) {
  for (const bool with_variants : {false, true}) {
    for (const ReferenceProblem& problem : references()) {
      if (problem.model != wanted.model || std::abs(problem.until - wanted.until) > 1e-3) continue;
      if (with_variants || problem.variant.empty()) return problem;
    }
  }
  throw std::runtime_error(std::string("no reference of ") + wanted.model);
}

struct Errors {
  double state = 0.0;       ///< largest of a component of the end state
  double times = 0.0;       ///< largest of a switching time
  double first_time = 0.0;  ///< of the first switch
};

struct Wanted {
  Method method = Method::fesd;
  Scheme scheme = Scheme::radau_iia;
  long stages = 2;
  Reformulation form = Reformulation::step;
};

Errors errors_with(const Simulator& model, const ReferenceProblem& problem, const Wanted& wanted, long steps) {
  pipeline::SimulateOptions options = model.options();
  options.method = wanted.method;
  options.fesd.error_limit.reset();  // elements of the length that is studied
  options.output = pipeline::NumberOfPoints{2};
  for (auto* part : {&options.fesd, &options.timestepping}) {
    part->scheme = wanted.scheme;
    part->stages = wanted.stages;
    part->steps = steps;
    part->reformulation = wanted.form;
  }
  const result::Result result = model.run(options);
  if (result.status.termination != result::Termination::completed) throw std::runtime_error(result.status.message);
  Errors errors;
  for (std::size_t i = 0; i < problem.final_x.size(); ++i) {
    errors.state = std::max(errors.state, std::abs(result.final.x[i] - problem.final_x[i]));
  }
  const auto first =
      std::find_if(problem.events.begin(), problem.events.end(), [](const auto& event) { return event.t > 0.0; });
  const auto found = std::find_if(result.events.begin(), result.events.end(),
                                  [](const result::Event& event) { return event.t > 0.0; });
  if (first == problem.events.end() || found == result.events.end()) throw std::runtime_error("no switch");
  errors.first_time = std::abs(found->t - first->t);
  // Time-stepping sees some switches in pieces and others not at all.
  if (wanted.method == Method::timestepping) return errors;
  EXPECT_EQ(result.events.size(), problem.events.size()) << steps << " steps";
  for (std::size_t i = 0; i < std::min(result.events.size(), problem.events.size()); ++i) {
    errors.times = std::max(errors.times, std::abs(result.events[i].t - problem.events[i].t));
  }
  return errors;
}

/// An order lost at the switches would be one less, or 1 altogether. Orders 7 and 8 go from 1e-5 to rounding within a
/// factor of ten or less in the step, over which errors that scatter by ten give a slope no better than to one.
double scatter(double order) { return order < 6.5 ? 0.5 : 1.2; }
/// So few points do not give a slope.
constexpr std::size_t least_points = 4;

/// Either a slope, or nothing but roundings (Gauss methods on x'' = -x, a state at rest on its surface), or an error
/// that is there too soon (IRMA with Gauss-4: 1e-8 with 4 steps, where each has its own part of a switch, roundings
/// with 14).
void expect_order(const Study& study, double order, const char* what) {
  if (study.usable() < least_points) {
    constexpr double small = 1e-7;
    EXPECT_LT(study.largest(), small) << what << "\n" << study.table();
    EXPECT_LT(study.errors.back(), study.rounding) << what << "\n" << study.table();
    return;
  }
  testing::Test::RecordProperty(what, std::to_string(study.slope()));
  EXPECT_GT(study.slope(), order - scatter(order)) << what << "\n" << study.table();
}

void expect_order(const Problem& problem, const Wanted& wanted, double order, double first_steps) {
  const ReferenceProblem& reference = reference_of(problem);
  const Simulator model = Simulator::from_reference(reference);
  // Errors of methods of order 1 do not scatter: they are smooth in the step, and expensive.
  const bool first_order = order < 2.0;
  const int levels = first_order ? 8 : 36;
  const double ratio = first_order ? 1.16 : 1.06;
  const std::size_t group = first_order ? 1 : order < 6.5 ? 4 : 2;
  Study states, times;
  double steps = first_steps;
  for (int level = 0; level < levels; ++level, steps = std::max(steps * ratio, std::floor(steps) + 1.0)) {
    const long n = std::lround(steps);
    const Errors errors = errors_with(model, reference, wanted, n);
    states.add(n, errors.state);
    times.add(n, errors.times);
  }
  // Slopes of psi at a switch are 1e-3 on IRMA: roundings of times are so much larger.
  if (std::string(problem.model) == "irma") times.rounding = 3e-11;
  states = states.envelope(group);
  times = times.envelope(group);
  expect_order(states, order, "state");
  expect_order(times, order, "times");
  // Down to 1e-11, as far as that takes no more than some thousand steps.
  constexpr double aim = 1e-11, most_steps = 6000.0;
  const double worst = std::max(states.errors.back(), times.errors.back());
  const double needed = states.steps.back() * std::pow(worst / aim, 1.0 / order);
  if (needed < states.steps.back() || needed > most_steps) return;
  const Errors last = errors_with(model, reference, wanted, std::lround(needed));
  EXPECT_LT(std::max(last.state, last.times), 10.0 * aim) << std::lround(needed) << " steps\n" << times.table();
}

const char* name(Reformulation form) { return form == Reformulation::step ? "Step" : "Stewart"; }

// ---------------------------------------------------------------------------------------------------------------------

class FesdOrder : public testing::TestWithParam<std::tuple<Problem, std::size_t, Reformulation>> {};

void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.name; }

TEST_P(FesdOrder, HoldsInEndStateAndSwitchingTimes) {
  const auto& [problem, i, form] = GetParam();
  const auto& method = runge_kutta_methods[i];
  expect_order(problem, {Method::fesd, method.scheme, method.stages, form}, method.order, problem.first_steps[i]);
}

std::string name_of(const testing::TestParamInfo<FesdOrder::ParamType>& test) {
  const auto& [problem, i, form] = test.param;
  return std::string(problem.name) + runge_kutta_methods[i].name + name(form);
}

INSTANTIATE_TEST_SUITE_P(Table, FesdOrder,
                         testing::Combine(testing::ValuesIn(problems),
                                          testing::Range<std::size_t>(0, runge_kutta_methods.size()),
                                          testing::Values(Reformulation::step, Reformulation::stewart)),
                         name_of);

/// The other families where one of the two difficulties of sliding on curves could cost them their order: c_s != 1 has
/// no part in them, but the first stage of Lobatto IIIA has no multiplier and explicit methods have no stage at the
/// end.
struct Family {
  const char* name;
  Scheme scheme;
  long stages;
  double order;
  double first_steps;
};

class FesdOrderOnACircle : public testing::TestWithParam<Family> {};

TEST_P(FesdOrderOnACircle, HoldsInEndStateAndSwitchingTime) {
  const Family& family = GetParam();
  expect_order(problems.back(), {Method::fesd, family.scheme, family.stages, Reformulation::step}, family.order,
               family.first_steps);
}

INSTANTIATE_TEST_SUITE_P(
    Families, FesdOrderOnACircle,
    testing::Values(
        Family{"LobattoIIIC2", Scheme::lobatto_iiic, 2, 2, 54}, Family{"LobattoIIIC3", Scheme::lobatto_iiic, 3, 4, 33},
        Family{"LobattoIIIC4", Scheme::lobatto_iiic, 4, 6, 24}, Family{"LobattoIIIC5", Scheme::lobatto_iiic, 5, 8, 17},
        Family{"LobattoIIIA2", Scheme::lobatto_iiia, 2, 2, 54}, Family{"LobattoIIIA3", Scheme::lobatto_iiia, 3, 4, 33},
        Family{"LobattoIIIA4", Scheme::lobatto_iiia, 4, 6, 24}, Family{"LobattoIIIA5", Scheme::lobatto_iiia, 5, 8, 17},
        Family{"Explicit1", Scheme::explicit_rk, 1, 1, 400}, Family{"Explicit2", Scheme::explicit_rk, 2, 2, 54},
        Family{"Explicit3", Scheme::explicit_rk, 3, 3, 40},  // Half-explicit methods of order 4 need five stages.
        Family{"Explicit4", Scheme::explicit_rk, 4, 3, 80}),
    [](const auto& test) { return std::string(test.param.name); });

// ---------------------------------------------------------------------------------------------------------------------

class WithoutSwitchDetection : public testing::TestWithParam<std::tuple<Problem, Reformulation>> {};

/// Where a switch lies in its element decides: errors jump between 0 and C h, so slopes are those of their mean over
/// the methods. End states forget where the solution ends at rest or is drawn to a sliding mode or a cycle: they are of
/// no use except where it crosses.
TEST_P(WithoutSwitchDetection, EveryMethodFallsToOrderOne) {
  const auto& [problem, form] = GetParam();
  const bool crosses = std::string(problem.model) == "rotating-oscillator" || std::string(problem.model) == "irma";
  const ReferenceProblem& reference = reference_of(problem);
  const Simulator model = Simulator::from_reference(reference);
  constexpr int levels = 24;
  constexpr double ratio = 1.13;
  double time_slope = 0.0, state_slope = 0.0;
  std::string tables;
  for (const auto& method : runge_kutta_methods) {
    // Implicit Euler needs more steps before anything of its error is small.
    double steps = method.order < 2.0 ? 300.0 : 100.0;
    Study states, times;
    int without_solution = 0;
    for (int level = 0; level < levels; ++level, steps *= ratio) {
      const long n = std::lround(steps);
      Errors errors;
      try {
        errors = errors_with(model, reference, {Method::timestepping, method.scheme, method.stages, form}, n);
      } catch (const std::runtime_error&) {
        ++without_solution;  // no combination of sides solves the stages of some element
        continue;
      }
      states.add(n, errors.state);
      times.add(n, errors.first_time);
    }
    EXPECT_LE(without_solution, levels / 8) << method.name;
    time_slope += times.slope() / static_cast<double>(runge_kutta_methods.size());
    if (crosses) state_slope += states.slope() / static_cast<double>(runge_kutta_methods.size());
    tables += std::string(method.name) + ": times " + std::to_string(times.slope()) + "\n";
    if (crosses) tables += "  states " + std::to_string(states.slope()) + "\n";
  }
  RecordProperty("times", std::to_string(time_slope));
  EXPECT_NEAR(time_slope, 1.0, 0.25) << tables;
  if (!crosses) return;
  EXPECT_NEAR(state_slope, 1.0, 0.25) << tables;
}

INSTANTIATE_TEST_SUITE_P(Table, WithoutSwitchDetection,
                         testing::Combine(testing::ValuesIn(problems),
                                          testing::Values(Reformulation::step, Reformulation::stewart)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + name(std::get<1>(test.param));
                         });

}  // namespace
}  // namespace saltus::problems
