#include <cmath>
#include <string>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "../unit/mpcc/derivative_check.hpp"
#include "fesd_models.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/homotopy/follow_path.hpp"

namespace saltus::discretization {
namespace {

using result::Termination;

/// The solution of one simulation step, and its elements.
struct Solved {
  std::unique_ptr<FesdProblem> problem;
  solver::homotopy::PathResult path;
  std::vector<SolvedElement> elements;
};

Solved solve(const model::System& system, Form form, const Scheme& scheme, int elements, const StepData& step) {
  Solved solved;
  solved.problem = std::make_unique<FesdProblem>(kernel_of(system, form, scheme), elements);
  solved.problem->set_step(step);
  adapters::IpoptSolver ipopt;
  auto path = solver::homotopy::follow_path(*solved.problem, solved.problem->first_guess(), ipopt, {});
  EXPECT_TRUE(path.has_value());
  solved.path = *path;
  solved.elements = solved.problem->read(solved.path.point.w);
  return solved;
}

Scheme scheme_with(CrossComplementarity cross, StepEquilibration equilibration) {
  Scheme scheme;
  scheme.options.cross_complementarity = cross;
  scheme.options.step_equilibration = equilibration;
  return scheme;
}

/// Complementarities hold to sigma = 1e-10 over sides of order 0.1, so does everything that depends on them; a switch
/// is where lambda and its partner vanish together, to sqrt(sigma) at worst.
constexpr double of_switch = 2e-5;

class EveryCross : public testing::TestWithParam<std::tuple<Form, CrossComplementarity>> {};

TEST_P(EveryCross, FindsTheCrossing) {
  // x' = 2 - sgn x from -1: 3 (t - 1/3) before, t - 1/3 after the switch.
  const auto [form, cross] = GetParam();
  const auto solved = solve(scalar_model(2.0, 1.0), form, scheme_with(cross, StepEquilibration::heuristic_mean), 2,
                            {.t = 0.0, .length = 1.0, .x = {-1.0}, .held = {}});
  EXPECT_EQ(solved.path.termination, Termination::completed) << solved.path.message;
  if (cross == CrossComplementarity::same_stage) {
    EXPECT_DOUBLE_EQ(solved.elements[0].h, 0.5);  // without detection the switch is inside of an element
    EXPECT_GT(std::abs(solved.elements[1].end[0] - 2.0 / 3.0), 1e-2);
    return;
  }
  EXPECT_NEAR(solved.elements[0].h, 1.0 / 3.0, of_switch);
  EXPECT_NEAR(solved.elements[0].end[0], 0.0, of_switch);
  EXPECT_NEAR(solved.elements[1].end[0], 2.0 / 3.0, of_switch);
  EXPECT_NEAR(solved.elements[0].h + solved.elements[1].h, 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, EveryCross,
                         testing::Combine(testing::Values(Form::step, Form::stewart),
                                          testing::ValuesIn(all_cross_complementarities)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param) == Form::step ? "step_" : "stewart_") +
                                  std::string(name(std::get<1>(test.param)));
                         });

class EveryEquilibration : public testing::TestWithParam<StepEquilibration> {};

TEST_P(EveryEquilibration, StepsChangeAtTheSwitchOnly) {
  // The same with four elements: some end at 1/3; with an equilibration the others are alike on both sides.
  const auto solved = solve(scalar_model(2.0, 1.0), Form::step, scheme_with(CrossComplementarity::fe_stage, GetParam()),
                            4, {.t = 0.0, .length = 1.0, .x = {-1.0}, .held = {}});
  EXPECT_EQ(solved.path.termination, Termination::completed) << solved.path.message;
  double t = 0.0;
  double nearest = 1.0;
  for (const auto& element : solved.elements) {
    t += element.h;
    nearest = std::min(nearest, std::abs(t - 1.0 / 3.0));
  }
  EXPECT_NEAR(nearest, 0.0, of_switch);
  EXPECT_NEAR(solved.elements.back().end[0], 2.0 / 3.0, of_switch);
  if (GetParam() == StepEquilibration::none || GetParam() == StepEquilibration::heuristic_mean ||
      GetParam() == StepEquilibration::heuristic_diff) {
    return;  // the heuristics only pull
  }
  for (std::size_t n = 1; n < solved.elements.size(); ++n) {
    const auto& before = solved.elements[n - 1];
    const auto& after = solved.elements[n];
    if (std::abs(after.t - 1.0 / 3.0) < 1e-3) continue;
    // eta or its like is of order 1e-2 here, and what it multiplies vanishes to rounding in equations, to the
    // acceptable tolerance in objectives.
    EXPECT_NEAR(before.h, after.h, 1e-3) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryEquilibration, testing::ValuesIn(all_step_equilibrations),
                         [](const auto& test) { return std::string(name(test.param)); });

}  // namespace
}  // namespace saltus::discretization
