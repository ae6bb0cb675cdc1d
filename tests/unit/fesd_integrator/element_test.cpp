// One element: Newton's method, selections of the projected field, and where signs end.
#include "saltus/fesd_integrator/element/element.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "compiled.hpp"
#include "saltus/fesd_integrator/element/projected_field.hpp"
#include "saltus/fesd_integrator/record/element_recorder.hpp"
#include "saltus/fesd_integrator/watch/watch.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using discretization::TableauFamily;
using reformulation::Form;
using Outcome = ElementSolver::Outcome;

struct Solved {
  Outcome outcome = Outcome::not_finite;
  Element element;
};

Solved solve(const Compiled& model, const discretization::ButcherTableau& method, const Point& left, double h,
             const ActiveSet& set) {
  ElementSolver solver(model.kernel, method);
  Solved solved;
  solved.outcome = solver.solve(left, h, {&set, 1}, nullptr, ElementSolver::Guess::left_end, solved.element);
  return solved;
}

/// x' = -x: no selections.
Compiled decay() {
  model::Builder builder("decay");
  const SX x = builder.state("x", {1.0});
  builder.dynamics("x", -x);
  return Compiled(builder);
}

TEST(ElementSolver, TakesTheStepOfItsMethod) {
  const Compiled model = decay();
  constexpr double h = 0.5;
  const auto end = [&](TableauFamily family, int stages) {
    const auto [outcome, element] = solve(model, tableau(family, stages), {0.0, {1.0}, {}, 1.0}, h, model.set({}));
    EXPECT_EQ(outcome, Outcome::solved);
    return element.end[0];
  };
  EXPECT_NEAR(end(TableauFamily::radau_iia, 1), 1.0 / (1.0 + h), 1e-15);
  EXPECT_NEAR(end(TableauFamily::gauss_legendre, 1), (1.0 - h / 2) / (1.0 + h / 2), 1e-15);
  EXPECT_NEAR(end(TableauFamily::radau_iia, 2), (1.0 - h / 3) / (1.0 + 2 * h / 3 + h * h / 6), 1e-15);
  EXPECT_NEAR(end(TableauFamily::explicit_rk, 4), 1.0 - h + h * h / 2 - h * h * h / 6 + h * h * h * h / 24, 1e-15);
}

TEST(ElementSolver, SaysWhereItsEquationsHaveNoSolution) {
  // x_1 = 1 + h x_1^2 has none for h > 1/4.
  model::Builder builder("blow-up");
  const SX x = builder.state("x", {1.0});
  builder.dynamics("x", x * x);
  const Compiled model(builder);
  const auto euler = tableau(TableauFamily::radau_iia, 1);
  EXPECT_NE(solve(model, euler, {0.0, {1.0}, {}, 1.0}, 1.0, model.set({})).outcome, Outcome::solved);
  const auto solved = solve(model, euler, {0.0, {1.0}, {}, 1.0}, 0.24, model.set({}));
  EXPECT_EQ(solved.outcome, Outcome::solved);
  EXPECT_NEAR(solved.element.end[0], (1.0 - std::sqrt(1.0 - 4 * 0.24)) / (2 * 0.24), 1e-13);
}

TEST(ElementSolver, KeepsSlidingStatesOnTheirSurface) {
  for (const Form form : {Form::step, Form::stewart}) {
    const Compiled model = scalar(0.2, 1.0, 0.0, form);  // alpha = 0.6
    const ActiveSet set = model.set(form == Form::step ? std::vector{0} : std::vector{0, 0});
    std::vector<double> selections(model.kernel.selections(), 0.5);
    for (const auto& [family, stages] : {std::pair{TableauFamily::radau_iia, 3},
                                         {TableauFamily::gauss_legendre, 2},
                                         {TableauFamily::lobatto_iiic, 3},
                                         {TableauFamily::explicit_rk, 4}}) {
      const auto [outcome, element] = solve(model, tableau(family, stages), {0.0, {0.0}, selections, 1.0}, 0.3, set);
      ASSERT_EQ(outcome, Outcome::solved) << name(family);
      EXPECT_NEAR(element.end[0], 0.0, 1e-16);
      for (int m = 0; m < stages; ++m) {
        const double* at = element.stage_selections.data() + static_cast<std::size_t>(m) * selections.size();
        EXPECT_NEAR(at[0], 0.6, 1e-13) << name(family);
        if (form == Form::stewart) {
          EXPECT_NEAR(at[1], 0.4, 1e-13);
        }
      }
    }
  }
}

