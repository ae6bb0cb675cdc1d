// Problems as texts, and what is done with them in these tests.
#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/ocp_problem.hpp"
#include "saltus/pipeline/optimal_control/optimize.hpp"

namespace saltus::ocp_tests {

struct Stated {
  model::Ocp ocp;
  pipeline::OptimizeOptions options;
};

inline Stated stated(const std::string& text) {
  auto file = io::parse_model(text, "test.toml");
  EXPECT_TRUE(file) << (file ? "" : to_text(file.error()));
  auto ocp = model::build_ocp(file->description);
  EXPECT_TRUE(ocp) << (ocp ? "" : to_text(ocp.error()));
  return {std::move(*ocp), *file->optimize};
}

inline result::Result optimized(const Stated& problem) {
  auto result = pipeline::optimize(problem.ocp, problem.options);
  EXPECT_TRUE(result) << (result ? "" : to_text(result.error()));
  return std::move(*result);
}

/// Stewart and Anitescu: the optimum is known by quadrature.
inline std::string stewart_anitescu(const std::string& more) {
  return R"toml(
[model]
name = "stewart-anitescu"
[states]
x = { initial = -1.5, lower = -2, upper = 5, free = true }
[dynamics]
x = "2 - sign(x)"
[optimize]
horizon = 2
control_intervals = 1
running_cost = "x^2"
terminal_cost = "(x - 5/3)^2"
)toml" + more;
}

/// Least time with a turbo that triples the acceleration above 10.
inline std::string turbo_car(int v_max, int intervals, const std::string& more = "") {
  return fmt::format(R"toml(
[model]
name = "turbo-car"
[states]
q = 0
v = {{ initial = 0, lower = -{0}, upper = {0} }}
[controls]
u = {{ lower = -5, upper = 5 }}
[dynamics]
q = "v"
v = "if(v > 10, 3, 1)*u"
[optimize]
horizon = {{ free = true, initial = 10, lower = 1, upper = 100 }}
control_intervals = {1}
minimize_time = true
terminal_constraints = ["q == 200", "v == 0"]
{2})toml",
                     v_max, intervals, more);
}

}  // namespace saltus::ocp_tests
