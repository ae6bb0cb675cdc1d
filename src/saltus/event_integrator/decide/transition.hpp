// From "these surfaces are at zero here" to the next mode: gathers projected fields, asks the switching, checks the
// answer.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_change.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/result/result.hpp"
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/table/group_decision.hpp"

namespace saltus::event_integrator {

/// Says why the mode is decided afresh.
struct SwitchingPoint {
  double t = 0.0;
  const double* x = nullptr;      ///< n_x, on all surfaces of `at_zero`
  std::vector<int> at_zero;       ///< surfaces with psi = 0 here, those of the mode's sliding set among them, ascending
  std::vector<int> touched;       ///< those of `at_zero` whose event this is
  std::vector<int> exit_below;    ///< sliding surfaces whose lower field was located as tangent (alpha = 0)
  std::vector<int> exit_above;    ///< sliding surfaces whose upper field was (alpha = 1)
  std::vector<int> coalesced;     ///< first surfaces of coupled groups whose sliding root ceases to exist here
  std::vector<int> destabilised;  ///< those of groups whose root loses its stability under every scaling
  std::vector<int> tied;          ///< of groups by `indicator`: all regions with the smallest one here
  bool start = false;             ///< no mode before
  bool limit = false;             ///< infinitely many switches have ended here (with `start`)
  double time_scale = 1.0;        ///< a step of the integrator: derivatives that do not move psi over it vanish

  /// Goes to a point where nothing is at zero yet; keeps the storage.
  void begin(double new_t, const double* new_x, double new_time_scale) {
    t = new_t;
    x = new_x;
    time_scale = new_time_scale;
    start = limit = false;
    for (auto* list : {&at_zero, &touched, &exit_below, &exit_above, &coalesced, &destabilised, &tied}) list->clear();
  }
};

/// Holds a mode of one surface that is given, with its selection if that is known.
struct GivenMode {
  int surface = 0;
  int mode = 0;
  double alpha = std::numeric_limits<double>::quiet_NaN();
};

/// Says where a solution that spirals out of an intersection of two surfaces has completed its first cycle.
struct SpiralStart {
  double duration = 0.0;
  std::vector<double> x;
  int surface = 0;  ///< on which x is
  double cycle_ratio = 0.0;
};

struct Transition {
  result::Termination termination = result::Termination::completed;  ///< completed = a mode was found
  std::string message;
  ModeState state;
  std::vector<double> beside;   ///< the point moved into the new regions by a few roundings
  std::vector<int> zero_order;  ///< n_psi: order in t of the zero of psi_j at this time along the new field, 0 = none
  std::optional<bool> unique = true;  ///< nullopt: not decided
  /// Modes of some surfaces, other than the chosen ones, that continue the solution: what other_continuations() starts
  /// from.
  std::vector<std::vector<GivenMode>> other_choices;
  std::optional<SpiralStart> beyond_spiral;  ///< the mode is the first region of a spiral: where to go on
  int rooted = -1;  ///< surface beside which the mode's field, or its own function, has an infinite derivative
  std::vector<Transition> alternatives;  ///< to the other admissible modes; these have no alternatives of their own
  long decision = -1;                    ///< its number in the run, of those with alternatives
  std::string reason;
  std::optional<Meeting> meeting;  ///< the first one decided here

  /// Returns what it changes in a mode; both have to last as long as the change.
  [[nodiscard]] ModeChange from(const ModeState& before) const {
    return {.mode_before = &before, .mode_after = &state, .zero_order = &zero_order, .transition = this};
  }
};

/// Says what the switching needs to know of the model besides its functions.
struct SwitchingContext {
  evaluation::ModelKernel& kernel;
  bool affine_in_alpha = true;
  switching::SelectionPolicy policy = switching::SelectionPolicy::active_dominant;
  std::vector<double> scaling;  ///< n_psi factors of the hidden dynamics under SelectionPolicy::scaled; empty = ones
  const model::Layout& layout = kernel.layout();
};

/// Adds what decided about a surface, unless its mode stays, or it is not one that the result lists (a kink, a time).
void append_reason(const model::Layout& layout, int surface, const switching::SurfaceDecision& decision,
                   const ModeState& before, const SwitchingPoint& switching_point, std::string& reason);

/// Appends, behind the names of two surfaces, what a tree decided about them, and why.
void append_leaf(switching::Leaf leaf, std::string_view why, std::string& reason);
/// Does the same with their names.
void append_meeting(const model::Layout& layout, const std::array<int, 2>& surfaces, switching::Leaf leaf,
                    std::string_view why, std::string& reason);

/// Makes of `transition`, whose storage is used again, the only one there is, with the mode as it was before: what is
/// decided without detours starts from it.
/// @param states  n_x
void begin_transition(const ModeState& before, const SwitchingPoint& switching_point, std::size_t states,
                      Transition& transition);

/// Decides the mode behind an event, or a start, at one point. Surfaces that do not influence each other are decided
/// one by one, the others in groups; switching functions nested around a surface that changes are read anew. Two that
/// influence each other are decided by the trees of switching/intersection.hpp; more, and what no tree decides, by the
/// hidden dynamics. The new mode is checked along its own field: it must move to where it says. Terminations:
/// outside_class (two-fold, psi stays 0, hidden dynamics without a limit), no_admissible_mode (the check failed),
/// evaluation_failed (fields undefined at the point).
[[nodiscard]] Transition decide_mode(const SwitchingContext& switching_context, const ModeState& before,
                                     const SwitchingPoint& switching_point);

/// Checks a mode that the user forces at the start along its own field, and nothing else.
[[nodiscard]] Transition check_forced_mode(const SwitchingContext& switching_context, const ModeState& forced,
                                           const SwitchingPoint& switching_point);

/// Returns the side of an event function, zero at `start`, to which the motion of a mode goes from there. Runge-Kutta
/// steps over a hundredth of the time scale tell; the side is 0 where they do not agree.
[[nodiscard]] int side_ahead(const SwitchingContext& switching_context, const ModeState& state,
                             const SwitchingPoint& switching_point, const std::vector<double>& start, int function);

/// Returns what to say where the equations of sliding are singular to half of the digits; nullopt where they are not.
/// Surfaces that influence each other may run into such a point. Its selections, and with them the motion, are
/// roundings.
[[nodiscard]] std::optional<std::string> lost_selections(const SwitchingContext& switching_context,
                                                         const ModeState& state, double t, const double* x);

/// Returns what to say where sliding has lost its selections, or has run into a point without any; nullopt if there is
/// none near by. At such a point both fields are tangent to the surface (two-fold), so that its selection has no limit.
/// Or the gradient of the surface vanishes there.
[[nodiscard]] std::optional<std::string> two_fold_message(const SwitchingContext& switching_context,
                                                          const ModeState& state, double t, const double* x);

}  // namespace saltus::event_integrator