/// Slides along the unit circle.
Compiled circle() {
  model::Builder builder("circle");
  const SX x = builder.state("x", {1.0});
  const SX y = builder.state("y", {0.0});
  const SX pull = builder.sign(x * x + y * y - 1.0);
  builder.dynamics("x", -y * (1.0 + x / 2) - pull * x);
  builder.dynamics("y", x * (1.0 + x / 2) - pull * y / 2);
  return Compiled(builder);
}

TEST(ElementSolver, ProjectsEndsBehindTheLastStage) {
  const Compiled model = circle();
  const auto gauss = tableau(TableauFamily::gauss_legendre, 2);
  const auto [outcome, element] = solve(model, gauss, {0.0, {1.0, 0.0}, {0.5}, 1.0}, 0.2, model.set({0}));
  ASSERT_EQ(outcome, Outcome::solved);
  EXPECT_NEAR(std::hypot(element.end[0], element.end[1]), 1.0, 1e-15);
  double x = element.x[0], y = element.x[1];
  for (std::size_t m = 0; m < 2; ++m) {
    const double weight = element.h * gauss.b(static_cast<linalg::Index>(m));
    x += weight * element.stage_slopes[2 * m];
    y += weight * element.stage_slopes[2 * m + 1];
    EXPECT_NEAR(std::hypot(element.stage_states[2 * m], element.stage_states[2 * m + 1]), 1.0, 1e-15);
  }
  EXPECT_GT(std::abs(std::hypot(x, y) - 1.0), 1e-6);
}

TEST(ElementSolver, ExtrapolatesAlongItsPolynomial) {
  const Compiled model = scalar(2.0, 1.0);  // x' = 3 below
  ElementSolver solver(model.kernel, tableau(TableauFamily::radau_iia, 2));
  const ActiveSet set = model.set({-1});
  Element element, next;
  ASSERT_EQ(solver.solve({0.0, {-1.0}, {0.0}, 1.0}, 0.1, {&set, 1}, nullptr, ElementSolver::Guess::left_end, element),
            Outcome::solved);
  solver.extrapolate(element, 0.2, next);
  EXPECT_NEAR(next.stage_states[0], -0.7 + 3 * 0.2 / 3, 1e-14);
  EXPECT_NEAR(next.stage_states[1], -0.7 + 3 * 0.2, 1e-14);
}

TEST(ProjectedField, FindsTheSelectionsThatKeepTheSurface) {
  const Compiled model = scalar(0.2, 1.0, 0.1);  // alpha = (1.2 + 0.1 t) / 2
  ProjectedField field(model.kernel);
  double selection = 0.5;
  const double x = 0.0;
  ASSERT_TRUE(field.solve(2.0, &x, model.set({0}), nullptr, &selection));
  EXPECT_NEAR(selection, 0.7, 1e-14);
  std::vector<double> rate;
  field.rates(rate);
  EXPECT_NEAR(rate[0], 0.0, 1e-15);
}

TEST(ProjectedField, SaysWhereNoSelectionKeepsIt) {
  // psi = y has the rate x, whatever the selection.
  model::Builder builder("second order");
  const SX x = builder.state("x", {1.0});
  const SX y = builder.state("y", {0.0});
  builder.dynamics("x", -builder.sign(y));
  builder.dynamics("y", x);
  const Compiled model(builder);
  ProjectedField field(model.kernel);
  double selection = 0.5;
  const std::vector<double> state{1.0, 0.0};
  EXPECT_FALSE(field.solve(0.0, state.data(), model.set({0}), nullptr, &selection));
}

struct Looked {
  Watch::Answer answer = Watch::Answer::not_finite;
  Violation violation;
  double end_value = 0.0;  ///< of the condition that is violated
  std::vector<double> selections;
};

Looked look(const Compiled& model, double t, double x, double h, int mode, double selection) {
  ElementSolver solver(model.kernel, tableau(TableauFamily::radau_iia, 3));
  Watch watch(model.kernel, solver);
  const ActiveSet set = model.set({mode});
  Looked looked;
  Element element;
  looked.selections = {selection};
  EXPECT_EQ(
      solver.solve({t, {x}, looked.selections, 1.0}, h, {&set, 1}, nullptr, ElementSolver::Guess::left_end, element),
      Outcome::solved);
  looked.answer = watch.look(element, set, nullptr, looked.selections, looked.violation);
  if (looked.answer == Watch::Answer::violated) looked.end_value = watch.end_value(set, looked.violation.condition);
  return looked;
}

