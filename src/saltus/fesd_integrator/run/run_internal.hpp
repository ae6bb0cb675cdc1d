// One run: where it is, and how it goes on.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/accumulate/lap_series.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/fesd_integrator/element/fixed_element.hpp"
#include "saltus/fesd_integrator/integration.hpp"
#include "saltus/fesd_integrator/record/element_recorder.hpp"
#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/tangent/sensitivities.hpp"
#include "saltus/fesd_integrator/watch/coarseness.hpp"
#include "saltus/fesd_integrator/watch/held_values.hpp"
#include "saltus/fesd_integrator/watch/user_events.hpp"
#include "saltus/fesd_integrator/watch/watch.hpp"
#include "saltus/ode/straight_lines.hpp"

namespace saltus::fesd_integrator {

struct ElementGuess;
class StepProblem;

class Run {
 public:
  Run(const discretization::StageKernel& kernel, const discretization::PointFunctions& functions, const Facts& facts,
      const IntegrationOptions& options, const StepObserver& observer, SensitivityPropagation* propagation);
  [[nodiscard]] Integration run();

 private:
  /// Equal elements of one active set, solved one after the other.
  struct Chain {
    std::vector<Element> elements;
    std::size_t count = 0;                    ///< solved
    std::vector<std::vector<double>> left;    ///< selections at the left ends; of the right end of the last one behind
    std::vector<std::vector<double>> errors;  ///< of each, as Watch::errors
    std::vector<bool> determined;             ///< of each, ElementSolver::determined; where a problem has guessed it
  };
  enum class Solved { all, violated, missed, coarse, failed };
  /// Elements of length h from here, up to the first that violates a condition, jumps over a switch or is too coarse.
  [[nodiscard]] Solved solve_chain(int count, double h, Violation& violation);
  /// Whether a condition ends along elements of half that length, a quarter, …, as far as it may end between them.
  [[nodiscard]] bool jumps_over(const Point& left, double h, int halvings);
  /// Lengths such that `count` elements end where the condition does: h, or nullopt if it does not end there.
  [[nodiscard]] std::optional<double> locate(int count, double guess, const Violation& violation, double longest,
                                             TimeWarp warp);
  /// Warps of an element of length h that begins here, and of one that ends where a root of the mode at hand is zero,
  /// which it is inside `beyond`; 1 where no root is zero.
  [[nodiscard]] int warp_behind(double h);
  [[nodiscard]] int warp_before(const Element& beyond);
  struct Root;
  template <class Take>
  void for_each_root(double t, const double* x, Take&& take);
  struct Located {
    int count = 0;
    double h = 0.0;
    Condition condition;
    bool coarse = false;   ///< too coarse to be taken
    bool divides = false;  ///< what is behind is a step of its own: lengths cannot be within their bounds
  };
  /// The number of elements before a switch nearest to `count` with which all lengths are within step_bounds.
  [[nodiscard]] bool fits_bounds(int elements, double remaining, double tau, int& count) const;
  /// From the first violation of a trial to the chain that ends at the earliest switch; left in chain_.
  [[nodiscard]] std::optional<Located> find_switch(int elements, double remaining, Violation violation,
                                                   std::size_t element);

  /// Where the part of a simulation step that is tried next ends.
  [[nodiscard]] double part_end(double end);
  /// Whether an element's estimated error is beyond its share, and shorter ones are allowed; notes the share.
  [[nodiscard]] bool too_coarse(const Element& element, const std::vector<double>& errors);
  /// Length of parts behind elements of length h with the shares that were noted.
  void set_longest_part(double h, Solved solved);

