// The parts of a run, each alone: its position, lengths of parts of steps, the secant, counts of decisions and
// elements.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "compiled.hpp"
#include "saltus/fesd_integrator/element/rest_projection.hpp"
#include "saltus/fesd_integrator/run/decision_count_internal.hpp"
#include "saltus/fesd_integrator/run/part_length_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/fesd_integrator/run/run_status_internal.hpp"
#include "saltus/fesd_integrator/run/safeguarded_secant_internal.hpp"
#include "saltus/fesd_integrator/run/switch_locator_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

TEST(Position, ForgetsLargeStatesByHalvesPerElement) {
  Position position(1.0, {-8.0, 2.0}, 0);
  EXPECT_EQ(position.size(), 8.0);
  Element element;
  element.end = {1.0, -1.0};
  element.size = 1.5;
  position.move_to(2.0, element, {});
  EXPECT_EQ(position.size(), 4.0);
  position.move_to(3.0, element, {});
  position.move_to(4.0, element, {});
  EXPECT_EQ(position.size(), 1.5);
  EXPECT_EQ(position.t(), 4.0);
  EXPECT_EQ(position.left_end().x, element.end);
  EXPECT_EQ(position.left_end().size, 1.5);
}

PartLength limited(int elements, int stages) {
  return PartLength({2.0, elements, stages, PartLength::Shape::Errors::limited});
}

TEST(PartLength, IsAWholeStepUntilItIsTooCoarse) {
  PartLength length = limited(2, 2);
  EXPECT_EQ(length.end_of_part(0.5, 2.0, 0.0), 2.0);
  length.begin_chain();
  EXPECT_FALSE(length.is_too_coarse(1.0, 1.0));
  EXPECT_TRUE(length.is_too_coarse(1.0, 4.0));
  EXPECT_TRUE(length.is_too_coarse(1.0, 0.5)) << "the largest share of the chain counts";
  // 0.8 * 4^(-1/2) = 0.4 of the part of length 2.
  length.shorten_behind(1.0);
  EXPECT_NEAR(length.end_of_part(0.0, 2.0, 0.0), 2.0 / 3.0, 1e-15) << "three equal parts of at most 0.8";
  // Parts of the shortest length are taken however coarse they are.
  length.begin_chain();
  EXPECT_FALSE(length.is_too_coarse(0.9e-3 * 2.0, 1e9));
}

TEST(PartLength, GrowsBehindElementsOfSmallErrors) {
  PartLength length = limited(2, 1);
  length.begin_chain();
  ASSERT_TRUE(length.is_too_coarse(1.0, 1e9));
  length.shorten_behind(1.0);
  EXPECT_NEAR(length.end_of_part(0.0, 2.0, 0.0), 0.2, 1e-12) << "not below a tenth at once";
  length.begin_chain();
  ASSERT_FALSE(length.is_too_coarse(0.1, 0.4));
  length.lengthen_behind(0.1);  // 0.8 / 0.4 = 2 times
  EXPECT_NEAR(length.end_of_part(0.0, 2.0, 0.0), 0.4, 1e-12);
}

TEST(PartLength, IgnoresErrorsWhereTheyAreNotLimited) {
  PartLength length({2.0, 2, 2, PartLength::Shape::Errors::ignored});
  length.begin_chain();
  static_cast<void>(length.is_too_coarse(1.0, 100.0));
  length.shorten_behind(1.0);
  EXPECT_EQ(length.end_of_part(0.0, 2.0, 0.0), 2.0);
}

/// Feeds v(h) until the secant has found or lost its zero; nullopt if it has lost it.
template <class Value>
std::optional<double> zero_of(SafeguardedSecant secant, Value&& value, double noise, int& evaluations) {
  for (evaluations = 1;; ++evaluations) {
    switch (secant.take(value(secant.h()), noise)) {
      case SafeguardedSecant::State::found:
        return secant.h();
      case SafeguardedSecant::State::none:
        return std::nullopt;
      case SafeguardedSecant::State::searching:
        break;
    }
  }
}

TEST(SafeguardedSecant, FindsZerosWhereverItStarts) {
  int evaluations = 0;
  for (const double start : {0.01, 0.5, 1.9}) {
    for (const double slope : {-1.0, -1e-3, 1.0}) {
      const auto h = zero_of(
          SafeguardedSecant({start, slope, 4.0, 0.0, 1}), [](double at) { return 2.0 - at * at; }, 1e-15, evaluations);
      ASSERT_TRUE(h.has_value()) << start << ' ' << slope;
      EXPECT_NEAR(*h, std::sqrt(2.0), 4e-16 * 4.0) << start << ' ' << slope;
      EXPECT_LE(evaluations, 20) << start << ' ' << slope;
    }
  }
}

