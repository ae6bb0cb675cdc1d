// The event functions of a mode: what they are, with which sign, and in which form.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/search/affine_forms.hpp"

namespace saltus::event_integrator {

enum class FunctionKind {
  surface,      ///< psi_j of a surface that is not in the mode
  nested,       ///< psi_j nested around sliding surfaces, in one of the regions that meet there
  exit_below,   ///< the lower field of a sliding surface stops arriving: alpha = 0
  exit_above,   ///< the upper field of a sliding surface stops arriving: alpha = 1
  loss,         ///< the sliding selection ceases to exist: its root and another one coalesce
  instability,  ///< the sliding selections of coupled surfaces lose their stability, (4.12) of [guglielmi2022]
  user,         ///< expression or guard of [[events]], guard of [[jumps]]
  release,      ///< what presses a held guard of [[jumps]]
  cell_upper,   ///< argument of floor, a table or a sampled input less the upper end of its cell
  cell_lower,   ///< such an argument less the lower end of its cell
  absent,       ///< a place of a surface or an exit that is not in the mode
};

struct EventFunction {
  FunctionKind kind = FunctionKind::surface;
  int index = 0;  ///< event function of the kernel; the surface for exits
  int row = 0;   ///< exits: position in the sliding set; releases: in the list of held guards; ends of cells: the cell;
                 ///< nested functions: their region
  int sign = 1;  ///< while the mode lasts; 0 = not known yet (user functions that start at zero)
  int zero_order = 0;   ///< of the zero at the start of the next step (left behind by an event), 0 = none
  double offset = 0.0;  ///< value left at that zero by rounding; subtracted until the function has moved away

  /// Returns whether it is the exit to one side of a sliding surface.
  [[nodiscard]] bool is_side() const { return kind == FunctionKind::exit_below || kind == FunctionKind::exit_above; }
  /// Returns whether a value, less the offset, is far enough from that zero not to be mistaken for it.
  [[nodiscard]] bool has_left(double value) const { return sign * value > 2.0 * std::abs(offset); }
};

/// Says what values of some functions are made of: event functions of the kernel, in the regions of nested ones, exits,
/// and what presses held guards. The others are thresholds.
struct FunctionParts {
  bool phi = false;
  bool nested = false;
  bool exits = false;
  bool pressure = false;
};

/// Holds the functions of one mode. Plain ones are surfaces, exits of surfaces that do not influence each other, and
/// user functions: each surface and each exit then has its place, in the mode or not, and a switch changes few of them.
struct ModeFunctions {
  explicit ModeFunctions(std::size_t states) : forms(states) {}

  ModeState state;
  std::vector<EventFunction> functions;
  std::vector<ExitValues> exits;
  AffineForms forms;
  std::vector<std::size_t> curved;  ///< functions without an affine form
  FunctionParts curved_parts;
  std::size_t users = 0;  ///< the user functions among them, and their end
  std::size_t users_end = 0;
  bool plain = false;
  double start = std::numeric_limits<double>::quiet_NaN();  ///< time at which the next step starts
  std::size_t present = 0;                                  ///< functions that are not absent
  std::vector<double> kept_states;  ///< of plain ones, by surface: what the forms of its exits hold
  std::vector<bool> prefilter;      ///< five samples may show that the function stays away from zero

  /// Returns whether a form of one state stands for function i wherever it is evaluated.
  [[nodiscard]] bool is_threshold(std::size_t i) const {
    const auto kind = functions[i].kind;
    return (kind == FunctionKind::surface || kind == FunctionKind::user) && forms.is_threshold(i);
  }
  [[nodiscard]] FunctionParts parts_of(const std::vector<std::size_t>& which) const;
  /// Returns the place of plain exits of a surface, below; that above follows it.
  [[nodiscard]] std::size_t exit_of(std::size_t surface) const { return state.mode.size() + 2 * surface; }
  void forget_zeros(const std::vector<std::size_t>& special);
  void turn(std::size_t surface, const ModeState& next, int zero_order);
  /// Puts a function in its place, or takes it away (absent), without a form.
  void put(std::size_t place, const EventFunction& function);
  /// Notes, behind its form, whether a function has to be sampled.
  void list_curved(std::size_t place);
};

}  // namespace saltus::event_integrator