  void start();
  /// One simulation step, or what lies between two changes of what is held.
  void advance(double end);
  /// `closing`: the condition that is zero at the end; nullptr if the end is fixed.
  void accept_chain(std::size_t count, double end_time, const Condition* closing);
  void accept(const Element& element, const std::vector<double>& left, const std::vector<double>& right, double end);
  /// Decides how to go on here; `at_zero` as in Decision.
  void decide(std::vector<int> at_zero, std::string_view reason, const ActiveSet& before,
              const std::vector<double>& selections_before, const double* held_before);
  /// Of the time of a switch in hand, by what closed the elements before it.
  [[nodiscard]] double resolution_of(const Condition& condition, const std::vector<double>& selections_before);
  /// Where elements have no solution any more: whether a selection that slides has met another root at its bound, with
  /// which it goes out of the real numbers. The run has gone on from there then.
  [[nodiscard]] bool left_at_double_root();
  /// What slides is on its surfaces, whatever its rounding.
  [[nodiscard]] std::vector<int> on_surfaces() const;
  [[nodiscard]] bool put_on_surfaces(const ActiveSet& set, double t, std::vector<double>& x);
  /// The same with d psi / dt = 0 of the surfaces that no selection moves at once, at most `farthest` away.
  [[nodiscard]] bool put_at_rest(const ActiveSet& set, double t, std::vector<double>& x, double farthest);
  /// Elements that resolve laps which shrink.
  void follow_laps();
  /// True if the run has gone on from the limit of a sequence of switches, before anything that is held changes.
  bool go_to_limit(LapSeries::Wanted wanted);
  void hold_behind();
  /// The same with fixed lengths.
  void advance_fixed(double end);
  struct FixedSpan {
    double t = 0.0;  ///< left end
    double h = 0.0;
    double end = 0.0;  ///< t + h but for roundings
  };
  /// One element or, where it has no solution that was found, halves of it (quarters, …).
  void advance_fixed_element(const FixedSpan& span);
  /// The same by the problem with complementarities of the whole step.
  void advance_by_problem(StepProblem& problem, double end);
  void advance_by_problem(StepProblem& problem, double end, int halvings_allowed);
  /// Without selections there are no active sets to find.
  [[nodiscard]] bool can_fall_back() const {
    return options_.fallback && propagation_ == nullptr && kernel_.selections() > 0;
  }
  /// What a derivative of the field that is not finite here (a root of zero) means for elements; nullopt: all are.
  [[nodiscard]] std::optional<std::string> steep_here();
  /// What is not finite a little further along the right-hand side, in words; nullopt if all is.
  std::optional<std::string> undefined_beyond();
  /// By the problem, because no active sets were found; stops with this where that is of no help.
  void fall_back(double end, result::Termination termination, std::string message);
  [[nodiscard]] bool solve_guessed(const std::vector<ElementGuess>& guesses, std::vector<ActiveSet>& sets);
  void selections_behind(const ElementGuess& guess, const ActiveSet& set, Point& left);
  void accept_guessed(const std::vector<ElementGuess>& guesses, const std::vector<ActiveSet>& sets, double end);
  void row_here();
  /// The point where the run is, as the left end of an element.
  [[nodiscard]] Point& begin_here() {
    left_.t = t_;
    left_.x = x_;
    left_.selections = selections_;
    left_.size = size_;
    return left_;
  }
  /// From here on in the first of these sets.
  void continue_with(const std::vector<Continuation>& found);
  [[nodiscard]] std::string coarse_message(const Coarseness::Worst& worst) const;
  /// Of the set where the run is: what slides on which nothing determines all selections.
  [[nodiscard]] std::string undetermined_message() const;
  void emit_times(const Element* element, const std::vector<double>& selections, double until);
  /// The same where times are those of the clock.
  void emit_clock_times(const Element& element, const std::vector<double>& selections, double until);
  /// Output times of an element: those that keep straight lines close to it.
  void choose_times(const Element& element, const std::vector<double>& selections);
  struct EventZero {
    std::size_t function = 0;
    double theta = 0.0;
  };
  /// Of an element in which zeros of event functions are looked for.
  struct Stretch {
    double from = 0.0, to = 1.0;
    int halvings = 0;           ///< that are left
    bool behind_zeros = false;  ///< what is zero where it begins was so before
  };
  void sample_events(const Element& element, const std::vector<double>& selections, const Stretch& part);
  [[nodiscard]] std::optional<EventZero> first_event_zero(const Element& element, const std::vector<double>& selections,
                                                          const Stretch& part);
  void settle_event_signs(const Element& element, const std::vector<double>& selections);
  void event_state(const Element& element, const std::vector<double>& selections, double theta);
  [[nodiscard]] bool project_selections(double t, const std::vector<double>& x);
  [[nodiscard]] double refined_event(const Element& element, const std::vector<double>& selections,
                                     const EventZero& zero, std::vector<double>& x, std::vector<double>& at);
  /// User events and output times of an element that is accepted; false if an event stops the run.
  [[nodiscard]] bool record_user_events(const Element& element, const std::vector<double>& left, double end);
  /// User events at a switch, behind it.
  void fire_events_here();
  /// Records events; true if one of them stops the run.
  bool fire(const std::vector<std::size_t>& fired, double t, const std::vector<double>& x,
            const std::vector<double>& selections);
  void stop(result::Termination termination, std::string message);
  [[nodiscard]] bool stopped() const { return status_.has_value(); }
  [[nodiscard]] bool stopped_where_not_finite();
  /// Counts an element; whether the run goes on.
  [[nodiscard]] bool step_counts();
  [[nodiscard]] bool within_max_steps();
  /// Counts a try that is divided. A run that gets no further ends, too, and tells its observer until then.
  void reject();
  void show_progress();