TEST(Watch, SeesWhereASideEnds) {
  const Compiled model = scalar(2.0, 1.0);
  const auto through = look(model, 0.0, -1.0, 0.5, -1, 0.0);
  ASSERT_EQ(through.answer, Watch::Answer::violated);
  EXPECT_EQ(through.violation.condition.kind, Condition::Kind::side);
  EXPECT_NEAR(through.violation.theta, 2.0 / 3.0, 1e-9);
  EXPECT_NEAR(through.violation.slope, -3.0, 1e-6);
  EXPECT_NEAR(through.end_value, -0.5, 1e-14);
  EXPECT_EQ(look(model, 0.0, -1.0, 0.3, -1, 0.0).answer, Watch::Answer::holds);
  // A zero at an end, within rounding, is none inside.
  EXPECT_EQ(look(model, 0.0, -1.0, 1.0 / 3.0, -1, 0.0).answer, Watch::Answer::holds);
  EXPECT_EQ(look(model, 0.0, 0.0, 0.3, 1, 1.0).answer, Watch::Answer::holds);
}

TEST(Watch, SeesWhereSlidingEnds) {
  const Compiled model = scalar(0.0, 1.0, 1.0);  // alpha = (1 + t) / 2
  const auto through = look(model, 0.5, 0.0, 1.0, 0, 0.75);
  ASSERT_EQ(through.answer, Watch::Answer::violated);
  EXPECT_EQ(through.violation.condition.kind, Condition::Kind::upper);
  EXPECT_NEAR(through.violation.theta, 0.5, 1e-9);
  EXPECT_NEAR(through.end_value, -0.25, 1e-13);
  const auto before = look(model, 0.5, 0.0, 0.4, 0, 0.75);
  EXPECT_EQ(before.answer, Watch::Answer::holds);
  EXPECT_NEAR(before.selections[0], 0.95, 1e-13);
}

TEST(Watch, SeesADipThatNoStageSees) {
  // psi = (t - 0.5)^2 - 0.001 along x' = 2 (t - 0.5): below zero between 0.468 and 0.532 only.
  model::Builder builder("dip");
  const SX x = builder.state("x", {0.249});
  const SX t = builder.time();
  builder.dynamics("x", 2.0 * (t - 0.5) + 0.0 * builder.sign(x));
  const SX y = builder.state("y", {0.0});
  builder.dynamics("y", builder.step(x));
  const Compiled model(builder);
  ElementSolver solver(model.kernel, tableau(TableauFamily::gauss_legendre, 2));
  Watch watch(model.kernel, solver);
  const ActiveSet set = model.set({1});
  Element element;
  std::vector<double> selections{1.0};
  ASSERT_EQ(solver.solve({0.0, {0.249, 0.0}, selections, 1.0}, 1.0, {&set, 1}, nullptr, ElementSolver::Guess::left_end,
                         element),
            Outcome::solved);
  Violation violation;
  ASSERT_EQ(watch.look(element, set, nullptr, selections, violation), Watch::Answer::violated);
  EXPECT_NEAR(violation.theta, 0.5 - std::sqrt(0.001), 1e-6);
}

TEST(ElementRecorder, KeepsMultipliersAtEndsAndStages) {
  for (const Form form : {Form::step, Form::stewart}) {
    const Compiled model = scalar(2.0, 1.0, 0.0, form);
    const auto method = tableau(TableauFamily::radau_iia, 2);
    const bool step = form == Form::step;
    const ActiveSet set = model.set(step ? std::vector{-1} : std::vector{-1, 0});
    const std::vector<double> selections = step ? std::vector{0.0} : std::vector{0.0, 1.0};
    const auto solved = solve(model, method, {1.0, {-1.0}, selections, 1.0}, 0.3, set);
    ASSERT_EQ(solved.outcome, Outcome::solved);
    ElementRecorder recorder(model.kernel, model.facts, method);
    recorder.add(solved.element, selections, selections, 1.3, set, nullptr);
    const auto elements = recorder.take();
    EXPECT_EQ(elements.points, 4U);
    EXPECT_EQ(elements.selections.front(),
              (result::ElementSelection{step ? "x" : "x > 0",
                                        step ? result::SelectionForm::step : result::SelectionForm::stewart}));
    const std::vector<double> times{1.0, 1.1, 1.3, 1.3}, psi{-1.0, -0.7, -0.1, -0.1};
    for (std::size_t i = 0; i < times.size(); ++i) {
      EXPECT_NEAR(elements.t[i], times[i], 1e-15);
      // g = -S psi: the region x > 0 is -psi + |psi| above the smallest.
      EXPECT_NEAR(elements.lambda[i][0], step ? psi[i] : -2.0 * psi[i], 1e-14);
      EXPECT_EQ(elements.selection[i], selections);
      if (!step) {
        EXPECT_EQ(elements.lambda[i][1], 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
