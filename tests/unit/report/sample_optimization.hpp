// A result as an optimisation might give it: the car with a turbo, in closed form.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report_samples {

/// q' = v, v' = (v < 10 ? 1 : 3) u with |u| <= 5 and v <= 25, from rest to rest over 200 in the shortest time: full
/// throttle for 3 seconds (from 10 on with the turbo), then 145 at top speed, then the same backwards. T = 11.8.
struct TurboCar {
  static constexpr double horizon = 11.8;
  struct Piece {
    double from, q, v, a, u;
  };
  static constexpr std::array<Piece, 5> pieces{{{0.0, 0.0, 0.0, 5.0, 5.0},
                                                {2.0, 10.0, 10.0, 15.0, 5.0},
                                                {3.0, 27.5, 25.0, 0.0, 0.0},
                                                {8.8, 172.5, 25.0, -15.0, -5.0},
                                                {9.8, 190.0, 10.0, -5.0, -5.0}}};
  [[nodiscard]] static const Piece& piece(double t) {
    std::size_t i = pieces.size() - 1;
    while (i > 0 && t < pieces[i].from) --i;
    return pieces[i];
  }
  [[nodiscard]] static std::vector<double> state(double t) {
    const auto& [from, q, v, a, u] = piece(t);
    const double s = t - from;
    return {q + v * s + 0.5 * a * s * s, v + a * s};
  }
  [[nodiscard]] static double turbo(double t) { return t > 2.0 && t < 9.8 ? 1.0 : 0.0; }
};

/// Ends of the three elements of an interval: one of them at the switch, if there is one inside.
inline std::vector<double> element_ends(double from, double to) {
  std::vector<double> ends{from, from + (to - from) / 3.0, from + 2.0 * (to - from) / 3.0, to};
  for (const double t : {2.0, 9.8}) {
    if (t > from && t < to) ends[t - from < to - t ? 1 : 2] = t;
  }
  return ends;
}

inline void add_turbo_element(result::Result& result, double from, double to, const std::vector<double>& u) {
  auto& trajectory = result.trajectory;
  auto& elements = *result.elements;
  const double alpha = TurboCar::turbo(0.5 * (from + to));
  for (const double c : {0.0, 1.0 / 3.0, 1.0, 1.0}) {
    const double t = c < 1.0 ? from + c * (to - from) : to;
    const auto x = TurboCar::state(t);
    elements.t.push_back(t);
    elements.lambda.push_back({x[1] - 10.0});
    elements.selection.push_back({alpha});
    // Elements share their ends; where it switches there are both rows.
    if (!trajectory.t.empty() && trajectory.t.back() == t && trajectory.alpha.back()[0] == alpha) {
      trajectory.t.pop_back();
      trajectory.x.pop_back();
      trajectory.u.pop_back();
      trajectory.alpha.pop_back();
      trajectory.mode.pop_back();
    }
    trajectory.t.push_back(t);
    trajectory.x.push_back(x);
    trajectory.u.push_back(u);
    trajectory.alpha.push_back({alpha});
    trajectory.mode.push_back({alpha > 0.5 ? 1 : -1});
  }
}

inline void add_turbo_events(result::Result& result) {
  for (const double t : {2.0, 9.8}) {
    result::Event event;
    event.t = t;
    event.surfaces = {"turbo"};
    const int before = t < 5.0 ? -1 : 1;
    event.mode_before = result::Mode{before};
    event.mode_after = result::Mode{-before};
    event.alpha_before = std::vector<double>{before > 0 ? 1.0 : 0.0};
    event.alpha_after = std::vector<double>{before > 0 ? 0.0 : 1.0};
    event.x = event.x_after = TurboCar::state(t);
    event.reason = "both fields lead across";
    result.events.push_back(event);
  }
}

/// Relaxed problems down to sigma = 1e-10, one of which failed, a linear program and a branch problem.
inline std::vector<result::HomotopyStep> turbo_homotopy() {
  using result::HomotopyPhase;
  std::vector<result::HomotopyStep> steps;
  double sigma = 1.0;
  for (int k = 0; k <= 10; ++k, sigma *= 0.1) {
    const double objective = TurboCar::horizon - 1.5 * std::sqrt(sigma);
    steps.push_back({HomotopyPhase::relaxed, "ipopt", sigma, k == 0 ? 84 : 9 + 3 * (k % 4), objective,
                     k == 4 ? 3e-5 : 1e-9 / (1.0 + k), std::sqrt(sigma), result::Termination::completed, 0.05, ""});
  }
  steps[4].termination = result::Termination::iteration_limit;
  steps[4].message = "no better point within 300 iterations";
  steps.push_back({HomotopyPhase::lpcc, "enumeration", 1e-10, 4, TurboCar::horizon, 2e-12, 0.0, {}, 0.002, ""});
  steps.push_back({HomotopyPhase::branch, "ipopt", 1e-10, 6, TurboCar::horizon, 3e-12, 0.0, {}, 0.02, ""});
  return steps;
}

