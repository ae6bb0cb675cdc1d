#include "problems/closed_forms.hpp"

#include <cmath>
#include <cstddef>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "source_folder.hpp"

namespace saltus::problems {
namespace {

using nlohmann::json;

std::string affine(const json& row, double constant) {
  std::string text = fmt::format("{}", constant);
  for (std::size_t i = 0; i < row.size(); ++i) text += fmt::format(" + ({})*y{}", row[i].get<double>(), i + 1);
  return text;
}

/// Product of the steps of a region: "-+" is (1 - step(s1))*step(s2).
std::string weight_of(const std::string& region) {
  std::string text = "1";
  for (std::size_t j = 0; j < region.size(); ++j) {
    const std::string step = fmt::format("step(s{})", j + 1);
    text += region[j] == '+' ? "*" + step : "*(1 - " + step + ")";
  }
  return text;
}

std::string initial_mode_of(const ClosedForm& problem) {
  std::string text;
  for (std::size_t j = 0; j < problem.initial_mode.size(); ++j) {
    text += fmt::format("{}s{} = {}", j == 0 ? "" : ", ", j + 1, problem.initial_mode[j]);
  }
  return text.empty() ? text : "initial_mode = { " + text + " }\n";
}

std::string rows(const std::string& name, const std::vector<std::string>& expressions) {
  std::string text;
  for (std::size_t i = 0; i < expressions.size(); ++i) {
    text += fmt::format("{}{} = \"{}\"\n", name, i + 1, expressions[i]);
  }
  return text;
}

std::string states(const std::string& name, const std::vector<double>& start) {
  std::string text = "[states]\n";
  for (std::size_t i = 0; i < start.size(); ++i) text += fmt::format("{}{} = {}\n", name, i + 1, start[i]);
  return text;
}

/// Exact for polynomials up to degree 3.
double integral(const std::function<double(double)>& rate, double from, double to) {
  return (to - from) / 6 * (rate(from) + 4 * rate((from + to) / 2) + rate(to));
}

}  // namespace

json stored_closed_forms() {
  std::ifstream file(tests::source_folder("tests/data/switching_cases.json"));
  return json::parse(file).at("problems");
}

ClosedForm closed_form(const json& stored, double scale) {
  ClosedForm problem{.name = stored.at("id"),
                     .start = stored.at("y0"),
                     .surfaces = {},
                     .velocities = std::vector<std::string>(stored.at("n"), "0"),
                     .until = stored.at("tend")};
  for (const json& surface : stored.at("alpha")) {
    problem.surfaces.push_back(fmt::format("{}*({})", scale, affine(surface.at("a"), surface.at("b"))));
  }
  for (std::size_t i = 0; i < problem.velocities.size(); ++i) {
    for (const auto& [region, field] : stored.at("fields").items()) {
      problem.velocities[i] += fmt::format(" + ({})*{}", affine(field.at("A")[i], field.at("c")[i]), weight_of(region));
    }
  }
  if (stored.at("initial_mode") == json{0, 0}) problem.initial_mode = {0, 0};
  for (const json& event : stored.at("events")) {
    problem.events.push_back({event.at("t"), event.at("y"), event.at("to_mode")});
  }
  problem.final_y = stored.at("final").at("y").get<std::vector<double>>();
  return problem;
}

std::string text_of(const ClosedForm& problem) {
  return "[model]\nname = \"closed-form\"\n" + states("y", problem.start) + "[switching]\n" +
         rows("s", problem.surfaces) + "[dynamics]\n" + rows("y", problem.velocities) +
         fmt::format("[simulate]\nuntil = {}\n", problem.until) + initial_mode_of(problem);
}

double bent_time(double tau) { return 2 * std::atan(tau / 2); }

std::vector<double> bent_state(double tau, const std::vector<double>& y) {
  std::vector<double> z;
  for (const double value : y) z.push_back(z.empty() ? value + 0.3 * std::sin(tau) : value + 0.2 * std::sin(z.back()));
  z.push_back(tau);
  return z;
}

std::string bent_text_of(const ClosedForm& problem) {
  const std::size_t n = problem.start.size();
  std::vector<std::string> straight{"z1 - 0.3*sin(tau)"}, bent{"v1 + 0.3*cos(tau)"}, dynamics{"rho*w1"};
  for (std::size_t i = 2; i <= n; ++i) {
    straight.push_back(fmt::format("z{} - 0.2*sin(z{})", i, i - 1));
    bent.push_back(fmt::format("v{} + 0.2*cos(z{})*w{}", i, i - 1, i - 1));
    dynamics.push_back(fmt::format("rho*w{}", i));
  }
  std::vector<double> start = bent_state(0.0, problem.start);
  start.pop_back();
  return "[model]\nname = \"bent\"\n" + states("z", start) + "tau = 0\n[definitions]\nrho = \"1 + tau^2/4\"\n" +
         rows("y", straight) + rows("v", problem.velocities) + rows("w", bent) + "[switching]\n" +
         rows("s", problem.surfaces) + "[dynamics]\n" + rows("z", dynamics) + "tau = \"rho\"\n[simulate]\nuntil = 1\n" +
         initial_mode_of(problem);
}

// With s1, s2 the signs (s1 = 2 alpha_1 - 1): y1' = a1 - s1 + s2/2, y2' = a2 - s2 - s1/2, y3' = s1 s2, y4' = 1, where
// a1 = 0.6 y4 - 0.15 and a2 = 0.3 + 0.05 y4 are such that both vanish at s1 = y4/2, s2 = 0.3 - y4/5.
ClosedForm in_and_out() {
  const auto a1 = [](double t) { return 0.6 * t - 0.15; };
  const auto a2 = [](double t) { return 0.3 + 0.05 * t; };
  const auto slid1 = [&](double t) { return a1(t) - 0.5; };  // on the first surface below the second
  const auto slid2 = [&](double t) { return a2(t) - 0.5; };  // on the second surface behind the first
  const double y1 = -integral([&](double t) { return a1(t) + 0.5; }, 0.0, 0.5);
  const double second_before = integral([&](double t) { return a2(t) + 1.5; }, 0.0, 0.5);
  const double second_after = integral([&](double t) { return a2(t) + 1 - slid1(t) / 2; }, 0.5, 1.0);
  const double third1 = integral([](double) { return 1.0; }, 0.0, 0.5);
  const double third2 = third1 - integral(slid1, 0.5, 1.0);
  const double third3 = third2 + integral([](double t) { return t / 2 * (0.3 - t / 5); }, 1.0, 2.0);
  return {
      .name = "in and out",
      .start = {y1, -second_before - second_after, 0, 0},
      .surfaces = {"y1", "y2"},
      .velocities = {"0.6*y4 - 0.15 - sign(s1) + sign(s2)/2", "0.3 + 0.05*y4 - sign(s2) - sign(s1)/2",
                     "sign(s1)*sign(s2)", "1"},
      .until = 2.5,
      .events = {{0.5, {0, -second_after, third1, 0.5}, {0, -1}},
                 {1.0, {0, 0, third2, 1.0}, {0, 0}},
                 {2.0, {0, 0, third3, 2.0}, {1, 0}}},
      .final_y = {integral([&](double t) { return a1(t) - 1 + slid2(t) / 2; }, 2.0, 2.5), 0,
                  third3 + integral(slid2, 2.0, 2.5), 2.5},
  };
}

// With m1 = 0.3 (1 - y4), m2 = -0.2 (1 - y4): g1 = b (s1 - m1) + (s2 - m2) + (s1 s2 - m1 m2)/2,
// g2 = -(s1 - m1) + 0.8 (s2 - m2) + 0.6 (s1 s2 - m1 m2) vanish at (m1, m2), and G11 = (y4 - 1)/2 there.
ClosedForm unstable_exit() {
  const auto m1 = [](double t) { return 0.3 * (1 - t); };
  const auto m2 = [](double t) { return -0.2 * (1 - t); };
  const auto b = [&](double t) { return (t - 1) / 2 - m2(t) / 2; };
  const auto both = [&](double t) { return 1 - m1(t) * m2(t); };
  const auto rate1 = [&](double t) { return b(t) * (1 - m1(t)) + 1 - m2(t) + both(t) / 2; };
  const auto rate2 = [&](double t) { return -(1 - m1(t)) + 0.8 * (1 - m2(t)) + 0.6 * both(t); };
  const std::string first = "(sign(s1) - 0.3*(1 - y4))", second = "(sign(s2) + 0.2*(1 - y4))";
  const std::string product = "(sign(s1)*sign(s2) + 0.06*(1 - y4)^2)";
  const double third = integral(m1, 0.0, 1.0);
  return {
      .name = "unstable exit",
      .start = {0, 0, 0, 0},
      .surfaces = {"y1", "y2"},
      .velocities = {"((y4 - 1)/2 + 0.1*(1 - y4))*" + first + " + " + second + " + " + product + "/2",
                     "-" + first + " + 0.8*" + second + " + 0.6*" + product, "sign(s1)", "1"},
      .initial_mode = {0, 0},
      .until = 1.5,
      .events = {{1.0, {0, 0, third, 1.0}, {1, 1}}},
      .final_y = {integral(rate1, 1.0, 1.5), integral(rate2, 1.0, 1.5), third + 0.5, 1.5},
  };
}

}  // namespace saltus::problems
