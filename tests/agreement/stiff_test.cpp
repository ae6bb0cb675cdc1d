// Stiff models with switches and sliding: radau5 takes steps of the solution's own scale, the explicit methods say that
// they cannot.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::Integrator;
using result::Result;
using result::Termination;

/// Robertson's reactions, the first of them faster while the intermediate is above a threshold.
constexpr const char* robertson = R"toml([model]
name = "robertson-with-switch"
[states]
x1 = 1
x2 = 0
x3 = 0
[switching]
level = "x2 - 3e-5"
[definitions]
k1 = "if(level > 0, 0.05, 0.04)"
[dynamics]
x1 = "-k1*x1 + 1e4*x2*x3"
x2 = "k1*x1 - 1e4*x2*x3 - 3e7*x2^2"
x3 = "3e7*x2^2"
[simulate]
until = 40
)toml";

/// Dry friction, driven by a sensor that follows cos t with the rate 1e6. It starts on its smooth solution.
constexpr const char* sensor = R"toml([model]
name = "fast-sensor"
[parameters]
rate = 1e6
[states]
z = "rate^2/(rate^2 + 1)"
v = 0
[dynamics]
z = "-rate*(z - cos(t))"
v = "1.5*z - sign(v)"
[simulate]
until = 3
)toml";

constexpr double sensor_rate = 1e6;
double sensor_value(double t) {
  return (sensor_rate * sensor_rate * std::cos(t) + sensor_rate * std::sin(t)) / (sensor_rate * sensor_rate + 1.0);
}
double sensor_integral(double t) {
  return (sensor_rate * sensor_rate * std::sin(t) + sensor_rate * (1.0 - std::cos(t))) /
         (sensor_rate * sensor_rate + 1.0);
}

template <class Function>
double zero(Function&& function, double lower, double upper) {
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (lower + upper);
    (function(middle) > 0.0 ? lower : upper) = middle;
  }
  return lower;
}

TEST(Stiff, SwitchedRobertsonTakesAHundredthOfTheSteps) {
  const Simulator model = Simulator::from_text(robertson);
  const auto run = [&](Integrator integrator, double rtol) {
    Result result = model.run(with(model.options(), {integrator, rtol, 1e-6 * rtol}));
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(result.events.size(), 2u);
    return result;
  };
  const Result exact = run(Integrator::radau5, 1e-11);
  const Result implicit_run = run(Integrator::radau5, 1e-5);
  const Result explicit_run = run(Integrator::dopri5, 1e-5);
  EXPECT_GT(explicit_run.statistics.steps, 100 * implicit_run.statistics.steps);
  for (const Result* result : {&implicit_run, &explicit_run}) {
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(result->events[i].t, exact.events[i].t, 1e-4 * exact.events[i].t) << i;
    }
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(result->final.x[i], exact.final.x[i], 1e-5 * exact.final.x[i]) << i;
  }
  EXPECT_NE(explicit_run.status.message.find("radau5"), std::string::npos) << explicit_run.status.message;
  EXPECT_EQ(implicit_run.status.message, "");
}

TEST(Stiff, SlidingOfAStiffModelBeginsAndEndsOnTime) {
  const Simulator model = Simulator::from_text(sensor);
  const double sticks = zero([](double t) { return 1.5 * sensor_integral(t) - t; }, 1.0, 2.0);
  const double slips = zero([](double t) { return 1.5 * sensor_value(t) + 1.0; }, 2.0, 3.0);
  const double end = 1.5 * (sensor_integral(3.0) - sensor_integral(slips)) + (3.0 - slips);
  const Result result = model.run(with(model.options(), {Integrator::radau5, 1e-9, 1e-11}));
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const auto events = switches_of(result);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].mode_after, std::vector<int>{0});
  EXPECT_EQ(events[1].mode_after, std::vector<int>{-1});
  EXPECT_NEAR(events[0].t, sticks, 1e-9);
  EXPECT_NEAR(events[1].t, slips, 1e-9);
  EXPECT_NEAR(result.final.x[1], end, 1e-9);
  EXPECT_EQ(events[1].x[1], 0.0);
  EXPECT_LT(result.statistics.steps, 3000);
}

