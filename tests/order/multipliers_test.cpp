// Rates of convergence of what is not the state: multipliers and selections at the stages (their time derivatives'
// order is q of Assumption 17), and sensitivities (Theorem 18 of [nurkanovic2024]).
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"
#include "study.hpp"

namespace saltus::problems {
namespace {

using pipeline::Reformulation;

/// A circle as surface: x' = -w y - k x, y' = w x - k y with k = sign(r^2 - 1) - g, so that r' = -k r.
std::string circle_model(const std::string& turn, const std::string& push) {
  return R"toml([model]
name = "driven-circle"
[states]
x = 1.5
y = 0
[definitions]
turn = ")toml" +
         turn + R"toml("
push = ")toml" +
         push + R"toml("
pull = "sign(x^2 + y^2 - 1) - push"
[dynamics]
x = "-turn*y - pull*x"
y = "turn*x - pull*y"
[simulate]
until = 4
)toml";
}

/// g = sin(2t) / 2, whatever the place: r(t) = 1.5 exp(-t + (1 - cos 2t) / 4) until r = 1, then alpha = (1 + g) / 2.
Simulator pushed_by_time() { return Simulator::from_text(circle_model("1 + x/2", "0.5*sin(2*t)")); }
double radius(double t) { return 1.5 * std::exp(-t + 0.25 * (1.0 - std::cos(2.0 * t))); }
double alpha_of_time(double t) { return 0.5 * (1.0 + 0.5 * std::sin(2.0 * t)); }
/// w = 1, g = x / 2r: the angle is t, alpha = (1 + cos(t) / 2) / 2 is known as well as the state is.
Simulator pushed_by_place() { return Simulator::from_text(circle_model("1", "0.5*x/sqrt(x^2 + y^2)")); }
double alpha_of_place(double t) { return 0.5 * (1.0 + 0.5 * std::cos(t)); }

pipeline::SimulateOptions options_of(const Simulator& model, const RungeKutta& method, Reformulation form, long steps) {
  pipeline::SimulateOptions options = model.options();
  options.method = pipeline::Method::fesd;
  options.fesd.error_limit.reset();  // elements of the length that is studied
  options.fesd.scheme = method.scheme;
  options.fesd.stages = method.stages;
  options.fesd.steps = steps;
  options.fesd.reformulation = form;
  return options;
}

result::Result completed(const Simulator& model, const pipeline::SimulateOptions& options) {
  result::Result result = model.run(options);
  if (result.status.termination != result::Termination::completed) throw std::runtime_error(result.status.message);
  return result;
}

struct MultiplierErrors {
  double selections = 0.0;  ///< alpha at stages while sliding
  double ends = 0.0;        ///< alpha of the projected field at the ends of elements while sliding
  double lambda = 0.0;      ///< lambda_p = psi at stages before
  double lambda_ends = 0.0;
};

MultiplierErrors errors_of(const result::Result& result, Reformulation form, double (*alpha)(double)) {
  MultiplierErrors errors;
  const auto& elements = result.elements.value();
  const double entered = result.events.front().t;
  const auto raise = [](double& largest, double error) { largest = std::max(largest, std::abs(error)); };
  for (std::size_t row = 0; row < elements.t.size(); ++row) {
    const double t = elements.t[row];
    const std::size_t place = row % elements.points;
    const bool is_end = place == 0 || place + 1 == elements.points;
    // The element's own side of the switch: its middle tells.
    const std::size_t first = row - place;
    const bool slides = 0.5 * (elements.t[first] + elements.t[first + elements.points - 1]) > entered;
    if (slides) {
      // Of Stewart's form the first region is where psi > 0.
      raise(is_end ? errors.ends : errors.selections, elements.selection[row].front() - alpha(t));
    } else {
      // g_i = -s_i psi: lambda of the region that is not active is 2 psi.
      const double psi = radius(t) * radius(t) - 1.0;
      const double found =
          form == Reformulation::step ? elements.lambda[row].front() : elements.lambda[row].back() / 2.0;
      raise(is_end ? errors.lambda_ends : errors.lambda, found - psi);
    }
  }
  return errors;
}

class MultiplierOrder : public testing::TestWithParam<std::tuple<std::size_t, Reformulation>> {};

/// The selections of an element are algebraic variables of index 2: of order s at the stages. Those of the projected
/// field at its ends have the order of the state, and with them the ends of sliding have. Multipliers at stages are
/// functions of stage states: of order s + 1, and of the order of the method where that is less.
TEST_P(MultiplierOrder, OfSelectionsIsThatOfTheStagesAndOfTheMethodAtTheEnds) {
  const auto& [i, form] = GetParam();
  const auto& method = runge_kutta_methods[i];
  const Simulator by_time = pushed_by_time(), by_place = pushed_by_place();
  constexpr std::array<double, runge_kutta_methods.size()> first_steps{300, 40, 20, 12, 60, 20, 14, 8};
  constexpr int levels = 24;
  constexpr double ratio = 1.08;
  constexpr std::size_t group = 4;
  Study selections, ends, lambda, lambda_ends;
  double steps = first_steps[i];
  for (int level = 0; level < levels; ++level, steps *= ratio) {
    const long n = std::lround(steps);
    const auto errors = errors_of(completed(by_time, options_of(by_time, method, form, n)), form, alpha_of_time);
    selections.add(n, errors.selections);
    lambda.add(n, errors.lambda);
    lambda_ends.add(n, errors.lambda_ends);
    ends.add(n, errors_of(completed(by_place, options_of(by_place, method, form, n)), form, alpha_of_place).ends);
  }
  for (Study* study : {&selections, &ends, &lambda, &lambda_ends}) *study = study->envelope(group);
  const auto stages = static_cast<double>(method.stages);
  RecordProperty("alpha at stages", std::to_string(selections.slope()));
  RecordProperty("alpha at ends", std::to_string(ends.slope()));
  RecordProperty("lambda at stages", std::to_string(lambda.slope()));
  RecordProperty("lambda at ends", std::to_string(lambda_ends.slope()));
  // Slopes over few points that scatter; orders 7 and 8 are at rounding soon.
  constexpr double scatter = 0.6, scatter_of_high_orders = 2.2;
  const double at_ends = method.order - (method.order < 6.5 ? scatter : scatter_of_high_orders);
  EXPECT_NEAR(selections.slope(), stages, scatter) << selections.table();
  EXPECT_GT(lambda.slope(), std::min(method.order, stages + 1.0) - (stages < 3.5 ? 1.5 : 2.5) * scatter)
      << lambda.table();
  for (const Study* study : {&ends, &lambda_ends}) {
    if (study->usable() < 3) {
      EXPECT_LT(study->largest(), 1e-9) << study->table();
    } else {
      EXPECT_GT(study->slope(), at_ends) << study->table();
    }
  }
}

std::string method_and_form(const testing::TestParamInfo<MultiplierOrder::ParamType>& test) {
  const auto& [i, form] = test.param;
  return std::string(runge_kutta_methods[i].name) + (form == Reformulation::step ? "Step" : "Stewart");
}

INSTANTIATE_TEST_SUITE_P(Table, MultiplierOrder,
                         testing::Combine(testing::Range<std::size_t>(0, runge_kutta_methods.size()),
                                          testing::Values(Reformulation::step, Reformulation::stewart)),
                         method_and_form);

class SensitivityOrder : public testing::TestWithParam<std::size_t> {};

/// Theorem 18 of [nurkanovic2024] has O(h^q), q = p - 1 for collocation; the derivatives of the discretisation are a
/// Runge-Kutta method of their own, and what closes a chain is of order p, so that here they are of order p.
TEST_P(SensitivityOrder, IsThatOfTheMethod) {
  const std::array<std::array<double, 2>, 2> exact{
      {{21.66946501324, -2.06995427137}, {56.63750249010, -4.34234751571}}};
  const auto& method = runge_kutta_methods[GetParam()];
  const Simulator model = Simulator::from_catalogue("rotating-oscillator");
  constexpr std::array<double, runge_kutta_methods.size()> first_steps{2000, 60, 26, 14, 60, 28, 16, 9};
  constexpr int levels = 24;
  constexpr double ratio = 1.08;
  constexpr std::size_t group = 4;
  Study study;
  double steps = first_steps[GetParam()];
  for (int level = 0; level < levels; ++level, steps *= ratio) {
    auto options = options_of(model, method, Reformulation::step, std::lround(steps));
    options.fesd.sensitivities = true;
    const auto found = completed(model, options).sensitivities.value().x0;
    double error = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) error = std::max(error, std::abs(found[i][j] - exact[i][j]));
    }
    // The reference has eleven digits behind the point.
    if (error > 1e-9) study.add(std::lround(steps), error);
  }
  study = study.envelope(group);
  ASSERT_GE(study.usable(), 3U) << study.table();
  RecordProperty("slope", std::to_string(study.slope()));
  // Three points are left above the reference's digits of order 8.
  EXPECT_GT(study.slope(), method.order - (method.order < 6.5 ? 0.5 : 1.8)) << study.table();
}

INSTANTIATE_TEST_SUITE_P(Methods, SensitivityOrder, testing::Range<std::size_t>(0, runge_kutta_methods.size()),
                         [](const auto& test) { return std::string(runge_kutta_methods[test.param].name); });

}  // namespace
}  // namespace saltus::problems
