// A run: the composition of its parts, and the loop over steps and events. run.cpp begins and ends it, run_steps.cpp
// takes the steps, run_events.cpp handles what they meet, run_crossing.cpp what is ordinary among it; run_jumps.cpp,
// run_limits.cpp and run_resting.cpp jumps, their accumulation, and what is at rest behind it; run_spirals.cpp the
// limits of switches; run_rooted.cpp and run_nested_roots.cpp the way out of zeros, and into them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/accumulate/switch_series.hpp"
#include "saltus/event_integrator/approach/nested_zero_approach.hpp"
#include "saltus/event_integrator/approach/zero_approach.hpp"
#include "saltus/event_integrator/branches/families.hpp"
#include "saltus/event_integrator/cascade/jump_cascade.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/decide/fast/single_surface.hpp"
#include "saltus/event_integrator/decide/fast/surface_pair.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/field_memory.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/jumps/jumps.hpp"
#include "saltus/event_integrator/jumps/resting_surfaces.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/event_integrator/run/compact_integration.hpp"
#include "saltus/event_integrator/run/followed_choices.hpp"
#include "saltus/event_integrator/run/output_rows.hpp"
#include "saltus/event_integrator/search/cells.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/event_integrator/search/locate.hpp"
#include "saltus/event_integrator/search/user_events.hpp"
#include "saltus/event_integrator/sequences/jump_accumulation.hpp"
#include "saltus/event_integrator/sequences/switch_accumulation.hpp"
#include "saltus/event_integrator/steps/local_steps.hpp"
#include "saltus/event_integrator/steps/step_attempt.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"
#include "saltus/ode/step_control.hpp"

namespace saltus::event_integrator {

/// The reason of a jump with restitution 0: the limit of its sequence is reached at once.
inline constexpr const char* resting_reason =
    "the jump leaves its guard at 0 without a velocity: the limit of its sequence at once";

/// Owns the parts of a run and its position, which only it moves. There is one object per call of integrate().
class Run {
 public:
  /// Says how switches are decided and entered: the ordinary ones by the fast path, or all by the one that covers
  /// everything.
  enum class Way { fast_where_ordinary, full };

  Run(evaluation::ModelKernel& kernel, const IntegrationOptions& options, Way way = Way::fast_where_ordinary);

  /// Runs to the end, or until the observer, which is called behind every step, asks to stop.
  /// @param take  gets rows and events when there are many; the result has the last ones. May be empty.
  CompactIntegration to_end(const StepObserver& observer, const TakeRecording& take = {});

 private:
  enum class Step { taken, shortened, failed };
  enum class Behind { any, higher_order };  ///< a limit of switches

