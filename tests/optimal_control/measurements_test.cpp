// Least squares at times of their own: [[optimize.least_squares]] with at = "times".
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/model/optimal_control/ocp_builder.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

/// Writes rows of numbers beside the tests; gone at the end.
class Data {
 public:
  explicit Data(const std::string& rows) {
    std::ofstream file(path_);
    file << rows;
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
  ~Data() { std::filesystem::remove(path_); }
  [[nodiscard]] std::string path() const { return path_.string(); }
  /// A table with these rows as reference.
  [[nodiscard]] std::string table(const std::string& of, const std::string& more = "") const {
    return fmt::format("[[optimize.least_squares]]\nof = {}\nreference = {{ file = '{}' }}\nat = 'times'\n{}\n", of,
                       path(), more);
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / fmt::format("saltus_{}.csv", static_cast<const void*>(this));
};

/// xdot = rate from x = start up to t = until.
std::string fit(const std::string& start, const std::string& rate, const std::string& until,
                const std::string& problem) {
  return fmt::format(R"toml([model]
name = "fit"
[parameters]
k = {{ initial = 2, lower = 1, upper = 5, free = true }}
[states]
x = {}
[controls]
u = {{ lower = -5, upper = 5 }}
[dynamics]
x = "{}"
[optimize]
horizon = {}
control_intervals = 2
running_cost = "1e-6*(k - 3)^2"
{})toml",
                     start, rate, until, problem);
}

/// u = 1, then -1/2 from t = 1 on.
TEST(Measurements, ControlsAreFoundFromTimesBetweenNodes) {
  const Data data("t, x\n0, 0\n0.3, 0.3\n0.7, 0.7\n1, 1\n1, 1\n1.4, 0.8\n1.9, 0.55\n2, 0.5\n");
  const auto result = optimized(stated(fit("0", "u", "2", data.table("['x']"))));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 0.0, 1e-14);
  EXPECT_NEAR(result.optimization->u[0][0], 1.0, 1e-7);
  EXPECT_NEAR(result.optimization->u[1][0], -0.5, 1e-7);
}

/// x = t - 0.55, and 3 (t - 0.55) from there on: the switch lies between measurements of one interval.
TEST(Measurements, AreComparedOnTheirSideOfASwitch) {
  const Data data("0.2 -0.35\n0.5 -0.05\n0.54 -0.01\n0.6 0.15\n0.9 1.05\n1.0 1.35\n");
  for (const std::string more : {"", "elements = 5\n", "representation = 'differential'\n",
                                 "scheme = 'gauss_legendre'\nstages = 3\n", "reformulation = 'stewart'\n"}) {
    const auto result = optimized(stated(fit("-0.55", "if(x > 0, k, 1) + 0*u", "1.1", more + data.table("['x']"))));
    EXPECT_EQ(result.status.termination, Termination::completed) << more << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 0.0, 1e-14) << more;
    ASSERT_EQ(result.optimization->parameters.size(), 1U);
    EXPECT_NEAR(result.optimization->parameters[0].second, 3.0, 1e-6) << more;
  }
}

/// Nothing is free but k: a sum over the rows, without the length of intervals.
TEST(Measurements, AreSummedUp) {
  const Data one("0.25 0\n1.5 1\n"), two("0.5 1 2\n");
  const auto result = optimized(
      stated(fit("0", "1 + 0*u", "2",
                 one.table("['x']", "weight = [2]") + two.table("['x', '2*x']", "weight = [[1, 1], [1, 3]]"))));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  // 2 (1/16 + 1/4); with r = (-1/2, -1): 1/4 + 2 1/2 + 3
  EXPECT_NEAR(result.optimization->objective, 0.625 + 4.25, 1e-10);
  EXPECT_NEAR(result.optimization->terms.least_squares, 0.625 + 4.25, 1e-10);
}