  const discretization::StageKernel& kernel_;
  const discretization::PointFunctions& functions_;
  const Facts& facts_;
  const IntegrationOptions& options_;
  const StepObserver& observer_;
  SensitivityPropagation* propagation_;  ///< nullptr if nobody asks for sensitivities
  ElementSolver solver_;
  Watch watch_;
  Transition transition_;
  ProjectedField projected_;
  SelectionMargins margins_;
  FixedElement fixed_;
  HeldValues held_;
  Recorder recorder_;
  std::optional<ElementRecorder> element_recorder_;
  UserEvents user_events_;

  /// Where what is held changes next, if that ends the part of a simulation step that is under way.
  struct TimeEvent {
    double t = 0.0;
    std::size_t changing = 0;
  };
  [[nodiscard]] std::optional<std::size_t> changing_at(double end) const {
    return time_event_ && time_event_->t == end ? std::optional(time_event_->changing) : std::nullopt;
  }

  double t_ = 0.0;
  std::vector<double> x_, selections_;
  ActiveSet set_;
  bool determined_ = true;                   ///< Continuation::determined of set_
  std::optional<std::string> undetermined_;  ///< what to say of the first set that was not
  /// Of the element that is solved, and of the one before it; members, so that steps do not allocate.
  Point left_;
  ActiveSet set_before_;
  std::vector<double> selections_before_;
  double size_ = 0.0;          ///< of the largest state of late
  double nominal_ = 0.0;       ///< length of a simulation step
  double mean_ = 0.0;          ///< length of elements of the part in hand
  double lap_part_ = 0.0;      ///< length of parts of simulation steps while laps shrink; 0: any
  double longest_part_ = 0.0;  ///< of a simulation step that is divided for its errors
  double share_ = 0.0;         ///< the largest of the chain in hand, Coarseness::share
  Chain chain_;
  Coarseness coarseness_;
  LapSeries laps_;
  discretization::StageValues at_switch_;
  discretization::RootValues at_roots_;
  std::vector<double> zero_roots_;
  int divided_for_look_ = 0;         ///< halvings of the step in hand because it jumped over a switch
  std::optional<Element> previous_;  ///< the last element, if the next one continues it
  int decisions_here_ = 0;
  double decided_at_ = 0.0;
  bool undecided_ = false;  ///< no mode was found to go on with: left to the fallback
  bool ends_fixed_ =
      false;  ///< the last chain of elements, with sensitivities: neither by a switch nor by a time event
  std::optional<TimeEvent> time_event_;
  std::size_t next_time_ = 0;  ///< in the times asked for, or in chosen_times_
  std::optional<ode::ColumnRanges> ranges_;
  ode::StraightLines lines_;
  std::vector<double> chosen_times_, tolerance_;
  std::vector<double> event_values_;
  Element shorter_;
  std::vector<double> between_x_, between_selections_, held_before_;
  result::Statistics statistics_;
  std::optional<result::Status> status_;
};

}  // namespace saltus::fesd_integrator
