// Dynamic complementarity systems: what the discretisation gets of a model.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/base/error.hpp"
#include "saltus/linalg/int_matrix.hpp"
#include "saltus/model/system.hpp"
#include "saltus/reformulation/reformulation_options.hpp"

namespace saltus::reformulation {

/// Holds consecutive selections that belong together: all step selections are one part; every simplex of Stewart's form
/// is one part.
struct DcsPart {
  Form form = Form::step;
  int first = 0, count = 0;
  /// Step: one per selection. Stewart: those whose sign patterns are the regions, none with indicators of the user.
  std::vector<int> surfaces{};
  /// Stewart: rows regions, columns `surfaces`, entries -1 and 1. Every pattern is a region of its own: with zeros in
  /// S, g = -S psi would compare sums of different lengths. The smallest g would not have to be that of the region x is
  /// in.
  linalg::IntMatrix signs{};
  int mode_group = -1;  ///< Stewart, indicators of the user: index into System::mode_groups
};

/// Is psi = 0, whose sides a selection tells apart.
struct Surface {
  std::string name;   ///< of the switching function; with the sides of the surfaces inside it if it is nested
  int function = -1;  ///< index into System::switching, -1 for the break of a table
  int cell = -1;      ///< index into System::cells for the break of a table of the state
  casadi::SX psi;     ///< scalar over t, x, u, p, held
};

/// Holds what is constant within a simulation step and set from outside: selections of functions of time, inputs and
/// discrete states, the constants of cells (floor, mod, tables of time, sampled inputs).
struct HeldSymbol {
  enum class Kind {
    selection,  ///< 1 where `argument` > 0, 0 where it is < 0, `at_zero` where it is identically 0
    cell,       ///< constant number `column` of the cell of System::cells[index] in which `argument` lies
  };
  Kind kind = Kind::selection;
  int index = 0;         ///< into System::switching or System::cells
  int column = 0;        ///< of a cell's constants
  double at_zero = 0.5;  ///< of a selection
  casadi::SX argument;   ///< scalar over t, u, p, the discrete states of x, and held symbols before this one
};

/// States xdot = f(t, x, u, p, selection, lifted, held), the selections given by
///   step:     psi = lambda_p - lambda_n,  0 <= lambda_n _|_ alpha >= 0,  0 <= lambda_p _|_ 1 - alpha >= 0
///   stewart:  g - lambda + mu e = 0,  e'theta = 1,  0 <= lambda _|_ theta >= 0.
/// No selection occurs in psi or g: functions inside others are taken apart by
///   step(E[step(s)]) = step(s) step(E[1]) + (1 - step(s)) step(E[0]),
/// every E on the right is a surface of its own. Kinks are surfaces like any other: they need detection, too.
///
/// A branch that can be NaN or infinite is guarded as in model::System: exact where its weight is 0, but derivatives
/// with respect to a selection that is exactly 0 or 1 miss the branch that is not taken.
struct Dcs {
  casadi::SX t, x, u, p;  ///< the System's own symbols
  casadi::SX selection;   ///< alpha_j or theta_i, one symbol each
  casadi::SX lifted;      ///< beta; 0 x 1 without lifting
  casadi::SX held;        ///< values of `held_symbols`
  casadi::SX f;           ///< n_x
  casadi::SX indicator;   ///< one row per selection over t, x, u, p, held: psi_j or g_i
  casadi::SX lifting;     ///< one row per lifted variable, 0 = lifting(selection, lifted); row k is beta_k - product
  std::vector<DcsPart> parts;

  // Powers base^c, c in (0, 1), of what is zero on a surface: sqrt(|x|) sign(x). They are in f as odd functions of
  // their bases, which elements that end at the surface need. While the solution slides on it they are 0.
  casadi::SX roots;                    ///< symbols of their values; 0 x 1 without any
  casadi::SX root_bases;               ///< over t, x, u, p, held
  std::vector<double> root_exponents;  ///< c
  casadi::SX with_roots;               ///< f over these symbols, too; smooth where they are 0

  std::vector<Surface> surfaces;
  casadi::SX surface_alpha;  ///< alpha of each surface over `selection`
  std::vector<HeldSymbol> held_symbols;

  // The rest of the System in the same symbols.
  casadi::SX alpha;                      ///< System::alpha over selection, held: its columns are made of these
  casadi::SX outputs;                    ///< n_y over t, x, u, p, selection, held
  casadi::SX input;                      ///< n_u over t, p, held
  std::vector<model::UserEvent> events;  ///< values and guards over t, x, u, p, selection, held
};

/// Returns the dynamic complementarity system of a model. Groups of modes by `indicator` are Stewart parts in both
/// forms.
/// @return not_available for models with [[jumps]], for terms that unfold into more than 64 branches, and for what the
///         form does not cover; the message says what and the remedy what to use instead.
/// Cost: that of rebuilding the expressions once per branch of nested functions and per region of a group.
[[nodiscard]] Expected<Dcs> reformulate(const model::System& system, const ReformulationOptions& options = {});

}  // namespace saltus::reformulation
