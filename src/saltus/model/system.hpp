// The model as a value: a piecewise-smooth system over step selections alpha, in CasADi expressions.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/model/cells.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/model/mechanics/contact_system.hpp"
#include "saltus/model/mechanics/drawn_shape.hpp"
#include "saltus/model/roles.hpp"

namespace saltus::model {

/// Holds psi_j(t, x, u, p, alpha_inner); alpha_inner are the selections of switching functions with smaller index
/// (nesting).
struct SwitchingFunction {
  std::string name;  ///< declared name, or the argument's text without spaces at its first place
  casadi::SX psi;    ///< scalar over t, x, u, p and the alphas of inner surfaces
  SwitchingRole role = SwitchingRole::listed;
  bool named = false;      ///< declared in [switching]
  std::vector<int> inner;  ///< indices of the switching functions whose alpha occurs in psi, ascending
  /// Role discrete: alpha where psi is 0, as written (1 for >=, 0 for >, 1/2 for step). Functions that are the same but
  /// for this are two. Other functions that depend on discrete states have the value of the first comparison that uses
  /// them: it counts where psi is identically 0 until a jump.
  double alpha_at_zero = 0.5;
  bool continuous = false;  ///< listed, though nothing jumps on its surface: an edge of a layer
  /// Returns whether f is the same on both sides: then nothing slides on the surface.
  [[nodiscard]] bool is_kink() const { return role == SwitchingRole::kink || continuous; }
};

/// Holds `when` of [[events]]: value = 0 is the event if `guards` is empty; otherwise a condition whose truth is the
/// polynomial `value` (0 or 1) in `guard_alpha` (step of each guard, decided as written at equality).
struct UserEvent {
  std::string name;  ///< given, or event1, event2, … by position
  bool named = false;
  casadi::SX value;        ///< scalar over t, x, u, p, alpha, and guard_alpha for a condition
  casadi::SX guards;       ///< differences of the comparisons over t, x, u, p, alpha; 0 x 1 for an expression
  casadi::SX guard_alpha;  ///< one symbol per guard
  std::vector<bool> true_at_equality;  ///< step(guard) counts as 1 where the guard is 0
  Direction direction = Direction::both;
  AtEvent action = AtEvent::record;
};

/// Holds one of [[jumps]]: x[targets] <- values when it is executed. Conditions hold pointwise, as in UserEvent:
/// `value` is a polynomial (0 or 1) in `guard_alpha`; a comparison that may stand at equality on discrete states (==,
/// !=) is two guards. A guard with a direction is guards = g (1 x 1) and no value.
struct Jump {
  std::string name;  ///< given, or jump1, jump2, … by position
  bool named = false;
  JumpTrigger trigger = JumpTrigger::condition;
  casadi::SX value;                    ///< trigger condition: over t, x, u, p, alpha, guard_alpha
  casadi::SX guards;                   ///< over t, x, u, p, alpha; 0 x 1 for times
  casadi::SX guard_alpha;              ///< one symbol per guard
  std::vector<bool> true_at_equality;  ///< step(guard) counts as 1 where the guard is 0
  std::vector<double> times;           ///< trigger times: `at`, ascending
  double every = 0.0;                  ///< trigger times: at from + k every, k = 1, 2, …; 0 without
  std::vector<int> targets;            ///< states that are set
  casadi::SX values;                   ///< one per target, over t, x, u, p and the alphas at the instant
  casadi::SX priority, delay;          ///< scalars over t, x, u, p and the alphas at the instant
  bool at_start = false;
  bool persistent = true;
  JumpValues evaluated = JumpValues::at_trigger;
  std::string forbidden;  ///< what its trigger means where that stops the run instead, with its first value; else empty
};

/// Holds a piece of an expression that is smooth in every cell of its argument: floor, a table, a sampled input. The
/// expressions of a System hold the symbols; whoever evaluates them keeps the constants of the cell in which the
/// argument is, and moves them where it leaves the cell.
struct Cell {
  std::string name;     ///< as written: "floor(t/T)", "road(x)"
  casadi::SX argument;  ///< scalar over t, x, u, p and the symbols of earlier cells
  casadi::SX symbols;   ///< column of the constants
  std::shared_ptr<const CellTable> table;
};

/// Holds a group of [[modes]], of which one holds at a time; its part of the right-hand side is in f.
///
/// By `when` the regions are unions of sign patterns. By `indicator` (Stewart's form [stewart1990]) region i is where
/// g_i is smallest. Where several are, their fields f_i mix with weights theta_i >= 0, sum_i theta_i = 1. Each region
/// is a switching function of role `region`,
///   psi_i = g_r - g_i,   alpha_i = theta_i,
/// against a region r of the group that is active, its reference: psi_i < 0 where i is not active, psi_i = 0 where it
/// is. What stands for theta_r in f is 1 less the others, so that the theta_i, i != r, are selections like any other.
struct ModeGroup {
  std::string name;  ///< empty for the group without a name
  int regions = 0;
  int first = -1;                         ///< by `indicator`: index of its first function in System::switching
  std::vector<std::string> mode_names{};  ///< by `indicator`: given, or mode1, mode2, …
  casadi::SX reference{};                 ///< by `indicator`: a symbol per region, 1 for the reference and 0 for others
};

struct TimeFreezing;  // time_freezing/time_freezing.hpp
class FrozenSystem;
struct Decisions;  // asked by find_stale (decisions.hpp)

/// Holds xdot = f(t, x, u, p, alpha), alpha_j in step(psi_j), with the constants of cells as further symbols. With
/// Inclusion::filippov f is multi-affine in the alphas of listed functions (those of kinks and time events are 0 or 1
/// wherever their value matters). All expressions are over the symbols t, x, u, p, alpha of this value. Units are the
/// model's. Structure (which functions exist, what folded, what is a kink) was decided with the parameter_values it was
/// built with; others may be set as long as they decide the same, which pipeline::simulate asks find_stale.
///
/// A branch of if, abs, max, min that can be NaN or infinite is guarded: alpha = 0 and 1 select a branch exactly, also
/// when the other is NaN. Take derivatives with respect to alpha as differences of corners. Do not differentiate a
/// guarded term at alpha = 0 or 1, where the branch not taken is missing from it.
struct System {
  std::string name;
  std::string description;
  Inclusion inclusion = Inclusion::filippov;

