// From what a run comes to at one time to the mode after it: modes begin here, but for those after ordinary switches.
#pragma once

#include <cstdint>
#include <vector>

#include "saltus/event_integrator/decide/fast/single_surface.hpp"
#include "saltus/event_integrator/decide/fast/surface_pair.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/instant/instant.hpp"
#include "saltus/event_integrator/instant/instant_context.hpp"
#include "saltus/event_integrator/instant/jump_cascade.hpp"
#include "saltus/event_integrator/instant/run_state.hpp"

namespace saltus::event_integrator {

/// ResolverClient is what the rest of a run has to say while an instant is resolved.
class ResolverClient {
 public:
  ResolverClient() = default;
  ResolverClient(const ResolverClient&) = delete;
  ResolverClient& operator=(const ResolverClient&) = delete;
  virtual ~ResolverClient() = default;

  /// Gives a decision its number, and makes it the alternative that was asked for.
  virtual void choose(Transition& transition) = 0;
  /// Returns whether that was asked for.
  [[nodiscard]] virtual bool is_chosen(const Transition& transition) const = 0;
  /// Notes a switch; returns false where the run ends with it.
  virtual bool note_switch(const ModeChange& change) = 0;
  /// Says what follows a switch that cannot be decided, or ends the run.
  virtual void leave_undecided(const Outcome& outcome) = 0;
  /// Begins a mode in what is not of the state: its steps, and what they run into.
  virtual void begin_mode() = 0;
  /// Returns the longest step behind the last event.
  [[nodiscard]] virtual double longest_step() const = 0;
};

/// The reason of a jump with restitution 0: the limit of its sequence is reached at once.
inline constexpr const char* resting_reason =
    "the jump leaves its guard at 0 without a velocity: the limit of its sequence at once";

/// Begins the field of the mode behind a change at a point that it moves onto the surfaces of that. Returns false where
/// it is not finite there; the slope here is that of the point.
bool begin_field(RunState& run, const ModeChange& change, double t, std::vector<double>& x);

/// A Resolver takes an instant through stages, until nothing changes: signs of what was located, jumps, ends of cells,
/// switching, guards at rest, signs behind, events of the user. Modes begin in one of these stages. It leaves the state
/// in the mode behind, or ends the run. Rows and events are written on the way.
class Resolver {
 public:
  Resolver(RunState& run, ResolverClient& client);

  /// Resolves the start; returns false where the run ends.
  bool start();
  /// Resolves an instant. Returns false where nothing has happened.
  bool resolve(const Instant& instant);

  /// Takes over what user functions turn to from a zero at the start: their first signs, not a change of them.
  void settle_signs();

  [[nodiscard]] Outcome& outcome() { return out_; }
  [[nodiscard]] const Outcome& outcome() const { return out_; }
  /// Returns the transition into the mode that has begun at this instant; null if none has.
  [[nodiscard]] const Transition* entered() const { return entering_.transition; }
  [[nodiscard]] JumpCascade& cascade() { return cascade_; }
  [[nodiscard]] SingleSurface& single() { return single_; }
  [[nodiscard]] SurfacePair& pair() { return pair_; }

 private:
  enum class Stage : std::int8_t {
    signs,          ///< of user functions that vanish
    cells,          ///< ends of them
    switching,      ///< the mode behind, from that before
    conclusion,     ///< one decision of those that are possible
    mode,           ///< begins
    switched,       ///< it has begun behind a switch
    changes,        ///< what a new mode changes: contacts, guards, events of the user
    before_jumps,   ///< events of the user, by the motion before
    jumps,          ///< all that are due
    mode_of_jumps,  ///< the mode behind, as at a start
    rest,           ///< guards that come to rest
    sides,          ///< to which the motion behind goes
    behind_jumps,   ///< whether that lasts
    done
  };
  /// Jumps that are being executed.
  struct Jumping {
    bool begun = false;
    bool rested = false;   ///< guards were asked whether they come to rest
    bool settled = false;  ///< nothing is due any more
    ModeState before;      ///< of the motion before them
    std::vector<double> x_before;
    std::vector<std::size_t> fired;  ///< events of the user by that motion
    result::Status stop;             ///< what these have said of the run
  };
  /// The mode that begins next.
  struct Entering {
    const Transition* transition = nullptr;
    Stage behind = Stage::done;
  };

  [[nodiscard]] InstantContext context() { return {run_, cascade_, out_}; }
  void run(Stage stage);
  Stage pass(Stage stage);
  Stage read_signs();
  Stage leave_cells();
  Stage decide();
  Stage conclude();
  Stage begin_mode();
  Stage record_switch();
  Stage follow_changes();
  Stage fire_before_jumps();
  Stage decide_behind_jumps();
  Stage hold_resting();
  Stage give_sides();
  void record_jumps();
  void take_over_events();
  [[nodiscard]] bool is_limit_of_jumps() const {
    return instant_ != nullptr && instant_->cause == Instant::Cause::limit_of_jumps;
  }
  Stage jump_from_here(bool of_mode_before);
  Stage enter(const Transition& transition, Stage behind);
  Stage enter_same(std::vector<int> zero_order);
  bool is_finite_here();
  [[nodiscard]] int state_moved_from(const std::vector<double>& met) const;
  [[nodiscard]] Start decide_first();
  bool stop_at_start();
  void record_start(std::vector<int> listed);
  void resolve_limit(const Instant& instant);
  void resolve_limit_of_jumps(const Instant& instant, const ModeState& before_last);
  void resolve_limit_of_switches(const Instant& instant);

  RunState& run_;
  ResolverClient& client_;
  JumpCascade cascade_;
  SingleSurface single_;
  SurfacePair pair_;
  Outcome out_;
  Jumping jumping_;
  Entering entering_;
  const Instant* instant_ = nullptr;  ///< that is resolved; null at the start
};

}  // namespace saltus::event_integrator
