// From "these surfaces are at zero here" to the next mode: gathers projected fields, asks the switching, checks the
// answer.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode_state.hpp"
#include "saltus/model/system.hpp"
#include "saltus/result/result.hpp"
#include "saltus/switching/group_decision.hpp"

namespace saltus::event_integrator {

/// Why the mode is decided afresh.
struct Occasion {
  double t = 0.0;
  const double* x = nullptr;    ///< n_x, on all surfaces of `at_zero`
  std::vector<int> at_zero;     ///< surfaces with psi = 0 here, those of the mode's sliding set among them, ascending
  std::vector<int> touched;     ///< those of `at_zero` whose event this is
  std::vector<int> exit_below;  ///< sliding surfaces whose lower field was located as tangent (alpha = 0)
  std::vector<int> exit_above;  ///< … upper field (alpha = 1)
  bool start = false;           ///< no mode before
  double time_scale = 1.0;      ///< a step of the integrator: derivatives that do not move psi over it vanish
};

/// A mode of all switching functions with its selections.
struct Continuation {
  std::vector<int> mode;
  std::vector<double> alpha;
};

struct Transition {
  result::Termination termination = result::Termination::completed;  ///< completed = a mode was found
  std::string message;
  ModeState state;
  std::vector<double> beside;   ///< the point moved into the new regions by a few roundings
  std::vector<int> zero_order;  ///< n_psi: order in t of the zero of psi_j at this time along the new field, 0 = none
  bool unique = true;
  /// Surfaces on which another mode than the chosen one continues the solution, with that mode: what
  /// other_continuations() starts from.
  std::vector<std::pair<int, int>> other_choices;
  std::vector<Continuation> alternatives;  ///< the other admissible modes as a whole
  std::string reason;
};

/// What the switching needs to know of the system besides its functions.
struct Surroundings {
  const evaluation::ModelKernel& kernel;
  const model::System& system;
  bool affine_in_alpha = true;
};

/// Adds what decided about a surface, unless its mode stays, or it is not one that the result lists (a kink, a time).
void append_reason(const model::System& system, int surface, const switching::SurfaceDecision& decision,
                   const ModeState& before, const Occasion& occasion, std::string& reason);

/// The mode behind an event, or a start, at one point.
/// Surfaces that do not influence each other are decided one by one, the others in groups; switching functions nested
/// around a surface that changes are read anew. The new mode is checked along its own field: it must move to where it
/// says. Terminations: outside_class (two-fold, psi stays 0, coupled surfaces), no_admissible_mode (the check failed),
/// evaluation_failed (fields undefined at the point).
[[nodiscard]] Transition decide_mode(const Surroundings& surroundings, const ModeState& before,
                                     const Occasion& occasion);

/// A mode that the user forces at the start: only the check along its own field.
[[nodiscard]] Transition check_forced_mode(const Surroundings& surroundings, const ModeState& forced,
                                           const Occasion& occasion);

/// What to say where sliding has run into a point at which both fields are tangent to the surface (two-fold), so that
/// its selection has no limit; nullopt if there is none near by.
[[nodiscard]] std::optional<std::string> two_fold_message(const Surroundings& surroundings, const ModeState& state,
                                                          double t, const double* x);

}  // namespace saltus::event_integrator
