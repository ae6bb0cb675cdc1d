// Jumps at one time: what was executed so far, and what is known of the point that they lead to.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/jumps/jumps.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/point/ledger.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/event_integrator/search/locate.hpp"

namespace saltus::event_integrator {

/// A JumpCascade begins at an event and lasts while jumps follow each other at that time. It knows which event
/// functions are at zero whatever is left of their values. It gives the guards of jumps the signs of the motion behind.
/// Its storage is used again by the next one.
class JumpCascade {
 public:
  JumpCascade(const SwitchingContext& switching_context, const Position& here, ModeField& field, EventSearch& search,
              Ledger& ledger, const Jumps& jumps, const Contacts& contacts, Holding& holding)
      : switching_context_(switching_context),
        kernel_(switching_context.kernel),
        here_(here),
        field_(field),
        search_(search),
        ledger_(ledger),
        jumps_(jumps),
        contacts_(contacts),
        holding_(holding),
        rates_(kernel_, here),
        slope_(here.x.size()) {}

  /// Begins a cascade where only the surfaces of the sliding mode are at zero.
  void begin();
  /// Begins a cascade at an event: what was located is at zero, too.
  void begin(const Located& located);

  [[nodiscard]] ReusedList<ExecutedJump>& executed() { return executed_; }
  [[nodiscard]] const ReusedList<ExecutedJump>& executed() const { return executed_; }
  /// Appends an execution, from this state and these activities.
  ExecutedJump& begin_execution(int jump, const std::vector<double>& x, const Activities& activities);
  /// Notes in the last execution, if there is one, that it leads here.
  void end_execution();
  /// Does this for a jump of contacts, with what they have resolved.
  void end_execution_of_contacts();
  [[nodiscard]] const std::vector<HeldGuard>& held_before() const { return held_before_; }
  /// Returns the jumps whose guards stay at zero from here on.
  [[nodiscard]] std::vector<int>& resting() { return resting_; }
  [[nodiscard]] const std::vector<int>& resting() const { return resting_; }
  /// Returns the transition into the mode behind.
  [[nodiscard]] Transition& transition() { return transition_; }
  /// Returns where conditions and values of jumps are read.
  [[nodiscard]] JumpPoint jump_point() const {
    return {here_.t, here_.x, here_.state.alpha, ledger_.signs(), ledger_.zeros()};
  }
  /// Returns what is left of a function that is at zero, or its value where the cascade began.
  [[nodiscard]] double zero_value(int function) const { return zero_values_[at(function)]; }
  [[nodiscard]] const Contacts& contacts() const { return contacts_; }
  /// Returns the largest |dg/dt| of a guard at this time.
  [[nodiscard]] double rate(int function) const { return largest_rates_[at(function)].value; }

  /// Notes how fast the guards of jumps move here.
  void note_guards();
  /// Drops the zeros that a jump has moved away.
  void drop_zeros();
  /// Reads the signs of all user functions at the point as it is. One that was located here and is still at zero keeps
  /// the sign just behind this time; one that a jump has put there has none yet (0).
  /// @param gaps  begun: modes of contacts begin here, and a gap that they have left open at 0 is at its zero
  enum class Gaps { kept, begun };
  void read_user_signs(Gaps gaps = Gaps::kept);
  /// Forgets motions along the mode before, as the mode is decided anew.
  void forget_motions() {
    motions_.assign(motions_.size(), std::nullopt);
    along_.known = false;
  }
  /// Gives functions that are at zero behind jumps the signs to which the motion takes them.
  void give_directions();
  /// Gives guards that are left in the mode that was entered here the sign to which they go. Before, what slid kept
  /// them at zero. They get it at this time and not where it is seen first. Gaps at zero that are open stay so.
  /// @param zero_order  of the mode's surfaces
  void leave_guards(const std::vector<int>& zero_order);

  /// Returns a jump that sets what it compares to where its condition becomes true, while the motion leads on through
  /// there: it would be executed again and again at this time. To be asked behind give_directions().
  [[nodiscard]] std::optional<int> endless_jump();

  struct RestingGuards {
    std::vector<HeldGuard> held, loose;  ///< by their own jumps; with others only
  };
  /// Returns the guards of executed jumps, and those held before, that were left at zero without a velocity and are
  /// pressed on.
  [[nodiscard]] RestingGuards pressed_guards();
  /// Returns the guards at zero that what slides keeps at rest: they are held as well, so that nothing has to be asked
  /// where sliding ends and the guard takes over. None where the guards alone do not keep all of that at zero.
  [[nodiscard]] std::vector<HeldGuard> guards_kept_by_sliding(const RestingGuards& others);

 private:
  [[nodiscard]] SwitchingPoint at_this_time() const;
  [[nodiscard]] int user_of(std::size_t place) const { return kernel_.switching_functions() + static_cast<int>(place); }
  void find_values();
  [[nodiscard]] bool is_open_at_zero(int function);
  [[nodiscard]] double time_resolution() const;
  [[nodiscard]] double resolution(int function) const;
  [[nodiscard]] bool is_unchanged(int function) const;
  [[nodiscard]] bool stays_at_zero(int function) const;
  [[nodiscard]] bool is_taken_back(const ExecutedJump& executed, int guard);
  [[nodiscard]] double size_at(int function);
  [[nodiscard]] Motion motion_of(int function);
  [[nodiscard]] Motion find_motion(int function);
  [[nodiscard]] std::vector<int> surfaces_keeping(int function);

  /// A guard that sliding kept at zero until this time, and where it goes.
  struct LeftGuard {
    int function;
    int side;
  };
  /// All functions of the kernel at one point.
  struct FunctionValues {
    std::vector<double> value, magnitude, slope;
  };

  const SwitchingContext& switching_context_;
  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  ModeField& field_;
  EventSearch& search_;
  Ledger& ledger_;
  const Jumps& jumps_;
  const Contacts& contacts_;
  Holding& holding_;
  FieldRates rates_;
  ReusedList<ExecutedJump> executed_;
  std::vector<double> zero_values_;  ///< what is left of functions at zero; of others their values at the beginning
  std::vector<Rate> largest_rates_;  ///< by event function: of guards of jumps at this time
  std::vector<std::optional<Motion>> motions_;  ///< by event function: found since the mode here was decided
  Contacts::Along along_;                       ///< the motion here
  std::vector<HeldGuard> held_before_;
  std::vector<LeftGuard> left_;
  std::vector<int> resting_;
  Transition transition_;
  FunctionValues values_;
  std::vector<double> slope_;  ///< of the field without what slides
};

}  // namespace saltus::event_integrator
