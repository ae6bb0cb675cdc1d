// Dry friction in a plane as it is written in right-hand sides: along -w/|w|.
#pragma once

#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

/// Makes right-hand sides x' = f + B w/|w| contacts without a gap. Here w are two expressions of states, and B moves w
/// against itself. |w| is their hypot or the square root of the sum of their squares. The sides become x' = f - B r,
/// |r| <= 1. Where w is not 0, r = -w/|w|; where it is 0, r is what keeps it there. Appends their modes and jumps;
/// fills statement.contacts.
///
/// A norm in other places, as in the drag -|w| w, is left alone, and so is a model with contacts. Dynamics and initial
/// values of the states are known.
void state_written_friction(Recognition& recognition, Statement& statement);

}  // namespace saltus::model
