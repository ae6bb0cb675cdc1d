// Every model of the catalogue against its reference: event times, kinds, surfaces, modes, end state.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "agreement/reference_checks.hpp"
#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;

/// Selections that are not determined are equal to each other, too.
std::vector<double> comparable(const std::optional<std::vector<double>>& alpha) {
  std::vector<double> values = alpha.value_or(std::vector<double>{});
  std::replace_if(
      values.begin(), values.end(), [](double value) { return std::isnan(value); }, -1.0);
  return values;
}

void expect_identical(const Result& a, const Result& b) {
  ASSERT_EQ(a.status.termination, result::Termination::completed) << a.status.message;
  ASSERT_EQ(b.status.termination, result::Termination::completed) << b.status.message;
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    const Event &left = a.events[i], &right = b.events[i];
    EXPECT_EQ(left.t, right.t) << "event " << i + 1;
    EXPECT_EQ(left.kind, right.kind) << "event " << i + 1;
    EXPECT_EQ(left.mode_after, right.mode_after) << "event " << i + 1;
    EXPECT_EQ(comparable(left.alpha_after), comparable(right.alpha_after)) << "event " << i + 1;
    EXPECT_EQ(left.regions_after, right.regions_after) << "event " << i + 1;
    EXPECT_EQ(left.x, right.x) << "event " << i + 1;
    EXPECT_EQ(left.x_after, right.x_after) << "event " << i + 1;
  }
  EXPECT_EQ(a.final.t, b.final.t);
  EXPECT_EQ(a.final.x, b.final.x);
  EXPECT_EQ(a.final.mode, b.final.mode);
  EXPECT_EQ(comparable(a.final.alpha), comparable(b.final.alpha));
  EXPECT_EQ(a.final.theta, b.final.theta);
}

/// Models that only radau5 gets through: their file asks for it. Whether they earn it is a test of its own.
const std::set<std::string> stiff_models{"smoothed-pss"};

bool is_stiff(const ReferenceProblem& problem) { return stiff_models.contains(problem.model); }

/// The settings every model is run with.
std::vector<Accuracy> accuracies(const ReferenceProblem& problem) {
  return is_stiff(problem) ? std::vector{implicit} : std::vector{standard, fine, implicit, series};
}

/// The last event of each time, where what is within some roundings is one time.
std::vector<Event> instants_of(const Result& result) {
  constexpr double roundings = 1e-13;
  std::vector<Event> instants;
  for (const Event& event : result.events) {
    const bool is_later = instants.empty() || event.t - instants.back().t > roundings * std::max(1.0, event.t);
    if (!is_later) instants.pop_back();
    instants.push_back(event);
  }
  return instants;
}

class Catalogue : public testing::TestWithParam<ReferenceProblem> {};

TEST_P(Catalogue, AgreesToNineDigits) {
  const Simulator model = Simulator::from_reference(GetParam());
  ASSERT_GE(GetParam().digits, 14);
  const Accuracy implicit_and_fine{pipeline::Integrator::radau5, 1e-11, 1e-13};
  const Accuracy& accuracy = is_stiff(GetParam()) ? implicit_and_fine : fine;  // fine is dop853
  expect_reference(model.run(with(model.options(), accuracy)), GetParam(), 1e-9);
}

TEST_P(Catalogue, AgreesToSixDigitsWithDefaults) {
  const Simulator model = Simulator::from_reference(GetParam());
  EXPECT_EQ(model.options().rtol, standard.rtol);
  const auto expected = is_stiff(GetParam()) ? implicit.integrator : pipeline::Integrator::automatic;
  EXPECT_EQ(model.options().event.integrator, expected);
  expect_reference(model.run(model.options()), GetParam(), 1e-6);
}

TEST_P(Catalogue, AgreesToSixDigitsWithRadau5) {
  const Simulator model = Simulator::from_reference(GetParam());
  expect_reference(model.run(with(model.options(), implicit)), GetParam(), 1e-6);
}

// The choice begins with series, or dop853, at this tolerance; with stiff models it has to leave them.
TEST_P(Catalogue, AgreesByItsOwnChoice) {
  const Simulator model = Simulator::from_reference(GetParam());
  const auto automatic = pipeline::Integrator::automatic;
  expect_reference(model.run(with(model.options(), {automatic, fine.rtol, fine.atol})), GetParam(), 1e-9);
}

