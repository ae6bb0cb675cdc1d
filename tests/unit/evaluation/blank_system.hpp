// What the systems of these tests have in common.
#pragma once

#include <string>

#include "saltus/model/system.hpp"

namespace saltus::evaluation {

/// Symbols of a system of two states a, b with a parameter p and an input u = p t.
inline model::System blank_system(double parameter, int surfaces) {
  using casadi::SX;
  model::System s;
  s.t = SX::sym("t");
  s.x = SX::sym("x", 2);
  s.u = SX::sym("u", 1);
  s.p = SX::sym("p", 1);
  s.alpha = SX::sym("alpha", surfaces);
  s.parameter_names = {"rate"};
  s.parameter_values = {parameter};
  s.state_names = {"a", "b"};
  s.control_names = {"u"};
  s.initial_state = {0.1, 0.2};
  s.input = s.p * s.t;
  return s;
}

}  // namespace saltus::evaluation
