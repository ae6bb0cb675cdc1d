// A run in progress: the state of the engine between its sources. integrate.cpp begins and ends it, run_steps.cpp takes
// the steps, run_events.cpp handles what they meet, run_crossing.cpp what is ordinary among it, run_jumps.cpp,
// run_limits.cpp and run_resting.cpp jumps, their accumulation, and what is at rest behind it, run_spirals.cpp and
// run_shrinking.cpp the accumulation of switches, run_lines.cpp rows between steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/accumulate/switch_series.hpp"
#include "saltus/event_integrator/branches/families.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/decide/fast/single_surface.hpp"
#include "saltus/event_integrator/decide/fast/surface_pair.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
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
#include "saltus/event_integrator/run/output_rows.hpp"
#include "saltus/event_integrator/run/step_attempt.hpp"
#include "saltus/event_integrator/run/step_tolerances.hpp"
#include "saltus/event_integrator/search/cells.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/event_integrator/search/locate.hpp"
#include "saltus/event_integrator/search/user_events.hpp"
#include "saltus/ode/step_control.hpp"

namespace saltus::event_integrator {

/// Of an accumulation that is one at once.
inline constexpr const char* resting_reason =
    "the jump leaves its guard at 0 without a velocity: the limit of its sequence at once";

/// The run in progress: where it is, and the work spaces of its parts. One object per call of integrate().
class Run {
 public:
  /// How switches are decided and entered: the ordinary ones by the short way, or all by the one that covers
  /// everything.
  enum class Way { short_where_ordinary, general };

  Run(evaluation::ModelKernel& kernel, const model::System& system, const IntegrationOptions& options,
      const StepObserver& observer, Way way = Way::short_where_ordinary);

  CompactIntegration to_end();

 private:
  enum class Step { taken, shortened, failed };
  enum class Behind { any, higher_order };  ///< a limit of switches

  /// Of an event in hand, beside before_ and x_before_.
  struct Arrival {
    long events = 0;  ///< recorded before it
    OutputRows::Arrival row = OutputRows::Arrival::missing;
  };
  /// Limits of switches that follow each other at once.
  struct LimitsInARow {
    int count = 0;
    double last = 0.0;       ///< time of the last one
    double first_lap = 0.0;  ///< of the sequence before the first one
  };
  /// Jumps at one time: what was executed so far, and what is known of the point that they lead to.
  struct Landing {
    ReusedList<ExecutedJump> executed;
    std::vector<int> zeros;           ///< event functions that are at zero here whatever is left of their value
    std::vector<double> zero_values;  ///< what is left
    std::vector<Rate> rates;          ///< by event function: largest |dg/dt| of guards of jumps at this time
    std::vector<std::optional<Motion>> motions;  ///< by event function: found since the mode here was decided
    std::vector<HeldGuard> held_before;
    std::vector<int> resting;  ///< jumps whose guards stay at zero from here on
    Transition transition;
  };

  /// A function g inside ones that are slid on, which have a root of it: where |g / g'| was last seen to have halved.
  struct Nearing {
    int function = 0;
    std::vector<int> around;
    double t = 0.0;
    double ratio = infinity;
    double end = std::numeric_limits<double>::quiet_NaN();  ///< where g is 0, by what was seen until then
  };

  struct RestingGuards {
    std::vector<HeldGuard> held, loose;  ///< by their own jumps; with others only
  };

