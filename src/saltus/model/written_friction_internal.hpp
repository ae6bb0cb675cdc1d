// Dry friction in a plane as it is written in right-hand sides: along -w/|w|.
#pragma once

#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

/// Right-hand sides x' = f + B w/|w|, where w are two expressions of states, |w| their hypot or the square root of the
/// sum of their squares, and B moves w against itself, become contacts without a gap: x' = f - B r, |r| <= 1, with
/// r = -w/|w| where w is not 0, and there what keeps w at 0. Appends their modes and jumps; fills statement.contacts.
///
/// A norm in other places, as in the drag -|w| w, is left alone, and so is a model with contacts. Dynamics and initial
/// values of the states are known.
void state_written_friction(Recognition& recognition, Statement& statement);

}  // namespace saltus::model