/// Steps that a method has taken by itself.
long steps_of(const Result& result, std::string_view method) {
  for (const auto& use : result.statistics.integrators) {
    if (use.name == method) return static_cast<long>(use.steps);
  }
  return 0;
}

// The explicit method is left after some dozen steps, and what is stiff is met so again behind each switch. (At tight
// tolerances the test for stiffness sees less: Robertson's reactions at rtol = 1e-8 take 6400 explicit steps.)
TEST(Stiff, TheChoiceTakesImplicitSteps) {
  using Tolerances = std::vector<double>;
  for (const auto& [text, tolerances] :
       {std::pair{robertson, Tolerances{1e-5, 1e-6}}, std::pair{sensor, Tolerances{1e-5, 1e-8, 1e-10}}}) {
    const Simulator model = Simulator::from_text(text);
    const Result exact = model.run(with(model.options(), {Integrator::radau5, 1e-11, 1e-15}));
    for (const double rtol : tolerances) {
      const Result result = model.run(with(model.options(), {Integrator::automatic, rtol, 1e-4 * rtol}));
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      EXPECT_EQ(result.status.message, "");
      ASSERT_EQ(result.events.size(), exact.events.size());
      EXPECT_LT(result.statistics.steps, 1500) << rtol;
      EXPECT_LT(steps_of(result, "dopri5") + steps_of(result, "dop853") + steps_of(result, "taylor"), 500) << rtol;
      for (std::size_t i = 0; i < exact.events.size(); ++i)
        EXPECT_NEAR(result.events[i].t, exact.events[i].t, 100 * rtol * exact.events[i].t) << rtol;
      for (std::size_t i = 0; i < exact.final.x.size(); ++i)
        EXPECT_NEAR(result.final.x[i], exact.final.x[i], 100 * rtol * (0.01 + std::abs(exact.final.x[i]))) << rtol;
    }
  }
}

// Fast at first, slow from t = 1 on: explicit steps come back, and at the end nothing of them is implicit.
TEST(Stiff, TheChoiceComesBackWhereStiffnessEnds) {
  const Simulator model = Simulator::from_text(R"toml([model]
name = "stiff-for-a-while"
[states]
x = 0
y = 1
[dynamics]
x = "if(t < 1, 1e5, 1)*(cos(t) - x)"
y = "-y^3 + sin(3*t)"
[simulate]
until = 20
)toml");
  const Result exact = model.run(with(model.options(), {Integrator::radau9, 1e-12, 1e-14}));
  const Result result = model.run(with(model.options(), {Integrator::automatic, 1e-6, 1e-8}));
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(result.final.x[i], exact.final.x[i], 1e-5);
  double passed = 0.0, of_explicit = 0.0;
  std::int64_t steps = 0;
  for (const auto& use : result.statistics.integrators) {
    passed += use.time;
    steps += use.steps;
    if (!use.name.starts_with("radau")) of_explicit += use.time;
  }
  EXPECT_NEAR(passed, 20.0, 1e-10);
  EXPECT_EQ(steps, result.statistics.steps);
  EXPECT_GT(of_explicit, 12.0);
  EXPECT_LT(of_explicit, 19.5);
}

/// Followers of cos t with the rate 1e6, of which each sees its neighbour, beside a block that sticks. The root of what
/// does not change has no derivative: no difference of it is defined.
std::string without_jacobian(int followers) {
  std::string states, rates;
  for (int i = 0; i < followers; ++i) {
    states += fmt::format("x{} = 1\n", i);
    rates += fmt::format("x{} = \"-1e6*(x{} - cos(t)) + x{} - cos(t) + sqrt(c - 1) + sqrt(1 - c)\"\n", i, i,
                         std::max(0, i - 1));
  }
  return "[model]\nname = \"without-jacobian\"\n[states]\nc = 1\nv = 0\n" + states +
         "[switching]\nslip = \"v\"\n[dynamics]\nc = \"0\"\nv = \"0.5*x0 - sign(slip)\"\n" + rates +
         "[simulate]\nuntil = 0.002\n";
}

