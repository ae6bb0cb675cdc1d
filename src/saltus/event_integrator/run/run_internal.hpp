// A run: the composition of its parts, and the loop over steps and instants. run.cpp begins and ends it, run_steps.cpp
// takes the steps, run_events.cpp passes what they meet to the Resolver, run_crossing.cpp what is ordinary among it;
// run_limits.cpp looks for the limits of sequences; run_rooted.cpp and run_nested_roots.cpp are the way out of zeros,
// and into them.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "saltus/evaluation/explanations.hpp"
#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/accumulate/switch_series.hpp"
#include "saltus/event_integrator/approach/nested_zero_approach.hpp"
#include "saltus/event_integrator/approach/zero_approach.hpp"
#include "saltus/event_integrator/field/field_memory.hpp"
#include "saltus/event_integrator/instant/resolver.hpp"
#include "saltus/event_integrator/instant/run_state.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/run/compact_integration.hpp"
#include "saltus/event_integrator/run/followed_choices.hpp"
#include "saltus/event_integrator/search/locate.hpp"
#include "saltus/event_integrator/sequences/contracting_cycles.hpp"
#include "saltus/event_integrator/sequences/jump_accumulation.hpp"
#include "saltus/event_integrator/sequences/switch_accumulation.hpp"
#include "saltus/event_integrator/steps/local_steps.hpp"
#include "saltus/event_integrator/steps/step_attempt.hpp"

namespace saltus::event_integrator {

/// Owns the parts of a run and its state. There is one object per call of integrate().
class Run : private ResolverClient {
 public:
  /// Says how switches are decided and entered: the ordinary ones by the fast path, or all by the one that covers
  /// everything; or what has come of each instant once more, which is the same.
  enum class Way { fast_where_ordinary, full, full_twice };

  Run(evaluation::ModelKernel& kernel, const IntegrationOptions& options, Way way = Way::fast_where_ordinary);

  /// Runs to the end, or until the observer, which is called behind every step, asks to stop.
  /// @param take  gets rows and events when there are many; the result has the last ones. May be empty.
  CompactIntegration to_end(const StepObserver& observer, const TakeRecording& take = {});

 private:
  enum class Step { taken, shortened };
  enum class Behind { any, higher_order };  ///< a limit of switches

  void choose(Transition& transition) override;
  [[nodiscard]] bool is_chosen(const Transition& transition) const override { return choices_.chooses(transition); }
  bool note_switch(const ModeChange& change) override;
  void leave_undecided(const Outcome& outcome) override;
  void begin_mode() override;
  [[nodiscard]] double longest_step() const override { return steps_.longest(); }

  bool begin();
  void take_steps(const StepObserver& observer, const TakeRecording& take);
  [[nodiscard]] bool observes(const StepObserver& observer) const;
  CompactIntegration finish();
  void pass_instants();
  void pass_zeros(const Located& located);
  void pass(const Instant& instant);
  void start_steps(const Instant& instant);
  void look_for_limits();
  void come_to(const Located& located);
  void come_to(Located&& located) { come_to(next_.located = std::move(located)); }
  void come_to(Instant::Cause cause);

  Step attempt();
  Step beside_undefined(double t_new);
  Step reject(double error);
  [[nodiscard]] std::optional<Step> first_event(double t_new);
  /// A shorter attempt; where time does not resolve that, what is there.
  Step shorten_to(double factor);
  void leave_undefined();
  [[nodiscard]] std::string undefined_beyond();
  [[nodiscard]] std::string undefined_function_beyond();
  void count_step(double h);
  void accept(double t_new);
  void come_to_end_of_step(double h);

  [[nodiscard]] bool has_ordinary_switches() const;
  [[nodiscard]] bool is_ordinary(const Located& located) const;
  bool decide_ordinary(const Located& located, ModeChange& change);
  bool cross_by_rows(const Located& located, const EventFunction& reached, ModeChange& change);
  bool meet(const Located& located, const EventFunction& reached, ModeChange& change);
  bool leave(const Located& located, const EventFunction& exit, ModeChange& change);
  bool pass_beside(const Located& located, const EventFunction& reached, ModeChange& change);
  void change_surface(int surface, int mode, double alpha, std::string_view reason, ModeChange& change) const;
  [[nodiscard]] const evaluation::FieldConstants& constants_beyond(int surface, double side);
  bool go_on_behind(const Located& located, const ModeChange& change);
  void keep_step(int surface);