  bool begin();
  Step attempt();
  [[nodiscard]] std::optional<Located> surface_within_rounding();
  [[nodiscard]] std::optional<Located> rooted_surface_ahead(double until);
  [[nodiscard]] bool is_repelled(const Located& located);
  Step undefined_step();
  [[nodiscard]] std::string undefined_beyond();
  [[nodiscard]] std::vector<double> all_functions(double t, const double* x);
  void find_functions(double t, const double* x, std::vector<double>& values);
  [[nodiscard]] std::string undefined_function_beyond();
  Step accept(double t_new);
  Step handle(const Located& located);
  [[nodiscard]] bool has_ordinary_switches() const;
  [[nodiscard]] bool is_ordinary(const Located& located) const;
  bool switch_shortly(const Located& located);
  bool meet(const Located& located, int surface);
  bool pass(const Located& located, int surface);
  bool pass_across(const Located& located, int surface, const switching::PlaneAlpha& alpha);
  void pass_field(int surface, double alpha, double selection);
  bool begin_at(const Located& located);
  void look_at_both(const Located& located, int slid, int reached);
  void end_switch();
  bool leave(const Located& located, const EventFunction& exit);
  void go_on_behind(const Located& located, const SurfaceSwitch& change);
  void begin_search(const SurfaceSwitch& change);
  Arrival arrive(OutputRows::Arrival row);
  Step depart(const Arrival& arrival);
  [[nodiscard]] bool selections_jumped() const;
  void choose(Transition& transition);
  void choose_phase(Transition& transition);
  void note_choice(long decision);
  void begin_at_choice();
  Step leave_later();
  void watch_for_families();
  void look_for_families(double t_begin);
  [[nodiscard]] double next_departure() const {
    const double time = next_choice().departure();
    return time > here_.t ? time : infinity;
  }
  /// The next one of the choices that a run was asked for; one that never comes if there is none.
  [[nodiscard]] Choice next_choice() const {
    return next_choice_ < options_.choices.size() ? options_.choices[next_choice_] : Choice{-1};
  }
  /// Whether this is the alternative that the run was asked to go on with last.
  [[nodiscard]] bool chooses_here(const Transition& transition) const {
    return next_choice_ > 0 && transition.decision == chosen_ && !transition.alternatives.empty();
  }
  bool change_mode(const Located& located);
  const ModeState& slid_on_freed(Occasion& occasion);
  CellChange leave_cells(const Located& located);
  Located breaks_here();
  bool change_resting_with_cells();
  bool jump_with_cells();
  bool find_undefined_cells();
  bool go_on();
  bool enter(const Transition& transition);
  void begin_spiral();
  void leave_root();
  [[nodiscard]] int root_here();
  /// Where x and f are both 0 the step that was proposed says nothing.
  [[nodiscard]] double root_step() const { return std::max(1e-2 * here_.time_scale, 1e-8 * span()); }
  bool take_side_of_root();
  void settle_on_roots(const Located& located);
  void watch_nested_roots();
  void tighten_beside_nested_roots(double& atol, double& rtol);
  [[nodiscard]] std::optional<Located> nested_roots_ahead();
  [[nodiscard]] std::optional<double> end_of_nearing(Nearing& nearing);
  [[nodiscard]] std::optional<Located> at_nested_roots(double end, const std::vector<std::size_t>& reached);
  Step arrive_at_nested_roots(const Located& located);
  void leave_nested_root();
  void note_time_scale(double h);
  [[nodiscard]] bool keep_their_signs(const std::vector<double>& before, int surface, double t, const double* x);
  void note_tightening_switch();
  void note_tightening_switch(const SurfaceSwitch& change);
  void note_switch_rates();
  void follow_shrinking();
  void end_shrinking();
  void limit_beside_coalescence();
  void tighten_beside_roots(double h);
  void accumulate_switches();
  [[nodiscard]] std::optional<SeriesLimit> drowned_here() const;
  void go_on_from_drowned();
  bool hold_what_drowns();
  bool follow_dense_laps();
  bool follow_spiral(const SeriesLimit& limit, Behind wanted);
  bool limits_repeat(double t);
  void pass_to(double t, std::vector<double> x);
  void go_on_from_limit();
  std::vector<std::size_t> fire_user_events(const std::vector<double>& x_before, const ModeState& before,
                                            const std::vector<std::size_t>& before_jumps = {});
  void flip_user_functions(const Located& located);

  bool begin_jumps(Landing& landing);
  bool settle_at_start(Landing& landing);
  Step jump_in_time();
  bool jump(const ModeState& before, const std::vector<double>& x_before, Landing& landing);
  bool settle_jumps(Landing& landing);
  bool execute_jump(Landing& landing);
  bool begin_contacts(Landing& landing);
  bool move_contacts();
  void settle_contacts(const SeriesLimit& limit, const std::vector<double>& x_last, const ModeState& before);
  bool decide_behind_jumps(Landing& landing);
  bool hold_resting(Landing& landing);
  bool hold(std::vector<HeldGuard> guards, std::vector<HeldGuard> loose, Landing& landing);
  bool free_passing(Landing& landing);
  bool change_nothing(const std::vector<int>& jumps, Landing& landing);
  bool find_resting(RestingSurfaces& resting);
  std::vector<int> surfaces_keeping(int function);
  RestingGuards pressed_guards(Landing& landing);
  std::vector<HeldGuard> guards_kept_by_sliding(Landing& landing, const RestingGuards& others);
  void give_directions(Landing& landing);
  void leave_guards(Landing& landing);
  [[nodiscard]] Landing& landing_here();
  [[nodiscard]] Landing& landing_at(const Located& located);
  void find_values();
  void note_guards(Landing& landing);
  void note_series(const Landing& landing);
  void drop_zeros(Landing& landing);
  void read_user_signs(const Landing& landing);
  [[nodiscard]] double size_at(int function);
  [[nodiscard]] Motion motion_of(int function, Landing& landing);
  [[nodiscard]] Occasion at_this_time() const;
  [[nodiscard]] Motion find_motion(int function, const Landing& landing);
  bool release(const Located& located);
  void accumulate_jumps();
  void follow_limit(const SeriesLimit& limit);
  [[nodiscard]] std::string jump_names(const std::vector<int>& jumps) const;
  [[nodiscard]] JumpPoint jump_point() const { return {here_.t, here_.x, here_.state.alpha, search_.user_signs()}; }
  bool jumps_have_problem();
  void start_step();
  bool too_many_events();
  [[nodiscard]] double mean_interval(long first, long count) const;
  [[nodiscard]] double last_interval(long count) const;
  [[nodiscard]] long resolved_events(double farthest, double rounding) const;
  [[nodiscard]] std::optional<double> shrinking_exponent(long n) const;
  [[nodiscard]] bool has_one_rate(int surface);
  [[nodiscard]] std::string shrinking_laps();
  void accumulates();
  bool stopped_by_two_fold();
  bool stopped_by_singularity();
  bool shorten(double factor);
  void rows_until(double t_end);
  void rows_by_steps(double t_new);
  void rows_at_event(const Arrival& arrival);
  [[nodiscard]] bool reaches_cell_end(const Located& located) const;
  void fail(result::Termination termination, std::string message);
  void row(double t, const std::vector<double>& x) { rows_.write(t, x); }
  /// For the steps of the mode behind an event. While switches tighten no step is like one before.
  void restart_control() {
    steps_.restart_control(switch_laps_.empty() ? StepAttempt::Steps::may_repeat : StepAttempt::Steps::are_new);
  }
  [[nodiscard]] double span() const { return options_.until - options_.from; }
  [[nodiscard]] std::string where() const;

