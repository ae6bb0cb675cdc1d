// The elements of an optimised point: which vanish, which sides they are on, and what is between their ends.
#include "saltus/fesd_integrator/optimum/pieces.hpp"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "compiled.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"

namespace saltus::fesd_integrator {
namespace {

using discretization::OcpSolution;
using discretization::SolvedElement;
using discretization::TableauFamily;

/// Values of an element of one stage, of x and of the complementarities of its selection.
struct Values {
  double end = 0.0, selection = 0.0, below = 0.0, above = 0.0;
};

SolvedElement element(double t, double h, const Values& values) {
  const auto one = [](double value) { return linalg::Matrix::constant(1, 1, value); };
  SolvedElement made{t, h, one(values.end), one(values.selection), linalg::Matrix::constant(2, 2, 0.0), {}};
  made.lambda(0, 0) = values.below;
  made.lambda(1, 0) = values.above;
  made.end = linalg::Vector::constant(1, values.end);
  return made;
}

OcpSolution point(double x, std::vector<SolvedElement> elements) {
  OcpSolution solution;
  solution.horizon = 2.0;
  solution.initial_state = {x};
  solution.elements = {std::move(elements)};
  return solution;
}

/// x' = -sign x from -1: on the surface from t = 1 on. The element between has vanished.
OcpSolution arrival() {
  return point(-1.0, {element(0.0, 1.0, {0.0, 0.0, 1.0, 0.0}), element(1.0, 1e-12, {0.0, 0.0, 0.0, 0.0}),
                      element(1.0 + 1e-12, 1.0, {0.0, 0.5 + 1e-8, 0.0, 0.0})});
}

TEST(OptimizedPieces, LeaveOutElementsThatVanished) {
  const Compiled model = scalar(0.0, 1.0);
  const auto pieces = optimized_pieces(arrival(), {0.0, 2.0}, model.kernel, model.functions, model.facts);
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0].element.t, 0.0);
  EXPECT_EQ(pieces[0].end, pieces[1].element.t);
  EXPECT_EQ(pieces[1].end, 2.0);
  EXPECT_EQ(pieces[0].element.x, std::vector<double>{-1.0});
  EXPECT_EQ(pieces[1].element.x, std::vector<double>{0.0});
  EXPECT_FALSE(pieces[0].is_frozen || pieces[1].is_frozen);
}

TEST(OptimizedPieces, ReadSidesOffTheirPairs) {
  const Compiled model = scalar(0.0, 1.0);
  const auto pieces = optimized_pieces(arrival(), {0.0, 2.0}, model.kernel, model.functions, model.facts);
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0].set.modes(), std::vector<int>{-1});
  EXPECT_EQ(pieces[1].set.modes(), std::vector<int>{0});
  EXPECT_EQ(pieces[0].right, std::vector<double>{0.0});
  // Of the projected field, and not of the stage, which has the error of a solution.
  EXPECT_NEAR(pieces[1].left[0], 0.5, 1e-14);
}

TEST(OptimizedPieces, RoundingsSwitchNothing) {
  const Compiled model = scalar(0.0, 1.0);
  const auto solution =
      point(1.0, {element(0.0, 1.0, {0.0, 1.0, 0.0, 1.0}), element(1.0, 1.0, {0.0, 1.0 - 1e-10, 0.0, 0.0})});
  const auto pieces = optimized_pieces(solution, {0.0, 2.0}, model.kernel, model.functions, model.facts);
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0].set.modes(), std::vector<int>{1});
  EXPECT_EQ(pieces[1].set.modes(), std::vector<int>{1});
  EXPECT_EQ(pieces[1].element.stage_selections, std::vector<double>{1.0});
}

TEST(OptimizedPieces, HaveASolutionBetweenTheirEnds) {
  Compiled model = scalar(0.0, 1.0);
  const auto pieces = optimized_pieces(arrival(), {0.0, 2.0}, model.kernel, model.functions, model.facts);
  const auto between = solution_of(pieces, tableau(TableauFamily::radau_iia, 1), std::move(model.kernel),
                                   std::move(model.functions), model.facts);
  const auto rows = between->rows({0.25, 1.5});
  ASSERT_EQ(rows.t.size(), 2U);
  EXPECT_NEAR(rows.x[0][0], -0.75, 1e-15);
  EXPECT_NEAR(rows.x[1][0], 0.0, 1e-7);
  EXPECT_EQ(rows.mode[0][0], -1);
  EXPECT_EQ(rows.mode[1][0], 0);
}

}  // namespace
}  // namespace saltus::fesd_integrator
