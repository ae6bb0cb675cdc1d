// Small systems stated directly over the selections, without the model front end.
#pragma once

#include <string>
#include <vector>

#include "saltus/model/system.hpp"

namespace saltus::event_integrator::testing {

/// Symbols and empty lists for n states and m switching functions.
inline model::System blank(int states, int surfaces) {
  using casadi::SX;
  model::System s;
  s.t = SX::sym("t");
  s.x = SX::sym("x", states);
  s.u = SX(0, 1);
  s.p = SX(0, 1);
  s.alpha = SX::sym("alpha", surfaces);
  s.input = SX(0, 1);
  s.outputs = SX(0, 1);
  for (int i = 0; i < states; ++i) s.state_names.push_back("x" + std::to_string(i + 1));
  return s;
}

inline void add_surface(model::System& s, const std::string& name, const casadi::SX& psi) {
  model::SwitchingFunction function;
  function.name = name;
  function.psi = psi;
  function.named = true;
  s.columns.push_back({name, static_cast<int>(s.switching.size()), +1});
  s.switching.push_back(function);
}

inline void set_field(model::System& s, const std::vector<casadi::SX>& f, std::vector<double> initial) {
  s.f = casadi::SX::vertcat(f);
  s.f_as_written = s.f;
  s.initial_state = std::move(initial);
}

/// x' = a + b sgn x.
inline model::System sign_system(double a, double b, double start) {
  auto s = blank(1, 1);
  add_surface(s, "x", s.x(0));
  set_field(s, {a + b * (2 * s.alpha(0) - 1)}, {start});
  return s;
}

/// Stick-slip with one surface (Dieci & Lopez).
inline model::System stick_slip(double scale = 1.0) {
  auto s = blank(2, 1);
  const auto x1 = s.x(0);
  const auto x2 = s.x(1);
  add_surface(s, "slip", scale * (x2 - 0.2));
  const auto below = -x1 + 1 / (1.2 - x2);
  const auto above = -x1 - 1 / (0.8 + x2);
  set_field(s, {x2, (1 - s.alpha(0)) * below + s.alpha(0) * above}, {0.04, -0.01});
  return s;
}

/// Relay feedback with sliding segments (di Bernardo, Johansson, Vasca).
inline model::System relay() {
  auto s = blank(3, 1);
  const double w = 25;
  const double xi = 0.05;
  const auto x1 = s.x(0);
  add_surface(s, "x1", x1);
  const auto u = 2 * s.alpha(0) - 1;
  set_field(s, {-(2 * xi * w + 1) * x1 + s.x(1) - u, -(2 * xi * w + w * w) * x1 + s.x(2) + 2 * u, -w * w * x1 - u},
            {0, -0.001, -0.02});
  return s;
}

/// Three blocks with Coulomb friction (Stewart 1996): three additive friction laws.
inline model::System friction_blocks() {
  auto s = blank(6, 3);
  const auto q = [&](int i) { return s.x(i); };
  const auto v = [&](int i) { return s.x(3 + i); };
  const auto friction = [&](int i) { return 0.3 * (2 * s.alpha(i) - 1); };
  for (int i = 0; i < 3; ++i) add_surface(s, "v" + std::to_string(i + 1), v(i));
  set_field(s,
            {v(0), v(1), v(2), -q(0) + (q(1) - q(0)) - v(0) - friction(0),
             (q(0) - q(1)) + (q(2) - q(1)) - v(1) - friction(1), (q(1) - q(2)) - v(2) - friction(2)},
            {-1, 1, -1, -1, 1, 1});
  return s;
}

}  // namespace saltus::event_integrator::testing