  std::vector<std::string> state_names, control_names, parameter_names, output_names;
  std::vector<double> initial_state;             ///< x(from)
  std::vector<double> state_lower, state_upper;  ///< +-infinity if absent
  std::vector<double> control_lower, control_upper;
  std::vector<double> control_initial;
  std::vector<double> parameter_values;

  casadi::SX t, x, u, p, alpha;  ///< scalar, n_x, n_u, n_p, n_psi columns of symbols
  casadi::SX f;                  ///< n_x, as used on surfaces (multi-affine in alpha with filippov)
  casadi::SX f_as_written;       ///< n_x, alpha as the user wrote it
  casadi::SX outputs;            ///< n_y
  casadi::SX input;              ///< n_u over t, p, alpha: u during a simulation
  casadi::SX input_at_instant;   ///< the same, as a jump reads it: comparisons are what their operators say of equality
  std::vector<SwitchingFunction> switching;
  std::vector<SwitchingColumn> columns;  ///< of the result: order of appearance, named ones first in file order
  std::vector<UserEvent> events;
  std::vector<Jump> jumps;
  std::vector<Cell> cells;            ///< arguments hold symbols of earlier ones only
  std::vector<bool> discrete_states;  ///< n_x: dynamics 0, changed by jumps only
  std::vector<ModeGroup> mode_groups;
  ContactSystem contacts;                        ///< empty unless bodies touch
  std::vector<DrawnShape> drawing;               ///< of the bodies
  std::shared_ptr<const TimeFreezing> freezing;  ///< of a system without jumps whose time stands still instead
  std::shared_ptr<const FrozenSystem> frozen;    ///< of one with contacts or hysteresis: the same, frozen
  std::shared_ptr<const Decisions> decisions;    ///< made with values of parameters; null: none

  bool multi_affine = true;                        ///< f_as_written is, in the alphas of listed functions, by its form
  std::vector<std::string> inclusion_differences;  ///< states where the two inclusions differ on a surface
  std::vector<std::string> warnings;               ///< of unused names, aliases and the like
};

}  // namespace saltus::model