TEST_P(Catalogue, TheChoiceHasTheBitsOfItsExplicitMethod) {
  if (is_stiff(GetParam())) return;
  const Simulator model = Simulator::from_reference(GetParam());
  using enum pipeline::Integrator;
  for (const auto& [rtol, integrator] : {std::pair{1e-4, dopri5}, std::pair{1e-6, dopri5}, std::pair{1e-8, taylor}}) {
    const Result chosen = model.run(with(model.options(), {automatic, rtol, 1e-2 * rtol}));
    const Result named = model.run(with(model.options(), {integrator, rtol, 1e-2 * rtol}));
    expect_identical(chosen, named);
    EXPECT_EQ(chosen.statistics.steps, named.statistics.steps);
    EXPECT_EQ(chosen.statistics.rhs_evaluations, named.statistics.rhs_evaluations);
  }
}

// Two events that a rounding separates are one instant: both belts of two-belts, by radau13.
TEST_P(Catalogue, TheChoiceAgreesWithEveryIntegratorThatIsNamed) {
  using enum pipeline::Integrator;
  constexpr double rtol = 1e-10, bound = 100.0 * rtol;
  const Simulator model = Simulator::from_reference(GetParam());
  const Result chosen = model.run(with(model.options(), {automatic, rtol, 1e-2 * rtol}));
  ASSERT_EQ(chosen.status.termination, result::Termination::completed) << chosen.status.message;
  const auto expected = instants_of(chosen);
  for (const auto integrator : {dopri5, dop853, taylor, radau5, radau9, radau13}) {
    if (is_stiff(GetParam()) && (integrator == dopri5 || integrator == dop853 || integrator == taylor)) continue;
    SCOPED_TRACE(ode::name(pipeline::named_method(integrator)));
    const Result named = model.run(with(model.options(), {integrator, rtol, 1e-2 * rtol}));
    ASSERT_EQ(named.status.termination, result::Termination::completed) << named.status.message;
    const auto found = instants_of(named);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::string what = "instant " + std::to_string(i + 1);
      EXPECT_EQ(found[i].mode_after, expected[i].mode_after) << what;
      EXPECT_EQ(found[i].regions_after, expected[i].regions_after) << what;
      expect_near(found[i].t, expected[i].t, bound, what);
      expect_near(found[i].x_after, expected[i].x_after, bound, what);
    }
    EXPECT_EQ(named.final.mode, chosen.final.mode);
    expect_near(named.final.x, chosen.final.x, bound, "end state");
  }
}

TEST_P(Catalogue, AgreesWithTaylor) {
  if (is_stiff(GetParam())) return;  // no model for an explicit method
  const Simulator model = Simulator::from_reference(GetParam());
  expect_reference(model.run(with(model.options(), series)), GetParam(), 1e-6);
  expect_reference(model.run(with(model.options(), {series.integrator, fine.rtol, fine.atol})), GetParam(), 1e-9);
}

TEST_P(Catalogue, AgreesToEightDigitsWithRadau5) {
  const Simulator model = Simulator::from_reference(GetParam());
  const Accuracy accuracy{pipeline::Integrator::radau5, 1e-9, 1e-11};
  expect_reference(model.run(with(model.options(), accuracy)), GetParam(), 1e-8);
}

TEST_P(Catalogue, OutputGridChangesNothing) {
  const Simulator model = Simulator::from_reference(GetParam());
  for (const Accuracy& accuracy : accuracies(GetParam())) {
    pipeline::SimulateOptions options = with(model.options(), accuracy);
    options.output = pipeline::EveryStep{};
    const Result every_step = model.run(options);
    const double until = GetParam().until;
    for (const pipeline::OutputGrid& grid :
         {pipeline::OutputGrid{pipeline::Automatic{}}, pipeline::OutputGrid{pipeline::NumberOfPoints{2}},
          pipeline::OutputGrid{pipeline::NumberOfPoints{1237}},
          pipeline::OutputGrid{pipeline::EveryInterval{until / 77.3}},
          pipeline::OutputGrid{pipeline::AtTimes{{0.1 * until, 0.1 * until + 1e-9, until}}}}) {
      options.output = grid;
      expect_identical(model.run(options), every_step);
    }
  }
}