  /// Of the current event, beside before_ and x_before_.
  struct Arrival {
    long events = 0;  ///< recorded before it
    OutputRows::Arrival row = OutputRows::Arrival::missing;
  };
  bool begin();
  void record_start(const Start& start);
  Step attempt();
  Step beside_undefined(double t_new);
  Step reject(double error);
  [[nodiscard]] std::optional<Step> first_event(double t_new);
  /// A shorter attempt; where time does not resolve that, what is there.
  Step shorten_to(double factor) { return shorten(factor) ? Step::shortened : undefined_step(); }
  Step undefined_step();
  [[nodiscard]] std::string undefined_beyond();
  [[nodiscard]] std::string undefined_function_beyond();
  Step accept(double t_new);
  Step handle(const Located& located);
  [[nodiscard]] bool has_ordinary_switches() const;
  [[nodiscard]] bool is_ordinary(const Located& located) const;
  bool decide_ordinary(const Located& located, ModeChange& change);
  bool cross_by_rows(const Located& located, const EventFunction& reached, ModeChange& change);
  bool meet(const Located& located, const EventFunction& reached, ModeChange& change);
  bool leave(const Located& located, const EventFunction& exit, ModeChange& change);
  bool pass(const Located& located, const EventFunction& reached, ModeChange& change);
  void change_surface(int surface, int mode, double alpha, std::string_view reason, ModeChange& change) const;
  [[nodiscard]] const evaluation::FieldConstants& constants_beyond(int surface, double side);
  bool go_on_behind(const Located& located, const ModeChange& change);
  void keep_step(int surface);
  Arrival arrive(OutputRows::Arrival row);
  void follow_change_of_mode();
  void row_behind();
  void write_rows_behind(const Arrival& arrival, bool event);
  Step depart(const Arrival& arrival);
  [[nodiscard]] bool selections_jumped() const;
  Step leave_later();
  /// Where the next step must end at the latest: times of jumps are hit exactly, like the end.
  [[nodiscard]] double next_stop() const {
    return std::min({options_.until, jumps_.next_time(), choices_.next_departure()});
  }
  [[nodiscard]] FollowedChoices::Progress progress() const {
    auto statistics = outcome_.result.statistics;
    statistics.rhs_evaluations = kernel_.field_evaluations() - outcome_.evaluations_before;
    return {rows_.arrival(), statistics};
  }
  [[nodiscard]] SwitchAccumulation::Roots roots_of_cycles() const {
    return zeros_.any_ending() ? SwitchAccumulation::Roots::ending : SwitchAccumulation::Roots::none;
  }
  bool jumps_while_sliding(int surface);
  bool change_mode(const Located& located);
  bool collect_surfaces(const Located& located);
  const ModeState& touch_others();
  bool keep_mode_in_cells();
  const ModeState& slid_on_freed(SwitchingPoint& switching_point);
  CellChange leave_cells(const Located& located);
  Located breaks_here();
  bool change_resting_with_cells();
  bool leaves_resting_with_cells();
  [[nodiscard]] std::vector<bool> functions_in_moved_cells() const;
  bool jump_with_cells();
  bool find_undefined_cells();
  bool go_on();
  bool begin_field(const ModeChange& change, double t, std::vector<double>& x);
  [[nodiscard]] int state_moved_from(const std::vector<double>& met) const;
  bool enter(const Transition& transition);
  void begin_spiral();
  void leave_root();
  /// Where x and f are both 0 the step that was proposed says nothing.
  [[nodiscard]] double root_step() const { return std::max(1e-2 * here_.time_scale, 1e-8 * span()); }
  bool take_side_of_root();
  void project_onto_roots(const Located& located);
  Step arrive_at_nested_roots(const Located& located);
  void leave_nested_root();
  void note_time_scale(double h);
  void note_switch();
  void limit_beside_coalescence();
  void limit_beside_zeros(double h);
  void limit_beside_rest();
  void accumulate_switches();
  [[nodiscard]] std::optional<SeriesLimit> unresolved_here() const;
  void go_on_from_unresolved();
  bool hold_unresolved();
  bool follow_dense_cycles();
  bool follow_spiral(const SeriesLimit& limit, Behind wanted);
  void pass_to(double t, const std::vector<double>& x);
  void rows_to_limit(double t_last, const std::vector<double>& x_last, const std::vector<double>& x_limit,
                     const ModeState& before);
  void go_on_from_limit();
  std::vector<std::size_t> fire_user_events(const std::vector<double>& x_before, const ModeState& before,
                                            const std::vector<std::size_t>& before_jumps = {});
  void flip_user_functions(const Located& located);