TEST(SafeguardedSecant, PolishesWhatIsWithinItsNoise) {
  // The value is 1e-6 (1 - h), its noise 1e-8: that alone is a hundredth of h.
  int evaluations = 0;
  const auto h = zero_of(
      SafeguardedSecant({0.995, -2e-6, 4.0, 0.0, 1}), [](double at) { return 1e-6 * (1.0 - at); }, 1e-7, evaluations);
  ASSERT_TRUE(h.has_value());
  EXPECT_NEAR(*h, 1.0, 1e-15);
}

TEST(SafeguardedSecant, SaysWhereThereIsNoZero) {
  int evaluations = 0;
  EXPECT_FALSE(zero_of(
      SafeguardedSecant({0.5, -1.0, 2.0, 0.0, 1}), [](double) { return 1.0; }, 1e-15, evaluations));
  EXPECT_LE(evaluations, 4) << "0.5, 1, 2";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(zero_of(
      SafeguardedSecant({0.5, -1.0, 2.0, 0.0, 1}), [&](double) { return nan; }, 1.0, evaluations));
}

TEST(PartDivision, KeepsLengthsWithinTheirBounds) {
  // Four elements of a part of length 4, mean length 1.
  const PartDivision wide{4, 4.0, 1.0, 1.0}, narrow{4, 4.0, 1.0, 0.1};
  EXPECT_EQ(wide.elements_before(2.3, 2), 2);
  EXPECT_EQ(narrow.elements_before(2.1, 3), 2) << "2.1 / 2 and 1.9 / 2";
  EXPECT_EQ(narrow.elements_before(2.5, 2), std::nullopt);
}

TEST(DecisionCount, CountsThoseAtOneTime) {
  DecisionCount count;
  for (int k = 1; k <= 20; ++k) {
    EXPECT_TRUE(count.add(1.0)) << k;
    EXPECT_EQ(count.asks_for_shorter_elements(), k > 4) << k;
  }
  EXPECT_FALSE(count.add(1.0));
  EXPECT_TRUE(count.add(1.5));
  EXPECT_FALSE(count.asks_for_shorter_elements());
  count.leave_open();
  EXPECT_TRUE(count.take_open());
  EXPECT_FALSE(count.take_open());
}

TEST(RunStatus, KeepsTheFirstReasonAndCounts) {
  IntegrationOptions options;
  options.max_steps = 3;
  int seen = 0;
  const StepObserver observer = [&](const Progress&) {
    ++seen;
    return Continue::yes;
  };
  RunStatus status(options, observer);
  EXPECT_TRUE(status.count_step(0.1));
  status.count_rejected(0.1, 0);
  EXPECT_EQ(seen, 1);
  status.remark("first");
  status.remark("second");
  EXPECT_EQ(status.at_end(0.5).termination, result::Termination::completed);
  EXPECT_EQ(status.at_end(0.5).message, "first");
  EXPECT_FALSE(status.count_step(0.2));
  status.stop(0.3, result::Termination::not_converged, "later");
  EXPECT_EQ(status.at_end(0.2).termination, result::Termination::iteration_limit);
  EXPECT_EQ(status.statistics().steps, 2);
  EXPECT_EQ(status.statistics().rejected, 1);
}

TEST(RestProjection, GoesOntoTheSurfaceTheShortestWay) {
  // x' = y - ..., psi = x^2 + y^2 - 2 from (1.1, 1.1): the nearest point is (1, 1).
  model::Builder builder("circle");
  const casadi::SX x = builder.state("x", {1.0}), y = builder.state("y", {1.0});
  builder.dynamics("x", -builder.sign(x * x + y * y - 2.0) * x);
  builder.dynamics("y", casadi::SX(1.0));
  const Compiled circle(builder);
  RestProjection projection(circle.kernel);
  const ActiveSet set = circle.set({0});
  std::vector<double> point{1.1, 1.1};
  ASSERT_TRUE(projection.onto_surfaces(set, {0.0, nullptr, 1.0, {0.5}}, point));
  EXPECT_NEAR(point[0], 1.0, 1e-14);
  EXPECT_NEAR(point[1], 1.0, 1e-14);
}

TEST(RestProjection, GoesToRestOnSurfacesThatNoSelectionMovesAtOnce) {
  // x' = v, v' = -sign(x): psi = x is moved by v alone, so that rest is at v = 0.
  model::Builder builder("twice");
  const casadi::SX x = builder.state("x", {1.0}), v = builder.state("v", {0.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -builder.sign(x));
  const Compiled twice(builder);
  RestProjection projection(twice.kernel);
  const ActiveSet set = twice.set({0});
  std::vector<double> point{1e-6, 1e-4};
  ASSERT_TRUE(projection.to_rest(set, {0.0, nullptr, 1.0, {0.5}}, 1e-3, point));
  EXPECT_NEAR(point[0], 0.0, 1e-14);
  EXPECT_NEAR(point[1], 0.0, 1e-10);
  std::vector<double> far{0.0, 1e-2};
  EXPECT_FALSE(projection.to_rest(set, {0.0, nullptr, 1.0, {0.5}}, 1e-3, far));
}

}  // namespace
}  // namespace saltus::fesd_integrator