TEST_P(Catalogue, ScalingPsiByAPowerOfTwoChangesNothing) {
  const Simulator model = Simulator::from_reference(GetParam());
  for (const double factor : {0x1p26, 0x1p-26}) {
    const Simulator scaled = Simulator::from_reference(GetParam(), {.name = "scaled", .psi_factor = factor});
    for (const Accuracy& accuracy : accuracies(GetParam())) {
      expect_identical(scaled.run(with(scaled.options(), accuracy)), model.run(with(model.options(), accuracy)));
    }
  }
}

TEST_P(Catalogue, ScalingPsiByOtherFactorsStaysWithinTenTolerances) {
  const Simulator model = Simulator::from_reference(GetParam());
  const Result unscaled = model.run(model.options());
  const double tolerance = 10 * (model.options().rtol + model.options().atol);
  for (const double factor : {1e8, 1e-8}) {
    const Simulator scaled = Simulator::from_reference(GetParam(), {.name = "scaled", .psi_factor = factor});
    const Result result = scaled.run(scaled.options());
    ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), unscaled.events.size());
    for (std::size_t i = 0; i < result.events.size(); ++i) {
      EXPECT_EQ(result.events[i].kind, unscaled.events[i].kind) << "event " << i + 1;
      EXPECT_EQ(result.events[i].mode_after, unscaled.events[i].mode_after) << "event " << i + 1;
      expect_near(result.events[i].t, unscaled.events[i].t, tolerance, "event " + std::to_string(i + 1));
    }
    expect_near(result.final.x, unscaled.final.x, tolerance, "end state");
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Catalogue, testing::ValuesIn(references()),
                         [](const auto& instance) { return test_name(instance.param); });

// In the geometric mean over the catalogue the choice takes no more evaluations than either pair, at any tolerance.
TEST(CatalogueFiles, TheChoiceTakesNoMoreEvaluationsThanEitherPair) {
  using enum pipeline::Integrator;
  for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-10}) {
    double of_dopri5 = 0.0, of_dop853 = 0.0;  // logarithms, summed
    for (const ReferenceProblem& problem : references()) {
      if (is_stiff(problem)) continue;
      const Simulator model = Simulator::from_reference(problem);
      const auto evaluations = [&](pipeline::Integrator integrator) {
        const Result result = model.run(with(model.options(), {integrator, rtol, 1e-2 * rtol}));
        return std::log(static_cast<double>(std::max<std::int64_t>(1, result.statistics.rhs_evaluations)));
      };
      const double chosen = evaluations(automatic);
      of_dopri5 += chosen - evaluations(dopri5);
      of_dop853 += chosen - evaluations(dop853);
    }
    EXPECT_LE(of_dopri5, 0.0) << rtol;
    EXPECT_LE(of_dop853, 0.0) << rtol;
  }
}

TEST(CatalogueFiles, StiffModelsEarnTheirMark) {
  for (const std::string& name : stiff_models) {
    const Simulator model = Simulator::from_catalogue(name);
    const Result with_radau5 = model.run(model.options());
    ASSERT_EQ(with_radau5.status.termination, result::Termination::completed) << name;
    pipeline::SimulateOptions explicit_run = with(model.options(), standard);
    explicit_run.max_steps = 100 * with_radau5.statistics.steps;
    EXPECT_EQ(model.run(explicit_run).status.termination, result::Termination::iteration_limit) << name;
  }
}

TEST(CatalogueFiles, EveryModelHasAReference) {
  std::set<std::string> referenced;
  for (const ReferenceProblem& problem : references()) referenced.insert(problem.model);
  const std::vector<std::string> shipped = catalogue();
  EXPECT_EQ(std::set<std::string>(shipped.begin(), shipped.end()), referenced);
  EXPECT_GE(shipped.size(), 15u);
}

TEST(CatalogueFiles, NameIsTheFileNameAndEveryModelRunsAsItIs) {
  for (const std::string& name : catalogue()) {
    const Simulator model = Simulator::from_catalogue(name);
    ASSERT_TRUE(model.options().until.has_value()) << name;
    const Result result = model.run(model.options());
    EXPECT_EQ(result.model.name, name);
    EXPECT_FALSE(result.model.description.empty()) << name;
    EXPECT_EQ(result.model.description.find('\n'), std::string::npos) << name;
    EXPECT_EQ(result.final.t, *model.options().until) << name;
  }
}

}  // namespace
}  // namespace saltus::problems
