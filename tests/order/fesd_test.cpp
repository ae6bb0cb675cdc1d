// Finite elements with switch detection keep the order of their method in end state and switching times, through
// crossings, sliding on lines and curves, and exits, in both forms.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "runs.hpp"

namespace saltus::problems {
namespace {

/// An order lost at the switches would be one less, or 1 altogether. Orders 7 and 8 go from 1e-7 to rounding within a
/// factor of ten in the length, not all of it the leading term's.
void expect_order(const Study& study, double order, const char* what) {
  const double scatter = order < 6.5 ? 0.3 : 0.5;
  constexpr std::size_t least_points = 4;
  ASSERT_GE(study.steps.size(), least_points) << what << "\n" << study.table();
  testing::Test::RecordProperty(what, std::to_string(study.slope()));
  EXPECT_GT(study.slope(), order - scatter) << what << "\n" << study.table();
}

/// Slopes over all levels from `first_elements` to roundings, or to some thousand elements for low orders; and an error
/// below 1e-11 with as many elements as the order lets expect.
void expect_order(const Problem& problem, const Wanted& wanted, double order, long first_elements, bool exact_ends) {
  const ReferenceProblem& reference = reference_of(problem);
  const Simulator model = Simulator::from_reference(reference);
  const bool high = order > 4.5, first_order = order < 1.5;
  const double ratio = high ? 1.2 : 1.3, most_elements = first_order ? 2e4 : 6e3;
  std::vector<Level> levels;
  for (auto first = static_cast<double>(first_elements); first < most_elements; first *= ratio) {
    std::vector<Grid> grids;
    // High orders scatter more, and take few elements.
    const long most_runs = first_order ? 2 : high ? 8 : 4;
    for (const long per_step : high ? std::vector{2L, 3L} : std::vector{2L}) {
      add_grids(grids, per_step, first, first * ratio, most_runs);
    }
    if (grids.empty()) continue;
    Level& level = levels.emplace_back();
    for (const Grid& grid : grids) level.add(grid, errors_with(model, reference, wanted, grid));
    if (level.rms(&Errors::state) < problem.state_rounding && level.rms(&Errors::times) < problem.time_rounding) break;
  }
  const Study times = study_of(levels, &Errors::times, problem.time_rounding);
  expect_order(times, order, "times");
  if (exact_ends) {
    for (const Level& level : levels) EXPECT_LT(level.rms(&Errors::state), problem.state_rounding) << level.elements;
  } else {
    expect_order(study_of(levels, &Errors::state, problem.state_rounding), order, "state");
  }
  constexpr double aim = 1e-11;
  const double last = std::max(levels.back().rms(&Errors::state), levels.back().rms(&Errors::times));
  if (last < aim) return;
  // Down to a third of it, as runs scatter.
  const double needed = levels.back().elements * std::pow(3.0 * last / aim, 1.0 / order);
  constexpr double most_affordable = 2.5e5;
  if (needed > most_affordable) {
    EXPECT_LT(order, 2.5) << needed << " elements for 1e-11";
    return;
  }
  const Errors there = errors_with(model, reference, wanted, {std::lround(0.5 * needed), 2});
  EXPECT_LT(std::max(there.state, there.times), aim) << needed << " elements\n" << times.table();
}

class FesdOrder : public testing::TestWithParam<std::tuple<Problem, std::size_t, Reformulation>> {};

TEST_P(FesdOrder, HoldsInEndStateAndSwitchingTimes) {
  const auto& [problem, i, form] = GetParam();
  const auto& method = runge_kutta_methods[i];
  expect_order(problem, {Method::fesd, method.scheme, method.stages, form}, method.order, problem.first_elements[i],
               problem.exact_ends[i]);
}

std::string name_of(const testing::TestParamInfo<FesdOrder::ParamType>& test) {
  const auto& [problem, i, form] = test.param;
  return std::string(problem.name) + runge_kutta_methods[i].name + name(form);
}

INSTANTIATE_TEST_SUITE_P(Table, FesdOrder,
                         testing::Combine(testing::ValuesIn(problems),
                                          testing::Range<std::size_t>(0, runge_kutta_methods.size()),
                                          testing::Values(Reformulation::step, Reformulation::stewart)),
                         name_of);

/// The other families where one of the two difficulties of sliding on curves could cost them their order: c_s != 1 has
/// no part in them, but the first stage of Lobatto IIIA has no multiplier and explicit methods have no stage at the
/// end.
struct Family {
  const char* name;
  Scheme scheme;
  long stages;
  double order;
  long first_elements;
};

class FesdOrderOnACircle : public testing::TestWithParam<Family> {};

TEST_P(FesdOrderOnACircle, HoldsInEndStateAndSwitchingTime) {
  const Family& family = GetParam();
  expect_order(problems.back(), {Method::fesd, family.scheme, family.stages, Reformulation::step}, family.order,
               family.first_elements, false);
}

INSTANTIATE_TEST_SUITE_P(
    Families, FesdOrderOnACircle,
    testing::Values(
        Family{"LobattoIIIC2", Scheme::lobatto_iiic, 2, 2, 108}, Family{"LobattoIIIC3", Scheme::lobatto_iiic, 3, 4, 66},
        Family{"LobattoIIIC4", Scheme::lobatto_iiic, 4, 6, 48}, Family{"LobattoIIIC5", Scheme::lobatto_iiic, 5, 8, 34},
        Family{"LobattoIIIA2", Scheme::lobatto_iiia, 2, 2, 108}, Family{"LobattoIIIA3", Scheme::lobatto_iiia, 3, 4, 66},
        Family{"LobattoIIIA4", Scheme::lobatto_iiia, 4, 6, 48}, Family{"LobattoIIIA5", Scheme::lobatto_iiia, 5, 8, 34},
        Family{"Explicit1", Scheme::explicit_rk, 1, 1, 800}, Family{"Explicit2", Scheme::explicit_rk, 2, 2, 108},
        Family{"Explicit3", Scheme::explicit_rk, 3, 3, 80},  // Half-explicit methods of order 4 need five stages.
        Family{"Explicit4", Scheme::explicit_rk, 4, 3, 160}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace saltus::problems