  /// Where the next step must end at the latest: times of jumps are hit exactly, like the end.
  [[nodiscard]] double next_stop() const {
    return std::min({run_.options.until, run_.jumps.next_time(), choices_.next_departure()});
  }
  [[nodiscard]] FollowedChoices::Progress progress() const;
  [[nodiscard]] SwitchAccumulation::Roots roots_of_cycles() const {
    return zeros_.any_ending() ? SwitchAccumulation::Roots::ending : SwitchAccumulation::Roots::none;
  }
  void leave_later();
  void begin_spiral();
  void leave_root();
  /// Where x and f are both 0 the step that was proposed says nothing.
  [[nodiscard]] double root_step() const {
    constexpr double of_span = 1e-8;
    return std::max(look_ahead(run_.here.time_scale), of_span * run_.span());
  }
  void take_side_of_root();
  void begin_same_mode(int zero);
  void resolve_again();
  void project_onto_roots(const Located& located);
  void arrive_at_nested_roots(Located located);
  void leave_nested_root();
  void note_time_scale(double h);
  void limit_beside_coalescence();
  void limit_beside_zeros(double h);
  void choose_method();

  void accumulate_switches();
  [[nodiscard]] std::optional<SeriesLimit> unresolved_here() const;
  void go_on_from_unresolved();
  bool hold_unresolved();
  bool follow_dense_cycles();
  bool follow_spiral(const SeriesLimit& limit, Behind wanted);
  void accumulate_jumps();
  void follow_limit_of_jumps(const SeriesLimit& limit);

  void start_step();
  bool too_many_events();
  [[nodiscard]] std::string advice_on_steps();
  [[nodiscard]] std::string advice_on_stiffness() const;
  void accumulates();
  bool stopped_by_two_fold();
  bool stopped_by_singularity();
  bool shorten(double factor);
  void rows_until(double t_end);
  void rows_by_steps(double t_new);
  /// For the steps of the mode behind an event. While cycles contract no step is like one before.
  void restart_control() {
    steps_.restart_control(switches_.empty() ? StepAttempt::Steps::may_repeat : StepAttempt::Steps::are_new);
  }
  [[nodiscard]] Outcome& event() { return resolver_.outcome(); }
  [[nodiscard]] const Outcome& event() const { return resolver_.outcome(); }

  /// What is passed next, and what of it needs a place of its own.
  struct Next {
    const Located* zeros = nullptr;         ///< located; or
    std::optional<Instant> instant;         ///< something else
    Located located;                        ///< zeros that no step has met
    bool departs = false;                   ///< the next decision leaves a mode as a member of a family
    std::optional<SeriesLimit> unresolved;  ///< the limit that a switch is which cannot be decided

    [[nodiscard]] bool any() const { return zeros != nullptr || instant; }
  };
  /// What decides and enters ordinary switches without detours.
  struct FastSwitch {
    explicit FastSwitch(const RunState& run)
        : fields(run.kernel), local(run.options, run.kernel, run.tolerances), slope_beyond(at(run.kernel.states())) {}
    bool applies = false;  ///< the model and the options have nothing that a switch of one surface might concern
    FieldMemory fields;
    LocalSteps local;
    std::vector<double> slope_beyond;  ///< of the region on the other side of a surface
    std::vector<double> x;             ///< where the mode behind begins
    SlidAcross slid;                   ///< of the last change that had one
  };

  Way way_;
  RunState run_;
  Resolver resolver_;
  StepAttempt steps_;
  ZeroApproach zeros_;
  NestedZeroApproach nested_;
  Locator locator_;
  FastSwitch fast_;
  SwitchAccumulation switches_;
  JumpAccumulation jump_accumulation_;
  FollowedChoices choices_;
  Next next_;
  result::Statistics statistics_;
  long evaluations_before_;  ///< the kernel may have been used before
};

}  // namespace saltus::event_integrator
