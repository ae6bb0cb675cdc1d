#include <cmath>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "../unit/mpcc/derivative_check.hpp"
#include "fesd_models.hpp"

namespace saltus::discretization {
namespace {

/// A point inside of all bounds that is nothing special.
linalg::Vector some_point(const FesdProblem& problem) {
  linalg::Vector w(problem.variables());
  for (int i = 0; i < w.size(); ++i) w[i] = 0.5 + 0.35 * std::sin(1.7 * i + 0.3);
  return w;
}

void expect_correct(const model::System& system, Form form, const Scheme& scheme) {
  FesdProblem problem(kernel_of(system, form, scheme), 2);
  problem.set_step({.t = 0.4, .length = 0.9, .x = {0.6, -0.2}, .held = {}});
  mpcc::expect_correct_derivatives(problem, some_point(problem));
}

using Mode = std::tuple<Form, Representation, CrossComplementarity, StepEquilibration>;
class EveryMode : public testing::TestWithParam<Mode> {};

TEST_P(EveryMode, Derivatives) {
  const auto [form, representation, cross, equilibration] = GetParam();
  Scheme scheme;
  scheme.options.representation = representation;
  scheme.options.cross_complementarity = cross;
  scheme.options.step_equilibration = equilibration;
  expect_correct(rotating_oscillator(), form, scheme);
}

std::string mode_name(const testing::TestParamInfo<Mode>& info) {
  const auto& [form, representation, cross, equilibration] = info.param;
  return std::string(form == Form::step ? "step" : "stewart") + "_" + std::string(name(representation)) + "_" +
         std::string(name(cross)) + "_" + std::string(name(equilibration));
}

INSTANTIATE_TEST_SUITE_P(CrossComplementarities, EveryMode,
                         testing::Combine(testing::Values(Form::step, Form::stewart),
                                          testing::Values(Representation::integral, Representation::differential),
                                          testing::ValuesIn(all_cross_complementarities),
                                          testing::Values(StepEquilibration::heuristic_mean)),
                         mode_name);
INSTANTIATE_TEST_SUITE_P(StepEquilibrations, EveryMode,
                         testing::Combine(testing::Values(Form::step, Form::stewart),
                                          testing::Values(Representation::integral),
                                          testing::Values(CrossComplementarity::fe_stage),
                                          testing::ValuesIn(all_step_equilibrations)),
                         mode_name);

TEST(FesdDerivatives, EveryTermAtOnce) {
  for (const auto representation : {Representation::integral, Representation::differential}) {
    for (const auto& [family, stages] : {std::pair{TableauFamily::gauss_legendre, 2},  // corrected ends
                                         {TableauFamily::lobatto_iiic, 3},
                                         {TableauFamily::explicit_rk, 4}}) {
      Scheme scheme{.family = family, .stages = stages, .options = {}};
      scheme.options.representation = representation;
      expect_correct(everything(), Form::step, scheme);  // with lifted variables
      expect_correct(everything(), Form::stewart, scheme);
    }
  }
}

TEST(FesdKernel, WorkOfAnElementDoesNotDependOnTheirNumber) {
  const auto kernel = kernel_of(everything(), Form::step, {});
  const long operations = kernel->operations();
  FesdProblem few(kernel, 3);
  FesdProblem many(kernel, 300);
  EXPECT_EQ(kernel->operations(), operations);
  // Per further element the same number of entries: all of it is copies.
  FesdProblem more(kernel, 4);
  EXPECT_EQ(many.jacobian_pattern().entries() - few.jacobian_pattern().entries(),
            297 * (more.jacobian_pattern().entries() - few.jacobian_pattern().entries()));
  EXPECT_EQ(many.hessian_pattern().entries() - few.hessian_pattern().entries(),
            297 * (more.hessian_pattern().entries() - few.hessian_pattern().entries()));
  EXPECT_EQ(many.variables() - few.variables(), 297 * (more.variables() - few.variables()));
}

TEST(FesdProblem, SizesAreThoseOfThePaper) {
  // Degrees of freedom and equations of section 5.2 for a step form with theta = alpha, differential form: per element
  // n_s n_x slopes, 3 n_s n_psi algebraic variables, n_x of the end, and h.
  Scheme scheme;
  scheme.options.representation = Representation::differential;
  scheme.options.step_equilibration = StepEquilibration::direct;
  FesdProblem problem(kernel_of(rotating_oscillator(), Form::step, scheme), 4);
  EXPECT_EQ(problem.variables(), 4 * (2 * 2 + 3 * 2 * 1 + 2 + 1));
  EXPECT_EQ(problem.constraints(), 4 * (2 * 2 + 2 * 1 + 2) + 3 + 1);
  EXPECT_EQ(problem.pairs(), 4 * 2 * 3);  // fe_stage: both pairs of one selection at points 0, 1, 2
}

TEST(FesdProblem, PairsOfEachCrossComplementarity) {
  const auto pairs = [](CrossComplementarity mode, TableauFamily family) {
    Scheme scheme{.family = family, .stages = 3, .options = {}};
    scheme.options.cross_complementarity = mode;
    return FesdProblem(kernel_of(scalar_model(2.0, 1.0), Form::stewart, scheme), 5).pairs();
  };
  using enum CrossComplementarity;
  // Two regions; points 0 ... n_s, and one more for Gauss. The table of research on the reference software: per element
  // and component (n_s + 1 + r) n_s, n_s + 1 + r, n_s, 1, n_s; `paper` has one more per inner boundary.
  for (const auto& [family, points] : {std::pair{TableauFamily::radau_iia, 4}, {TableauFamily::gauss_legendre, 5}}) {
    EXPECT_EQ(pairs(stage_stage, family), 5 * 2 * points * 3);
    EXPECT_EQ(pairs(fe_stage, family), 5 * 2 * points);
    EXPECT_EQ(pairs(stage_fe, family), 5 * 2 * 3);
    EXPECT_EQ(pairs(fe_fe, family), 5 * 2);
    EXPECT_EQ(pairs(same_stage, family), 5 * 2 * 3);
    EXPECT_EQ(pairs(paper, family), 5 * 2 * 3 + 4);
  }
}

TEST(FesdProblem, VariablesHaveNames) {
  FesdProblem problem(kernel_of(rotating_oscillator(), Form::step, {}), 3);
  const auto& layout = problem.layout();
  EXPECT_EQ(layout.name(layout.first_of_element(1) + layout.element.h), "h[1]");
  EXPECT_EQ(layout.name(layout.first_of_element(2) + layout.element.stage.at(1, 0)), "stage[2,1](0)");
  EXPECT_EQ(layout.name(layout.first_of_element(0) + layout.element.lambda.at(0, 1)), "lambda[0,0](1)");
  for (int i = 0; i < layout.size(); ++i) EXPECT_FALSE(layout.name(i).empty());
}

TEST(FesdKernel, RefusesWhatItCannotDo) {
  const auto system = scalar_model(2.0, 1.0);
  const auto dcs = dcs_of(system, Form::step);
  const auto compile = [&](TableauFamily family, int stages, FesdOptions options) {
    return FesdKernel::compile(dcs, system.parameter_values, *butcher_tableau(family, stages), options);
  };
  EXPECT_EQ(compile(TableauFamily::lobatto_iiia, 3, {}).error().code, ErrorCode::not_available);
  EXPECT_EQ(compile(TableauFamily::radau_iia, 2, {.gamma_h = 1.5}).error().code, ErrorCode::invalid_option);
  EXPECT_EQ(compile(TableauFamily::radau_iia, 2, {.rho_h = 0.0}).error().code, ErrorCode::invalid_option);
  EXPECT_TRUE(compile(TableauFamily::radau_iia, 2, {}).has_value());
}

}  // namespace
}  // namespace saltus::discretization
