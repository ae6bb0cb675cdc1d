#include "saltus/fesd_integrator/step_problem.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fesd_models.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/fesd_integrator/integrate.hpp"

namespace saltus::fesd_integrator {
namespace {

using discretization::Form;
using discretization::Scheme;
using result::Termination;

StepSolution solve(const model::System& system, Form form, const Scheme& scheme, int elements,
                   const discretization::StepData& step) {
  adapters::IpoptSolver ipopt;
  auto problem = StepProblem::make(discretization::dcs_of(system, form), system.parameter_values,
                                   *discretization::butcher_tableau(scheme.family, scheme.stages), scheme.options,
                                   elements, ipopt);
  EXPECT_TRUE(problem.has_value());
  return problem->solve(step);
}

/// Modes of the selections, or of the regions {x < 0, x > 0}.
std::vector<int> modes(Form form, int sign) {
  if (form == Form::step) return {sign};
  return {sign <= 0 ? 0 : -1, sign >= 0 ? 0 : -1};
}

TEST(StepProblem, ModesOfTheFourCases) {
  // Example 3 of [nurkanovic2024], two elements each: the modes before and after the switch.
  struct Case {
    const char* name;
    model::System system;
    double x, length, switch_time;
    int before, after;
  };
  using discretization::scalar_model;
  const Case cases[] = {{"crossing", scalar_model(2.0, 1.0), -1.0, 1.0, 1.0 / 3.0, -1, 1},
                        {"leaving sliding", scalar_model(0.0, 1.0, 1.0), 0.0, 1.6, 1.0, 0, 1}};
  for (const auto& [name, system, x, length, switch_time, before, after] : cases) {
    for (const Form form : {Form::step, Form::stewart}) {
      SCOPED_TRACE(name);
      const auto solution = solve(system, form, {}, 2, {.t = 0.0, .length = length, .x = {x}, .held = {}});
      EXPECT_EQ(solution.termination, Termination::completed) << solution.message;
      ASSERT_EQ(solution.elements.size(), 2u);
      const auto regions_before = modes(form, before);
      EXPECT_EQ(solution.elements[0].modes.size(), regions_before.size());
      // The order of the regions is the reformulation's: exactly one is active off the surface.
      if (form == Form::step) {
        EXPECT_EQ(solution.elements[0].modes, regions_before);
        EXPECT_EQ(solution.elements[1].modes, modes(form, after));
      } else {
        EXPECT_EQ(std::count(solution.elements[0].modes.begin(), solution.elements[0].modes.end(), 0),
                  before == 0 ? 2 : 1);
        EXPECT_EQ(std::count(solution.elements[1].modes.begin(), solution.elements[1].modes.end(), 0), 1);
        EXPECT_NE(solution.elements[0].modes, solution.elements[1].modes);
      }
      if (before != 0) {
        EXPECT_NEAR(solution.elements[0].h, switch_time, 1e-9);
      }
    }
  }
}

TEST(StepProblem, TwoSurfacesInOneStep) {
  // x' = 1 + step(x), y' = 1 from (-0.2, -0.5): x = 0 at 0.2, y = 0 at 0.5.
  model::Builder builder("two");
  const casadi::SX x = builder.state("x", {});
  const casadi::SX y = builder.state("y", {});
  builder.dynamics("x", 1.0 + builder.step(x));
  builder.dynamics("y", 2.0 - builder.step(y));
  const auto system = *builder.build();
  for (const Form form : {Form::step, Form::stewart}) {
    const auto solution = solve(system, form, {}, 3, {.t = 0.0, .length = 0.6, .x = {-0.2, -0.8}, .held = {}});
    EXPECT_EQ(solution.termination, Termination::completed) << solution.message;
    ASSERT_EQ(solution.elements.size(), 3u);
    EXPECT_NEAR(solution.elements[1].t, 0.2, 1e-9);
    EXPECT_NEAR(solution.elements[2].t, 0.4, 1e-9);
    EXPECT_NEAR(solution.elements[2].end[0], 0.8, 1e-9);
    EXPECT_NEAR(solution.elements[2].end[1], 0.2, 1e-9);
  }
}

TEST(StepProblem, NoSolutionIsNotCalledOne) {
  // Three switches do not fit between two elements.
  model::Builder builder("three");
  const casadi::SX x = builder.state("x", {});
  builder.dynamics("x", 1.0 + builder.step(x) + builder.step(x - 1.0) + builder.step(x - 3.0));
  const auto system = *builder.build();
  const auto solution = solve(system, Form::step, {}, 2, {.t = 0.0, .length = 3.0, .x = {-1.0}, .held = {}});
  EXPECT_NE(solution.termination, Termination::completed);
  EXPECT_FALSE(solution.message.empty());
}

TEST(StepProblem, EngineByProblemsAndByPredictionAgree) {
  // Two ways to the same equations: where one switch falls between the two elements of a step, both lengths are given.
  const auto run = [](const model::System& system, Form form, StepProblem* problem, double until) {
    IntegrationOptions options;
    options.tableau = *discretization::butcher_tableau(discretization::TableauFamily::radau_iia, 3);
    options.until = until;
    options.steps = 6;
    options.step_problem = problem;
    return *integrate(system, discretization::dcs_of(system, form), options);
  };
  model::Builder builder("friction");  // sticks at t = pi, before that no switch: problem 4 with more friction
  const casadi::SX x = builder.state("x", {.initial = 1.2});
  const casadi::SX v = builder.state("v", {.initial = -1e-3});
  builder.dynamics("x", v);
  builder.dynamics("v", -x - 0.4 * builder.sign(v));
  const auto system = *builder.build();
  for (const Form form : {Form::step, Form::stewart}) {
    for (const auto equilibration :
         {discretization::StepEquilibration::heuristic_mean, discretization::StepEquilibration::l2_relaxed_scaled}) {
      adapters::IpoptSolver ipopt;
      discretization::FesdOptions options;
      options.step_equilibration = equilibration;
      auto problem = StepProblem::make(discretization::dcs_of(system, form), system.parameter_values,
                                       *discretization::butcher_tableau(discretization::TableauFamily::radau_iia, 3),
                                       options, 2, ipopt);
      const auto by_problems = run(system, form, &*problem, 4.0);
      const auto predicted = run(system, form, nullptr, 4.0);
      EXPECT_EQ(by_problems.status.termination, Termination::completed) << by_problems.status.message;
      EXPECT_EQ(predicted.status.termination, Termination::completed) << predicted.status.message;
      ASSERT_EQ(by_problems.final.x.size(), 2u);
      EXPECT_NEAR(by_problems.final.x[0], predicted.final.x[0], 1e-8);
      EXPECT_NEAR(by_problems.final.x[1], predicted.final.x[1], 1e-8);
      ASSERT_EQ(by_problems.events.size(), predicted.events.size());
      for (std::size_t i = 0; i < predicted.events.size(); ++i) {
        EXPECT_NEAR(by_problems.events[i].t, predicted.events[i].t, 1e-8);
        EXPECT_EQ(by_problems.events[i].mode_after, predicted.events[i].mode_after);
      }
    }
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
