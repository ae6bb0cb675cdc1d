// Elements that are too long: switches between their ends, estimates of their error; and spirals, beyond any length.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using discretization::TableauFamily;
using reformulation::Form;

struct Settings {
  long steps = 100;
  Form form = Form::step;
  TableauFamily family = TableauFamily::radau_iia;
  int stages = 2;
  int elements = 2;
  double step_bounds = 1.0;
  std::optional<double> error_limit{};
};

Integration run(const model::System& system, double until, const Settings& settings) {
  const auto dcs = reformulation::reformulate(system, {settings.form, std::nullopt});
  EXPECT_TRUE(dcs.has_value());
  IntegrationOptions options;
  options.tableau = *discretization::butcher_tableau(settings.family, settings.stages);
  options.until = until;
  options.steps = settings.steps;
  options.elements = settings.elements;
  options.step_bounds = settings.step_bounds;
  options.error_limit = settings.error_limit;
  auto integration = integrate(system, *dcs, options);
  EXPECT_TRUE(integration.has_value());
  EXPECT_EQ(integration->status.termination, result::Termination::completed) << integration->status.message;
  return std::move(*integration);
}

/// sin t, whose top is above `level` for a moment; nothing changes in the field but there.
model::System top(double level) {
  model::Builder builder("top");
  const SX x = builder.state("x", {0.0});
  const SX v = builder.state("v", {1.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -x + 0.1 * builder.step(x - level));
  return *builder.build();
}

TEST(Coarse, ATopBetweenTheEndsOfAnElementIsSeen) {
  for (const double level : {0.95, 0.97, 0.99}) {
    const auto integration = run(top(level), 6.0, {.steps = 6});
    ASSERT_EQ(integration.events.size(), 2u) << level;
    EXPECT_GE(integration.statistics.rejected, 1) << level;  // a step has been halved for it
    EXPECT_NEAR(integration.events[0].t, std::asin(level), 0.05) << level;
  }
}

TEST(Coarse, FineElementsAreNotDividedToLook) {
  for (const double level : {0.5, 0.95, 1.5}) {
    const auto integration = run(top(level), 6.0, {.steps = 100});
    EXPECT_EQ(integration.events.size(), level < 1.0 ? 2u : 0u) << level;
    EXPECT_EQ(integration.statistics.rejected, 0) << level;
  }
}

/// sin 20 t with a selection that is never asked for.
model::System fast() {
  model::Builder builder("fast");
  const SX x = builder.state("x", {0.0});
  const SX v = builder.state("v", {20.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -400.0 * x + builder.step(x - 50.0));
  return *builder.build();
}

TEST(Coarse, ErrorsOfElementsAreEstimatedAndTold) {
  const auto coarse = run(fast(), 2.0, {.steps = 20});
  EXPECT_GT(*coarse.statistics.error_estimate, 0.03);
  EXPECT_NE(coarse.status.message.find("coarse"), std::string::npos) << coarse.status.message;
  const auto fine = run(fast(), 2.0, {.steps = 400});
  EXPECT_LT(*fine.statistics.error_estimate, 0.03);
  EXPECT_EQ(fine.status.message, "");
}

/// x = t, and 50 zeros of an event in two steps, which the polynomial of one element cannot follow.
TEST(Coarse, FastEventsAreFoundInLongElements) {
  model::Builder builder("clock");
  const SX x = builder.state("x", {0.0});
  builder.dynamics("x", 1.0);
  builder.event(sin(40.0 * x));
  const auto integration = run(*builder.build(), 4.0, {.steps = 2});
  const double half_turn = std::acos(-1.0) / 40.0;
  ASSERT_EQ(integration.events.size(), 50u);  // the zero at the start is none
  for (std::size_t k = 0; k < integration.events.size(); ++k) {
    EXPECT_NEAR(integration.events[k].t, static_cast<double>(k + 1) * half_turn, 1e-14 * 40.0) << k;
  }
}

/// Two functions with one zero, and one that is 0 from a switch on.
TEST(Coarse, EventsThatCoincideFireOnce) {
  model::Builder builder("sticks");
  const SX x = builder.state("x", {-0.393});
  const SX v = builder.state("v", {0.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -x - 0.2 * builder.sign(v));  // v = 0.193 sin t up to pi, then 0
  builder.event(v);
  builder.event(model::greater(v, 0.0));
  builder.event(x + 0.2);  // at pi / 2, like the next one
  builder.event(sin(4.0 * builder.time()) + builder.time() * (x + 0.2));
  const auto integration = run(*builder.build(), 5.0, {.steps = 200});
  const double pi = std::acos(-1.0);
  std::vector<std::pair<std::string, double>> events;
  for (const auto& event : integration.events) {
    if (event.kind == result::EventKind::user) events.emplace_back(event.name.value_or(""), event.t);
  }
  const auto count = [&](const std::string& name, double t) {
    return std::count_if(events.begin(), events.end(),
                         [&](const auto& event) { return event.first == name && std::abs(event.second - t) < 1e-6; });
  };
  EXPECT_EQ(count("event1", pi), 1);
  EXPECT_EQ(count("event2", pi), 1);
  EXPECT_EQ(count("event3", pi / 2), 1);
  EXPECT_EQ(count("event4", pi / 2), 1);
  const auto number = [&](const std::string& name) {
    return std::count_if(events.begin(), events.end(), [&](const auto& event) { return event.first == name; });
  };
  EXPECT_EQ(number("event1"), 1);
  EXPECT_EQ(number("event2"), 1);
  EXPECT_EQ(number("event3"), 1);
}

/// Steps that are divided again and again must end, and can be stopped by hand until then.
TEST(Coarse, DividedStepsCountAndAreShown) {
  const auto system = fast();
  const auto dcs = reformulation::reformulate(system, {Form::step, std::nullopt});
  ASSERT_TRUE(dcs.has_value());
  IntegrationOptions options;
  options.tableau = *discretization::butcher_tableau(TableauFamily::radau_iia, 2);
  options.until = 10.0;
  options.steps = 1;
  options.error_limit = 1e-6;
  options.max_steps = 3;  // the one step is divided more often before its first part is short enough
  int asked = 0;
  const auto count = [&](const Progress& progress) {
    ++asked;
    EXPECT_EQ(progress.t, 0.0);
    return Continue::yes;
  };
  const auto limited = integrate(system, *dcs, options, count);
  ASSERT_TRUE(limited.has_value());
  EXPECT_EQ(limited->status.termination, result::Termination::iteration_limit);
  EXPECT_EQ(limited->statistics.rejected, options.max_steps);
  EXPECT_EQ(limited->statistics.steps, 0);
  EXPECT_EQ(asked, options.max_steps - 1);
  const auto refuse = [](const Progress&) { return Continue::no; };
  const auto stopped = integrate(system, *dcs, options, refuse);
  ASSERT_TRUE(stopped.has_value());
  EXPECT_EQ(stopped->status.termination, result::Termination::stopped_by_user);
  EXPECT_EQ(stopped->statistics.rejected, 1);
}

/// 31 oscillations in 8 steps: every method with two stages and more is brought below the limit.
TEST(Coarse, StepsAreDividedUntilErrorsAddUpToTheLimit) {
  for (const auto& [family, stages] :
       {std::pair{TableauFamily::radau_iia, 2}, std::pair{TableauFamily::gauss_legendre, 3},
        std::pair{TableauFamily::lobatto_iiic, 3}, std::pair{TableauFamily::explicit_rk, 4}}) {
    for (const double limit : {0.03, 3e-3}) {
      const auto integration =
          run(fast(), 10.0, {.steps = 8, .family = family, .stages = stages, .error_limit = limit});
      EXPECT_LE(*integration.statistics.error_estimate, limit) << discretization::name(family);
      EXPECT_EQ(integration.status.message, "") << discretization::name(family);
      EXPECT_GT(integration.statistics.rejected, 0) << discretization::name(family);
      // Nothing damps or amplifies what elements are off.
      EXPECT_NEAR(integration.final.x[0], std::sin(200.0), limit) << discretization::name(family);
    }
  }
}

TEST(Coarse, ResolvedStepsAreNotDivided) {
  const auto without = run(fast(), 2.0, {.steps = 2000});
  const auto with = run(fast(), 2.0, {.steps = 2000, .error_limit = 0.03});
  EXPECT_EQ(with.trajectory.x, without.trajectory.x);
  EXPECT_EQ(with.statistics.rejected, 0);
}

/// Sliding on x = sin(t) / 2 and y = 0 from t = 0 on; z depends on the weight that Stewart's form leaves free.
TEST(Coarse, SolutionsThatAreOneOfManyAreToldAndNotDivided) {
  model::Builder builder("free weight");
  const SX x = builder.state("x", {0.0});
  const SX y = builder.state("y", {0.0});
  const SX z = builder.state("z", {0.0});
  const SX a = builder.sign(x - 0.5 * sin(builder.time())), b = builder.sign(y);
  builder.dynamics("x", -1.5 * a + 0.4 * a * b);
  builder.dynamics("y", -2.0 * b + 0.7 * a);
  builder.dynamics("z", a * b - z);
  const auto system = *builder.build();
  const auto step = run(system, 4.0, {.error_limit = 0.03});
  EXPECT_EQ(step.status.message, "");
  EXPECT_EQ(step.events.front().unique, true);
  const auto stewart = run(system, 4.0, {.form = Form::stewart, .error_limit = 0.03});
  EXPECT_NE(stewart.status.message.find("one of many"), std::string::npos) << stewart.status.message;
  EXPECT_EQ(stewart.events.front().unique, false);
  EXPECT_EQ(stewart.statistics.steps, 200U);
}

/// A field without a derivative at x = 0, where its elements have an error that no length makes small.
TEST(Coarse, PartsOfStepsHaveAShortestLength) {
  model::Builder builder("root");
  const SX x = builder.state("x", {1.0});
  builder.dynamics("x", -casadi::SX::pow(x * x, 0.35) + 0.0 * builder.step(x - 5.0));
  const auto integration = run(*builder.build(), 3.0, {.steps = 10, .error_limit = 1e-9});
  EXPECT_LT(integration.statistics.steps, 40000);
}

/// x' = 2 - sign x from x0 < 0: a crossing at t = -x0 / 3.
TEST(StepBounds, LengthsAreWithinThemOrTheStepIsDividedAtTheSwitch) {
  constexpr double gamma = 0.3, mean = 0.05;
  constexpr int elements = 4;
  int divided = 0, kept = 0;
  for (int k = 1; k < 20; ++k) {
    const double crossing = 0.2 + 0.01 * k + 1e-3;
    model::Builder builder("crossing");
    const SX x = builder.state("x", {-3.0 * crossing});
    builder.dynamics("x", 2.0 - builder.sign(x));
    const auto integration =
        run(*builder.build(), 1.0, {.steps = 5, .elements = elements, .step_bounds = gamma, .error_limit = {}});
    std::vector<double> before, behind;  // lengths in the step with the crossing
    for (std::size_t i = 1; i < integration.trajectory.t.size(); ++i) {
      const double t = integration.trajectory.t[i - 1], h = integration.trajectory.t[i] - t;
      if (h <= 0.0 || t < 0.2 - 1e-9 || t > 0.4 - 1e-9) continue;
      (t < crossing - 1e-9 ? before : behind).push_back(h);
    }
    ASSERT_FALSE(before.empty());
    ASSERT_FALSE(behind.empty());
    for (const auto* part : {&before, &behind}) {
      for (const double h : *part) EXPECT_NEAR(h, part->front(), 1e-12) << k;
    }
    if (integration.statistics.rejected > 0) {
      ++divided;
      EXPECT_EQ(before.size(), 4u) << k;
      EXPECT_EQ(behind.size(), 4u) << k;
      // No other number of elements would have done.
      for (int n = 1; n < elements; ++n) {
        const double h = (crossing - 0.2) / n, other = (0.4 - crossing) / (elements - n);
        EXPECT_TRUE(std::max(h, other) > (1.0 + gamma) * mean || std::min(h, other) < (1.0 - gamma) * mean) << k;
      }
    } else {
      ++kept;
      EXPECT_EQ(before.size() + behind.size(), 4u) << k;
      for (const double h : {before.front(), behind.front()}) {
        EXPECT_GE(h, (1.0 - gamma) * mean - 1e-9) << k;
        EXPECT_LE(h, (1.0 + gamma) * mean + 1e-9) << k;
      }
    }
  }
  EXPECT_GE(divided, 4);
  EXPECT_GE(kept, 4);
}

/// The estimate is that inside elements: of order n_s + 1 per element, n_s of their sum. Radau IIA has n_s = 2 here,
/// Gauss 3; Lobatto IIIA, whose defect is looked at inside, 3.
TEST(Coarse, TheEstimateFallsWithTheStageOrder) {
  for (const auto& [family, stages] :
       {std::pair{TableauFamily::radau_iia, 2}, std::pair{TableauFamily::gauss_legendre, 3},
        std::pair{TableauFamily::lobatto_iiia, 3}}) {
    const Settings once{.steps = 200, .family = family, .stages = stages};
    const Settings twice{.steps = 400, .family = family, .stages = stages};
    const double ratio =
        *run(fast(), 2.0, once).statistics.error_estimate / *run(fast(), 2.0, twice).statistics.error_estimate;
    EXPECT_NEAR(std::log2(ratio), stages, 0.2) << discretization::name(family);
  }
}

/// x'' = -10 sign x - 3 sign x'. From x = x' = 10 it is at the top X = 10 + 100/26 at t = 10/13. From there to the next
/// top, on the other side, X shrinks by 7/13 in a time of sqrt(X) (sqrt(2/7) + sqrt(14)/13).
model::System twisting() {
  model::Builder builder("twisting");
  const SX x = builder.state("x", {10.0});
  const SX v = builder.state("v", {10.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -10.0 * builder.sign(x) - 3.0 * builder.sign(v));
  return *builder.build();
}

TEST(Accumulation, TwistingComesToRest) {
  const double top = 10.0 + 100.0 / 26.0;
  const double exact =
      10.0 / 13.0 + std::sqrt(top) * (std::sqrt(2.0 / 7.0) + std::sqrt(14.0) / 13.0) / (1.0 - std::sqrt(7.0 / 13.0));
  for (const auto form : {Form::step, Form::stewart}) {
    for (const long steps : {10L, 100L}) {
      const auto integration = run(twisting(), 15.0, {.steps = steps, .form = form});
      const auto& last = integration.events.back();
      EXPECT_EQ(last.kind, result::EventKind::accumulation);
      // The field is constant between switches: the method is exact. Cycles of 1e-8 are extrapolated to 2e-10.
      EXPECT_NEAR(last.t, exact, 1e-9);
      EXPECT_EQ(std::set(last.surfaces.begin(), last.surfaces.end()), (std::set<std::string>{"v", "x"}));
      EXPECT_EQ(*last.mode_after, (result::Mode{0, 0}));
      EXPECT_EQ(last.unique, true);
      EXPECT_EQ(integration.final.t, 15.0);
      EXPECT_NEAR(integration.final.x[0], 0.0, 1e-12);
      EXPECT_NEAR(integration.final.x[1], 0.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
