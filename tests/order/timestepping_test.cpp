// Without switch detection every method falls to order 1.
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "runs.hpp"

namespace saltus::problems {
namespace {

/// Slopes of several methods: the scatter of each is large, that of their mean is not.
class Slopes {
 public:
  void add(const char* method, const Study& study) {
    const double slope = study.slope();
    slopes_.push_back(slope);
    table_ += std::string(method) + ": " + std::to_string(slope) + "\n";
  }
  void expect(double slope, double margin, const char* what) const {
    ASSERT_FALSE(slopes_.empty());
    const double mean = std::accumulate(slopes_.begin(), slopes_.end(), 0.0) / static_cast<double>(slopes_.size());
    testing::Test::RecordProperty(what, std::to_string(mean));
    EXPECT_NEAR(mean, slope, margin) << what << "\n" << table_;
    for (const double each : slopes_) EXPECT_NEAR(each, slope, 0.45) << what << "\n" << table_;
  }

 private:
  std::vector<double> slopes_;
  std::string table_;
};

class WithoutSwitchDetection : public testing::TestWithParam<std::tuple<Problem, Reformulation>> {};

/// Where a switch lies in its element decides: errors jump between 0 and C h. Times of switches, and states there, are
/// off by C h for every method.
///
/// An error delta of a time puts the end state off by delta times the jump of the field. Where that is along the normal
/// of a surface on which the solution then slides (friction; a pull towards a circle), stages on the surface take it
/// away again, and delta^2 is left, for every method that ends at a stage and for the midpoint rule.
TEST_P(WithoutSwitchDetection, EveryMethodFallsToOrderOne) {
  const auto& [problem, form] = GetParam();
  const std::string model_name = problem.model;
  const bool crosses = model_name == "rotating-oscillator" || model_name == "irma", rests = model_name == "sliding";
  const ReferenceProblem& reference = reference_of(problem);
  const Simulator model = Simulator::from_reference(reference);
  constexpr double ratio = 1.5, first_steps = 100.0, most_steps = 1200.0;
  constexpr double margin = 0.15;
  constexpr long most_runs = 8;
  Slopes first_times, first_switches, states, forgotten;
  for (const auto& method : runge_kutta_methods) {
    std::vector<Level> levels;
    int runs = 0, without_solution = 0;
    for (double first = first_steps; first < most_steps; first *= ratio) {
      Level& level = levels.emplace_back();
      std::vector<Grid> grids;
      add_grids(grids, 1, first, first * ratio, most_runs);
      for (const Grid& grid : grids) {
        ++runs;
        try {
          level.add(grid,
                    errors_with(model, reference, {Method::timestepping, method.scheme, method.stages, form}, grid));
        } catch (const std::runtime_error&) {
          ++without_solution;  // no combination of sides solves the stages of some element
        }
      }
    }
    EXPECT_LE(without_solution, runs / 10) << method.name;
    first_times.add(method.name, study_of(levels, &Errors::first_time, 0.0));
    first_switches.add(method.name, study_of(levels, &Errors::first_switch, 0.0));
    const bool forgets = method.scheme == Scheme::radau_iia || method.stages == 1;
    if (crosses || !forgets) {
      states.add(method.name, study_of(levels, &Errors::state, 0.0));
    } else if (!rests && method.order > 3.5) {
      forgotten.add(method.name, study_of(levels, &Errors::state, 0.0));
    }
  }
  first_times.expect(1.0, margin, "first time");
  first_switches.expect(1.0, margin, "first switch");
  states.expect(1.0, margin, "end state");
  if (!crosses && !rests) forgotten.expect(2.0, 3.0 * margin, "end state that forgets");
}

INSTANTIATE_TEST_SUITE_P(Table, WithoutSwitchDetection,
                         testing::Combine(testing::ValuesIn(problems),
                                          testing::Values(Reformulation::step, Reformulation::stewart)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + name(std::get<1>(test.param));
                         });

}  // namespace
}  // namespace saltus::problems