// Dense and sparse systems, in sliding: a named method says what it lacks, the choice goes on with explicit steps and
// says what it has tried.
TEST(Stiff, AModeWithoutAJacobianIsLeftToExplicitSteps) {
  for (const int followers : {1, 100}) {
    const Simulator model = Simulator::from_text(without_jacobian(followers));
    for (const auto& [integrator, name] :
         {std::pair{Integrator::radau5, "radau5"}, std::pair{Integrator::radau13, "radau13"}}) {
      const Result result = model.run(with(model.options(), {integrator, 1e-6, 1e-8}));
      EXPECT_EQ(result.status.termination, Termination::step_size_too_small);
      EXPECT_EQ(result.status.message.find(std::string(name) + " finds no stages"), 0u) << result.status.message;
      EXPECT_NE(result.status.message.find("derivative"), std::string::npos) << result.status.message;
    }
    for (const double rtol : {1e-6, 1e-10}) {
      const Result result = model.run(with(model.options(), {Integrator::automatic, rtol, 1e-2 * rtol}));
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      EXPECT_NE(result.status.message.find("radau5 was tried"), std::string::npos) << result.status.message;
      EXPECT_NE(result.status.message.find("derivative"), std::string::npos) << result.status.message;
      EXPECT_EQ(result.final.mode, std::vector<int>{0});
      EXPECT_EQ(result.final.x[1], 0.0);
      EXPECT_NEAR(result.final.x[2], std::cos(0.002), 1e-7);
      EXPECT_LT(result.statistics.rejected, result.statistics.steps);
    }
  }
}

TEST(Stiff, ExplicitMethodsPointToRadau5) {
  const Simulator model = Simulator::from_text(sensor);
  for (const Integrator integrator : {Integrator::dopri5, Integrator::dop853}) {
    auto options = with(model.options(), {integrator, 1e-6, 1e-8});
    options.max_steps = 1000;
    const Result result = model.run(options);
    EXPECT_EQ(result.status.termination, Termination::iteration_limit);
    EXPECT_NE(result.status.message.find("stiff"), std::string::npos) << result.status.message;
    EXPECT_NE(result.status.message.find("radau5"), std::string::npos) << result.status.message;
  }
}

/// No method may take longer steps.
constexpr auto at_rest = R"toml(
[model]
name = "at rest"
[states]
x = 1
[dynamics]
x = "10*(1 + 1e-8*sin(10*t) - x)"
[simulate]
until = 100
event.max_step = 0.1
)toml";

/// It empties below the tolerances.
constexpr auto tank = R"toml(
[model]
name = "tank"
[states]
h = 1
[dynamics]
h = "if(h > 0, -sqrt(abs(h)), 1)"
[simulate]
until = 3
)toml";

TEST(Stiff, NoFalseAlarmWhereThereIsLittleMotion) {
  for (const char* text : {at_rest, tank}) {
    const Simulator model = Simulator::from_text(text);
    for (const Integrator integrator : {Integrator::dopri5, Integrator::dop853}) {
      const Result result = model.run(with(model.options(), {integrator, 1e-8, 1e-10}));
      EXPECT_EQ(result.status.message, "");
    }
  }
}

TEST(Stiff, NoFalseAlarmInTheCatalogue) {
  for (const std::string& name : catalogue()) {
    const Simulator model = Simulator::from_catalogue(name);
    const Result result = model.run(model.options());
    EXPECT_EQ(result.status.message.find("stiff"), std::string::npos) << name << ": " << result.status.message;
  }
}

}  // namespace
}  // namespace saltus::problems
