// The second engine against the references of the catalogue: event times, kinds, surfaces, modes, end state. It shares
// nothing with the event engine but the model.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "agreement/reference_checks.hpp"
#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::Reformulation;

/// What finite elements with switch detection are not for, and why.
const std::map<std::string, std::string> beyond_the_method{
    {"filippov-spiral", "switches accumulate"},
    {"super-twisting", "switches accumulate, and a root has no derivative on the surface: below"},
    {"smoothed-pss", "stiff"},
    {"hopper", "contacts: compared in tests/golden/time_freezing_test.py"},
    {"painleve-rod", "contacts, with an impact at the start"},
    {"consensus", "of surfaces that depend on each other it names those whose selections are not at a bound: below"},
};

/// Events of models with jumps and with contacts, whose frozen time is compared in tests/golden/time_freezing_test.py.
const std::set<std::string> of_jumps{"jump", "impact", "contact", "lift_off", "stick", "slip"};

/// Where Stewart's form has other solutions, or none of a size that could be solved.
const std::map<std::string, std::string> not_in_stewart_form{
    {"two-belts", "four regions meet where both surfaces slide: the multipliers are not those of the step form"},
    {"quarter-car", "a product of the selections of forty surfaces"},
};

struct FesdCase {
  ReferenceProblem problem;
  Reformulation form;
};

void PrintTo(const FesdCase& c, std::ostream* out) { PrintTo(c.problem, out); }

/// References without jumps, whose solutions are unique, in both forms. No model is read here: this list is made at the
/// start of every test.
std::vector<FesdCase> fesd_cases() {
  std::vector<FesdCase> list;
  for (const ReferenceProblem& problem : references()) {
    const bool in_the_class =
        std::all_of(problem.events.begin(), problem.events.end(),
                    [](const ReferenceEvent& event) { return event.unique == true && !of_jumps.contains(event.kind); });
    if (!in_the_class || beyond_the_method.contains(problem.model)) continue;
    list.push_back({problem, Reformulation::step});
    if (!not_in_stewart_form.contains(problem.model)) list.push_back({problem, Reformulation::stewart});
  }
  return list;
}

class Fesd : public testing::TestWithParam<FesdCase> {};

TEST_P(Fesd, AgreesToEightDigits) {
  const Simulator model = Simulator::from_reference(GetParam().problem);
  pipeline::SimulateOptions options = model.options();
  options.method = pipeline::Method::fesd;
  options.fesd.stages = 5;
  options.fesd.steps = 800;
  options.fesd.reformulation = GetParam().form;
  expect_reference(model.run(options), GetParam().problem, 1e-8);
}

/// Six surfaces of which three are independent: the motion and the parting, whatever the selections.
TEST(FesdOnDependentSurfaces, PartsInTime) {
  const Simulator model = Simulator::from_catalogue("consensus");
  pipeline::SimulateOptions options = model.options();
  options.method = pipeline::Method::fesd;
  for (const auto form : {Reformulation::step, Reformulation::stewart}) {
    options.fesd.reformulation = form;
    const result::Result result = model.run(options);
    ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    EXPECT_NEAR(result.events.back().t, 8.0, 1e-9);
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
      EXPECT_NEAR(result.final.x[i], 6.75, 1e-8);
    }
    EXPECT_NEAR(result.final.x[3], 7.75, 1e-8);
  }
}

/// 100 steps of two stages: where these are too few, they are divided.
TEST_P(Fesd, DefaultsFindAllSwitches) {
  const Simulator model = Simulator::from_reference(GetParam().problem);
  pipeline::SimulateOptions options = model.options();
  options.method = pipeline::Method::fesd;
  options.fesd.reformulation = GetParam().form;
  const auto result = model.run(options);
  EXPECT_EQ(result.status.termination, result::Termination::completed);
  EXPECT_EQ(result.status.message, "");
  EXPECT_EQ(result.events.size(), GetParam().problem.events.size());
  // Above what is lost in the least accurate one, chua, which amplifies errors.
  for (std::size_t i = 0; i < result.final.x.size(); ++i) {
    double largest = 0.0;
    for (const auto& row : result.trajectory.x) largest = std::max(largest, std::abs(row[i]));
    EXPECT_NEAR(result.final.x[i], GetParam().problem.final_x[i], 0.02 * largest) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(References, Fesd, testing::ValuesIn(fesd_cases()), [](const auto& c) {
  return test_name(c.param.problem) + (c.param.form == Reformulation::step ? "_step" : "_stewart");
});

class FesdSuperTwisting : public testing::TestWithParam<Reformulation> {};

/// The element beside a crossing is a series in the root of time: fewer digits than elsewhere (docs/fesd.md).
TEST_P(FesdSuperTwisting, AgreesAsFarAsRootsLetIt) {
  const Simulator model = Simulator::from_catalogue("super-twisting");
  pipeline::SimulateOptions sharp = model.options();
  sharp.rtol = 1e-11;
  sharp.atol = 1e-13;
  const auto event = model.run(sharp);
  pipeline::SimulateOptions options = model.options();
  options.method = pipeline::Method::fesd;
  options.fesd.reformulation = GetParam();
  const auto run = [&](int stages, long steps) {
    options.fesd.stages = stages;
    options.fesd.steps = steps;
    auto result = model.run(options);
    EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    return result;
  };
  const auto expect_near = [&](const result::Result& result, double first, double later) {
    ASSERT_GE(result.events.size(), 8u);
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_NEAR(result.events[k].t, event.events[k].t, k < 2 ? first : later) << k;
      EXPECT_EQ(result.events[k].kind, event.events[k].kind) << k;
    }
    EXPECT_EQ(result.events.back().kind, result::EventKind::accumulation);
    EXPECT_NEAR(result.events.back().t, event.events.back().t, later);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(result.final.x[i], event.final.x[i], 1e-12);
    EXPECT_NEAR(result.final.alpha[0], 0.5, 1e-6);
  };
  expect_near(run(2, 100), 2e-5, 2e-3);
  expect_near(run(5, 800), 1e-10, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Forms, FesdSuperTwisting, testing::Values(Reformulation::step, Reformulation::stewart));

TEST(FesdReferences, MostOfTheCatalogueIsCompared) { EXPECT_GE(fesd_cases().size(), 70u); }

}  // namespace
}  // namespace saltus::problems