  evaluation::ModelKernel& kernel_;
  const IntegrationOptions& options_;
  const StepObserver& observer_;
  Surroundings surroundings_;
  ModeField field_;
  Position here_;
  FieldRates rates_;
  StepTolerances tolerances_;
  StepAttempt steps_;
  double closed_lap_ = 0.0;            ///< the last one that they closed
  std::vector<int> continued_roots_;   ///< surfaces whose regions' fields go on beyond them, less a root
  std::vector<int> ending_roots_;      ///< those whose regions' fields do not
  std::vector<Nearing> nearing_;       ///< of the mode
  double nearing_since_ = 0.0;         ///< its begin
  std::vector<double> nearing_slope_;  ///< a step before
  double nearing_step_ = 0.0;          ///< that step
  std::vector<double> rooted_values_;  ///< of event functions
  double first_lap_ = 0.0;             ///< duration of the first one that was closed
  LimitsInARow limits_in_a_row_;
  std::optional<SeriesLimit> drowned_;  ///< the limit that the switch in hand is
  Cells cells_;
  CellChange cell_change_ = CellChange::none;  ///< at the event being handled
  EventSearch search_;
  Locator locator_;
  SingleSurface single_surface_;
  SurfacePair surface_pair_;
  bool ordinary_ = false;  ///< the model and the options have nothing that a switch of one surface might concern
  FieldMemory field_memory_;
  std::vector<int> zero_order_;       ///< n_psi
  std::vector<double> slope_beyond_;  ///< of the region on the other side of a surface
  UserEvents user_events_;
  Jumps jumps_;
  Landing landing_;  ///< of the event in hand: its storage is used again
  /// All functions of the kernel at one point, while jumps are executed.
  struct FunctionValues {
    std::vector<double> value, magnitude, slope;
  };
  FunctionValues values_;
  std::vector<int> user_signs_;   ///< under construction, as are
  std::vector<bool> user_zeros_;  ///< these
  std::vector<int> executed_;     ///< jumps, in their order
  std::vector<int> freed_;        ///< surfaces that a guard has kept at zero, which was released by the event in hand
  Contacts contacts_;
  Holding holding_;
  EventSeries jump_series_;
  EventSeries switch_laps_;                  ///< of switches, by surface and mode behind, while they tighten
  std::vector<int> switch_labels_;           ///< of the switch in hand
  std::vector<double> shortest_switch_lap_;  ///< by the same: shorter laps drown in the rounding of psi
  std::vector<HeldGuard> last_guard_;        ///< by jump: the guard that was at zero when it was executed last
  std::vector<double> last_rate_;            ///< by jump: |dg/dt| then
  std::vector<double> shortest_lap_;         ///< by jump: shorter ones drown in the rounding of the guard
  Recorder recorder_;

  OutputRows rows_;
  std::vector<double> free_slope_;  ///< of a field that is asked for at the position

  ModeState before_;  ///< of the event being handled, as are the next four
  ModeState slid_;    ///< before_ with what a released guard has kept at zero slid on
  std::vector<double> x_before_;
  std::vector<long> cells_before_;
  Occasion occasion_;
  Transition transition_;
  std::optional<SpiralStart> spiral_start_;  ///< of the mode just entered: time and state jump over the first lap
  int rooted_ = -1;                          ///< of the mode just entered: the surface that it leaves along a root
  std::vector<std::size_t> all_searched_;    ///< the numbers of all functions that are searched
  std::vector<double> values_here_;          ///< of these
  std::optional<double>
      no_surface_at_;  ///< where surface_within_rounding() has found none, and nothing else has happened
  double root_tried_at_ = -infinity;
  bool undefined_ahead_ = false;  ///< of the last attempts one was undefined
  bool jumped_ = false;           ///< at the event in hand
  Families families_;
  long decisions_ = 0;  ///< with alternatives, or of spirals, so far
  long chosen_ = -1;    ///< the one at which the last choice was made
  std::size_t next_choice_ = 0;
  std::size_t choice_row_ = 0;
  result::Statistics before_choice_;
  double last_event_time_ = -infinity;
  long evaluations_before_;  ///< the kernel may have been used before
  SwitchSeries series_;
  CompactIntegration result_;
  bool running_ = true;
};

}  // namespace saltus::event_integrator