  bool begin_jumps();
  bool settle_at_start();
  Step jump_in_time();
  bool jump(const ModeState& before, const std::vector<double>& x_before);
  bool settle_jumps();
  [[nodiscard]] std::vector<std::size_t> with_kinks_here(const std::vector<int>& touched) const;
  void turn_by_mode_behind(const Located& located);
  bool execute_jump();
  [[nodiscard]] ContactMoment contact_moment() const;
  [[nodiscard]] bool only_slips_on() const;
  bool begin_contacts();
  [[nodiscard]] bool begin_contacts_anew();
  [[nodiscard]] bool contacts_jump();
  void put_on_gaps(const Located& located);
  bool move_contacts();
  void choose_method();
  bool contact_modes_hold();
  void settle_contacts(const SeriesLimit& limit, const std::vector<double>& x_last, const ModeState& before);
  bool decide_behind_jumps();
  bool hold_resting();
  bool hold(std::vector<HeldGuard> guards, std::vector<HeldGuard> loose);
  bool free_passing();
  bool change_nothing(const std::vector<int>& jumps);
  bool find_resting(RestingSurfaces& resting);
  bool release(const Located& located);
  void accumulate_jumps();
  void follow_limit(const SeriesLimit& limit);
  [[nodiscard]] std::string jump_names(const std::vector<int>& jumps) const;
  [[nodiscard]] JumpPoint jump_point() const {
    return {here_.t, here_.x, here_.state.alpha, search_.user_signs(), cascade_.zeros()};
  }
  bool jumps_have_problem();
  void start_step();
  bool too_many_events();
  [[nodiscard]] std::string advice_on_steps();
  void accumulates();
  bool stopped_by_two_fold();
  bool stopped_by_mass();
  bool stopped_by_singularity();
  bool shorten(double factor);
  void rows_until(double t_end);
  void rows_by_steps(double t_new);
  void rows_at_event(const Arrival& arrival);
  [[nodiscard]] bool reaches_cell_end(const Located& located) const;
  void fail(result::Termination termination, std::string message);
  void row(double t, const std::vector<double>& x) { rows_.write(t, x); }
  /// For the steps of the mode behind an event. While cycles contract no step is like one before.
  void restart_control() {
    steps_.restart_control(switches_.empty() ? StepAttempt::Steps::may_repeat : StepAttempt::Steps::are_new);
  }
  [[nodiscard]] double span() const { return options_.until - options_.from; }
  [[nodiscard]] std::string where() const;
  /// Returns the states without those that only hold the modes of contacts.
  [[nodiscard]] std::span<const double> shown_state() const;

  /// The event that is handled now, or was last.
  struct CurrentEvent {
    ModeState before;  ///< the mode before it
    ModeState slid;    ///< that mode with what a released guard has kept at zero slid on
    std::vector<double> x_before;
    std::vector<long> cells_before;
    CellChange cell_change = CellChange::none;
    bool jumped = false;
    bool evaluated = false;         ///< the field of the mode behind it, where that begins, and nothing since
    bool listed_only = false;       ///< zeros of [[events]], which change nothing
    std::vector<int> last_bounces;  ///< jumps of contacts that end in it
    std::vector<int> freed;         ///< surfaces that a guard has kept at zero, which it has released
    SwitchingPoint switching_point;
    Transition transition;
    std::optional<SeriesLimit> unresolved;  ///< the limit that its switch is
    std::optional<SpiralStart> spiral;      ///< of the mode that it begins: time and state jump over the first cycle
    int rooted = -1;                        ///< of that mode: the surface that it leaves along a root
    double last_time = -infinity;           ///< of the last one that was recorded
  };
  /// What has come of the run so far.
  struct Outcome {
    CompactIntegration result = {};
    long evaluations_before = 0;  ///< the kernel may have been used before
    bool running = true;
  };
  /// What decides and enters ordinary switches without detours.
  struct FastSwitch {
    FastSwitch(const SwitchingContext& switching_context, const IntegrationOptions& options,
               const StepTolerances& tolerances)
        : single(switching_context),
          pair(switching_context),
          fields(switching_context.kernel),
          local(options, switching_context.kernel, tolerances),
          slope_beyond(at(switching_context.kernel.states())) {}
    SingleSurface single;
    SurfacePair pair;
    bool applies = false;  ///< the model and the options have nothing that a switch of one surface might concern
    FieldMemory fields;
    LocalSteps local;
    std::vector<double> slope_beyond;  ///< of the region on the other side of a surface
    std::vector<double> x;             ///< where the mode behind begins
    SlidAcross slid;                   ///< of the last change that had one
  };

  evaluation::ModelKernel& kernel_;
  const IntegrationOptions& options_;
  SwitchingContext switching_context_;
  ModeField field_;
  Position here_;
  StepTolerances tolerances_;
  StepAttempt steps_;
  Cells cells_;
  EventSearch search_;
  ZeroApproach zeros_;
  NestedZeroApproach nested_;
  SwitchAccumulation switches_;
  Locator locator_;
  FastSwitch fast_;
  UserEvents user_events_;
  Jumps jumps_;
  Contacts contacts_;
  Holding holding_;
  JumpCascade cascade_;
  JumpAccumulation jump_accumulation_;
  Recorder recorder_;
  OutputRows rows_;
  CurrentEvent event_;
  FollowedChoices choices_;
  Outcome outcome_;
};

}  // namespace saltus::event_integrator