inline result::Verification turbo_verification(const result::Trajectory& trajectory) {
  result::Verification verification;
  verification.tolerance = 1e-3;
  verification.interval_defect = 5e-8;
  verification.interval = 3;
  verification.state = "v";
  verification.switch_time_error = 2e-9;
  auto& open_loop = verification.open_loop;
  open_loop.end_state_error = 3.5e-5;
  open_loop.terminal_violation = 7.25e-3;
  open_loop.amplification = 12.5;
  for (std::size_t i = 0; i < trajectory.t.size(); ++i) {
    const double t = trajectory.t[i], off = 2e-5 * (std::exp(0.5 * t) - 1.0);
    open_loop.t.push_back(t);
    open_loop.x.push_back({trajectory.x[i][0] - off, trajectory.x[i][1] - 0.2 * off});
  }
  return verification;
}

inline void add_turbo_multipliers(result::Optimization& optimization) {
  optimization.multipliers = {{"q == 200", TurboCar::horizon, -0.04}, {"v == 0", TurboCar::horizon, 1.0 / 15.0}};
  for (const double t : optimization.grid) {
    const bool presses = t > 3.0 && t < 8.8;
    optimization.multipliers.push_back({"q - 30*t <= 5", t, presses ? 0.004 * (1.0 + std::sin(t)) : 0.0});
  }
}

inline result::Result turbo_car(int intervals = 20) {
  result::Result result;
  result.model = {"turbo-car",
                  "Car with a turbo above v = 10: 200 m from rest to rest in the shortest time.",
                  "00ff",
                  {{"k", 3.0}}};
  result.command = "optimize";
  result.method = "fesd";
  result.states = {"q", "v"};
  result.controls = {"u"};
  result.switching_functions = {"turbo"};
  result.elements = result::Elements{4, {{"turbo", result::SelectionForm::step}}, {}, {}, {}};
  auto& optimization = result.optimization.emplace();
  optimization.objective = optimization.horizon = optimization.terms.time = TurboCar::horizon;
  optimization.parameters = {{"k", 3.0}};
  for (int k = 0; k <= intervals; ++k) {
    const double from = TurboCar::horizon * k / intervals, to = TurboCar::horizon * (k + 1) / intervals;
    optimization.grid.push_back(from);
    optimization.nodes.push_back(TurboCar::state(from));
    if (k == intervals) break;
    optimization.u.push_back({TurboCar::piece(0.5 * (from + to)).u});
    const auto ends = element_ends(from, to);
    optimization.h.push_back({ends[1] - ends[0], ends[2] - ends[1], ends[3] - ends[2]});
    for (std::size_t e = 0; e < 3; ++e) add_turbo_element(result, ends[e], ends[e + 1], optimization.u.back());
  }
  constexpr double none = std::numeric_limits<double>::infinity();
  optimization.state_lower = {-none, -25.0};
  optimization.state_upper = {none, 25.0};
  optimization.control_lower = {-5.0};
  optimization.control_upper = {5.0};
  add_turbo_multipliers(optimization);
  optimization.homotopy = turbo_homotopy();
  optimization.certificate.primal_infeasibility = 3e-12;
  optimization.certificate.stationarity = 1e-11;
  optimization.certificate.stationarity_type = result::StationarityType::S;
  optimization.certificate.b_stationary = true;
  optimization.verification = turbo_verification(result.trajectory);
  optimization.statistics = {263, 1204, 1165, 240, 0.11, 0.35, 0.29, 0.83};
  optimization.primal = {0.1 + 0.2, 1.0 / 3.0, -0.0};
  optimization.dual_rows = {1e-300};
  optimization.dual_lower = {5e-324, 0.0, 1.0};
  optimization.dual_upper = {0.0, 1e22, 0.25};
  add_turbo_events(result);
  const auto& trajectory = result.trajectory;
  result.trajectory.outputs = {trajectory.t.size(), 0, {}};
  result.final = {trajectory.t.back(), trajectory.x.back(), trajectory.mode.back(), trajectory.alpha.back(), {}};
  result.status.time_reached = TurboCar::horizon;
  result.surfaces = {
      {"turbo", result::SurfaceRole::switching, {"v"}, false, result::AffineSurface{{1.0}, 0.0, -10.0}, {}, {}}};
  result.options = {{"optimize.scheme", std::string("radau_iia")},
                    {"optimize.stages", std::int64_t{2}},
                    {"optimize.control_intervals", std::int64_t{intervals}},
                    {"optimize.mpcc.tolerance", 1e-8}};
  return result;
}

}  // namespace saltus::report_samples
