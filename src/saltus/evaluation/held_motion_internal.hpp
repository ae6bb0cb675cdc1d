// The motion while guards of jumps are held at 0: the limit of jumps whose intervals accumulate.
#pragma once

#include <string>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/base/error.hpp"

namespace saltus::evaluation {

/// Holds one held guard g and the jump it triggers, inputs put in.
struct HeldGuard {
  std::string jump;                   ///< its name, for errors
  casadi::SX guard;                   ///< g, scalar
  std::vector<int> targets;           ///< states that the jump sets
  casadi::SX values;                  ///< the new values of these states
  std::vector<bool> discrete_states;  ///< n_x
};

/// Holds xdot = f, and what holds its guards there.
struct HeldMotion {
  casadi::SX f;         ///< n_x
  casadi::SX pressure;  ///< one per guard, see ModelKernel::hold_pressure
};

/// Returns xdot = f + D mu with mu from d^2 g_i/dt^2 = 0 for all i:
///   d_k = (d set_k/dx - I) w_k,  w_k = d/dx (L_f g_k), rows and columns of the states that jump k sets and that
///   absorb, M_ik = d/dx (L_f g_i) d_k,  mu = -M^-1 L_f^2 g,  pressure_k = -M_kk mu_k.
/// A state absorbs if it moves, or if it is in the guard's rate. Where M is singular at a point (two guards that mean
/// the same), the motion is not finite there.
/// @return the motion, or why the jumped states cannot hold the guards: the message of an outside_class
[[nodiscard]] Expected<HeldMotion> held_motion(const casadi::SX& t, const casadi::SX& x, const casadi::SX& f,
                                               const std::vector<HeldGuard>& guards);

}  // namespace saltus::evaluation