TEST(Measurements, ABuilderStatesThemToo) {
  const auto built = [](const std::vector<double>& times, const linalg::Matrix& samples) {
    model::Builder model("fit");
    const auto x = model.state("x", {0.0});
    const auto u = model.control("u", {0.0, -5.0, 5.0});
    model.dynamics("x", u);
    model::OcpBuilder problem(std::move(model));
    problem.measurements({x}, times, samples);
    problem.horizon(2.0);
    return problem.build();
  };
  const auto ocp = built({0.5, 1.5}, {{0.5}, {0.75}});
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  pipeline::OptimizeOptions options;
  options.control_intervals = 2;
  const auto result = pipeline::optimize(*ocp, options);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_NEAR(result->optimization->u[0][0], 1.0, 1e-7);
  EXPECT_NEAR(result->optimization->u[1][0], -0.5, 1e-7);
  const auto outside = built({0.5, 2.5}, {{0.5}, {0.75}});
  ASSERT_FALSE(outside);
  EXPECT_NE(to_text(outside.error()).find("row 2: the time 2.5 is outside"), std::string::npos);
  const auto misfit = built({0.5}, {{0.5}, {0.75}});
  ASSERT_FALSE(misfit);
  EXPECT_NE(to_text(misfit.error()).find("2 x 1 samples for 1 times and 1 expressions"), std::string::npos);
}

std::string refusal_of_fit(const std::string& text) {
  auto file = io::parse_model(text, "fit.toml");
  if (!file) return to_text(file.error());
  if (const auto checked = io::check_optimize_options(*file); !checked) return to_text(checked.error());
  const auto ocp = model::build_ocp(file->description);
  if (!ocp) return to_text(ocp.error());
  const auto made = pipeline::state_problem(*ocp, *file->optimize);
  return made ? "" : to_text(made.error());
}

void expect_no_fit(const std::string& text, const std::vector<std::string>& phrases) {
  const std::string refusal = refusal_of_fit(text);
  for (const auto& phrase : phrases) {
    EXPECT_NE(refusal.find(phrase), std::string::npos) << "'" << phrase << "' is not in\n" << refusal;
  }
}

TEST(Measurements, MistakesTellTheRow) {
  const auto refused = [](const std::string& rows, const std::vector<std::string>& phrases) {
    const Data data(rows);
    auto all = phrases;
    all[0] = data.path() + all[0];
    expect_no_fit(fit("0", "u", "2", data.table("['x']")), all);
  };
  refused("t, x\n0, 1\n2.5, 1\n",
          {":3:1: error: row 2: the time 2.5 is outside of the horizon, from 0 to 2", "`from`"});
  refused("-0.1, 1\n", {":1:1: error: row 1: the time -0.1 is outside of the horizon"});
  refused("0, 1\n1, 1\n# later\n0.5, 1\n", {":4:1: error: row 3: the time 0.5 is behind 1, of the row before", "sort"});
  refused("0, 1\n1, nan\n", {":2:1: error: expected a finite number, found 'nan'"});
  refused("0, 1\nnan, 1\n", {":2:1: error: expected a finite number, found 'nan'"});
  refused("0, 1, 2\n", {":1:1: error: expected 2 numbers, found 3", "a time, then one number per expression"});
}

TEST(Measurements, WhatIsNotCovered) {
  const Data data("0, 1\n1, 1\n");
  expect_no_fit(fit("0", "u", "{ free = true, initial = 2, lower = 1, upper = 3 }", data.table("['x']")),
                {"fit.toml:15:1: error: least_squares at times, and the horizon is free", "fix the horizon"});
  expect_no_fit(fit("0", "u", "2", "scheme = 'lobatto_iiic'\n" + data.table("['x']")),
                {"a collocation method", "radau_iia"});
  expect_no_fit(fit("0", "u", "2", "[[optimize.least_squares]]\nof = ['x']\nat = 'times'\nreference = ['sin(t)']"),
                {"fit.toml:15:1: error: at = \"times\" needs measurements", "data.csv"});
}

}  // namespace
}  // namespace saltus::ocp_tests
