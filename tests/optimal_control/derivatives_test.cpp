// Derivatives of the transcription against differences, for every scheme, form and mode.
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "../unit/mpcc/derivative_check.hpp"
#include "ocp_models.hpp"

namespace saltus::ocp_tests {
namespace {

/// Everything a problem may have, on a curved surface: free horizon, start and parameter, costs of every kind, soft and
/// hard constraints at stages, complementarities.
std::string everything(const std::string& numbers) {
  return R"toml(
[model]
name = "everything"
[parameters]
k = { initial = 0.8, lower = 0.1, upper = 2, free = true }
c = 0.3
[states]
x = { initial = 0.4, lower = -3, upper = 3, free = true }
v = { initial = 0.2, lower = -3, upper = 3 }
[controls]
u = { lower = -1, upper = 1, initial = 0.1 }
[dynamics]
x = "v*k"
v = "-x - c*sign(v - k*x^2) + u + 0.1*sin(t)"
[optimize]
from = 0.2
horizon = { free = true, initial = 1.1, lower = 0.5, upper = 2 }
control_intervals = 2
running_cost = "u^2 + k*x*v + sin(t)"
terminal_cost = "x^2*exp(0.1*t)"
minimize_time = 0.7
path_constraints = ["-2 <= x*v + u <= 2", { constraint = "x + v <= 0.1", penalty = 2, norm = "l1" }, { constraint = "x^2 == 0.3", penalty = 3, norm = "l2" }, { constraint = "v >= 0.5", penalty = 4, norm = "linf" }]
path_constraints_at = "stages"
terminal_constraints = ["x*v == 0.1", { constraint = "v^2 <= 0.01", penalty = 5, norm = "l2" }]
path_complementarities = [["x + 4", "v + 4"]]
)toml" + numbers +
         R"toml(
[[optimize.least_squares]]
of = ["x", "v*k"]
reference = ["sin(t)", 0.1]
weight = [[2, 0.3], [0.3, 1]]
at = "stages"
[[optimize.least_squares]]
of = ["x"]
at = "intervals"
[[optimize.least_squares]]
of = ["v"]
reference = [0.2]
at = "end"
)toml";
}

void check(const std::string& numbers) {
  SCOPED_TRACE(numbers);
  const Stated problem = stated(everything(numbers));
  auto made = pipeline::state_problem(problem.ocp, problem.options);
  ASSERT_TRUE(made) << to_text(made.error());
  auto& mpcc = *made->problem;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(0.05, 0.15);
  linalg::Vector w = mpcc.start();
  for (double& value : w) value += step(random);
  mpcc.with_method_terms(w);
  mpcc::expect_correct_derivatives(mpcc, w, 2e-6);
}

TEST(OcpDerivatives, EverySchemeAndForm) {
  for (const char* form : {"step", "stewart"}) {
    for (const char* scheme : {"radau_iia", "gauss_legendre", "lobatto_iiic", "explicit"}) {
      for (const char* representation : {"integral", "differential"}) {
        check(fmt::format("elements = 2\nstages = 2\nreformulation = \"{}\"\nscheme = \"{}\"\nrepresentation = \"{}\"",
                          form, scheme, representation));
      }
    }
  }
}

TEST(OcpDerivatives, EveryMode) {
  for (const char* cross : {"stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"}) {
    check(fmt::format("elements = [2, 1]\ncross_complementarity = \"{}\"", cross));
  }
  for (const char* steps :
       {"none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "direct", "mlcp", "paper"}) {
    check(fmt::format("elements = [2, 3]\nstep_equilibration = \"{}\"", steps));
  }
  check("elements = 2\nswitch_detection = false");
}

}  // namespace
}  // namespace saltus::ocp_tests
