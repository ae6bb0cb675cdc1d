// Choices that a model states, and what its functions are to a run: words without expressions.
#pragma once

namespace saltus::model {

/// Names how f depends on its selections between the fields of two sides.
enum class Inclusion { filippov, aizerman_pyatnitskii };
enum class Direction { up, down, both };
enum class AtEvent { record, stop };

/// Says what turns a jump of [[jumps]] on (docs/model-file.md).
enum class JumpTrigger {
  condition,   ///< a condition becomes true
  guard_down,  ///< g < 0 becomes true
  guard_up,    ///< g > 0 becomes true
  guard_both,  ///< either
  times,       ///< given times
};
/// Says when the right-hand sides of `set` are evaluated.
enum class JumpValues { at_trigger, at_execution };

/// Says how a switching function takes part in a result.
enum class SwitchingRole {
  listed,      ///< makes a jump somewhere: column in the result, each change of sign is an event
  kink,        ///< nothing jumps on its surface: restart only (column if named)
  time_event,  ///< depends on time and controls only: restart only (column if named)
  discrete,    ///< depends on discrete states only: changes by jumps only, never slides; at zero it is as written
  region,      ///< of a mode by `indicator`: see ModeGroup; in no column
};

}  // namespace saltus::model
