// Which way a switching function points, its units, the order of surfaces and of states: nothing of that changes a
// solution, nor what the result says about it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "agreement/reference_checks.hpp"
#include "problems/closed_forms.hpp"
#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;

// Both runs meet their tolerances, and differ by how these and rounding decide the steps.
constexpr double agreement = 1e-7;

std::set<result::Mode> modes_of(const Event& event) {
  std::set<result::Mode> modes;
  for (const result::Alternative& other : event.alternatives) modes.insert(other.mode);
  return modes;
}

void expect_same(const Result& found, const Result& expected) {
  ASSERT_EQ(found.status.termination, expected.status.termination) << found.status.message;
  ASSERT_EQ(found.events.size(), expected.events.size());
  for (std::size_t i = 0; i < found.events.size(); ++i) {
    const Event &a = found.events[i], &b = expected.events[i];
    const std::string what = fmt::format("event {}", i + 1);
    EXPECT_NEAR(a.t, b.t, agreement * std::max(1.0, std::abs(b.t))) << what;
    EXPECT_EQ(a.kind, b.kind) << what;
    EXPECT_EQ(a.surfaces, b.surfaces) << what;
    EXPECT_EQ(a.mode_before, b.mode_before) << what;
    EXPECT_EQ(a.mode_after, b.mode_after) << what << ": " << a.reason << " | " << b.reason;
    expect_near(a.x_after, b.x_after, agreement, what);
    if (b.alpha_after) expect_near(a.alpha_after.value(), *b.alpha_after, agreement, what + ", alpha");
    EXPECT_EQ(a.unique, b.unique) << what;
    EXPECT_EQ(modes_of(a), modes_of(b)) << what;
  }
  expect_near(found.final.x, expected.final.x, agreement, "end state");
  EXPECT_EQ(found.final.mode, expected.final.mode);
  expect_near(found.final.alpha, expected.final.alpha, agreement, "alpha at the end");
}

/// `make` gives the model, relabelled or not.
template <class Make>
void expect_invariant(const Make& make) {
  const Simulator original = make(Relabelling{});
  for (const Accuracy& accuracy : {Accuracy{pipeline::Integrator::dopri5, 1e-10, 1e-12}, implicit}) {
    const Result expected = original.run(with(original.options(), accuracy));
    for (const Relabelling& relabelling : relabellings()) {
      SCOPED_TRACE(relabelling.name);
      const Simulator model = make(relabelling);
      const Result result = model.run(with(model.options(), accuracy));
      expect_same(in_original_words(result, relabelling, expected.switching_functions), expected);
    }
  }
}

/// Models that meet intersections, and those whose surfaces do not influence each other beside them.
class Invariance : public testing::TestWithParam<ReferenceProblem> {};

TEST_P(Invariance, OfModelsOfTheCatalogue) {
  expect_invariant([](const Relabelling& relabelling) { return Simulator::from_reference(GetParam(), relabelling); });
}

std::vector<ReferenceProblem> with_several_surfaces() {
  std::vector<ReferenceProblem> problems;
  for (const ReferenceProblem& problem : references()) {
    if (problem.final_mode.size() >= 2) problems.push_back(problem);
  }
  return problems;
}

INSTANTIATE_TEST_SUITE_P(Models, Invariance, testing::ValuesIn(with_several_surfaces()),
                         [](const auto& instance) { return test_name(instance.param); });

TEST(InvarianceInCodimensionTwo, OfClosedFormsAndOfTheSameBent) {
  std::vector<ClosedForm> problems{in_and_out(), unstable_exit()};
  for (const nlohmann::json& stored : stored_closed_forms()) {
    // Which of the spirals of P13 leaves is free.
    if (stored.at("id") != "P13" && stored.at("alpha").size() == 2) problems.push_back(closed_form(stored));
  }
  EXPECT_EQ(problems.size(), 8U);
  for (const ClosedForm& problem : problems) {
    for (const std::string& text : {text_of(problem), bent_text_of(problem)}) {
      SCOPED_TRACE(problem.name + "\n" + text);
      expect_invariant([&](const Relabelling& relabelling) {
        Simulator model = Simulator::from_text(text, relabelling);
        model.set_until(std::min(problem.until, bent_time(problem.until)));
        return model;
      });
    }
  }
}

}  // namespace
}  // namespace saltus::problems
