// One run: its parts, and how it goes on from step to step and from switch to switch.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/fesd_integrator/accumulate/cycle_series.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/fesd_integrator/element/fixed_element.hpp"
#include "saltus/fesd_integrator/element/rest_projection.hpp"
#include "saltus/fesd_integrator/integration.hpp"
#include "saltus/fesd_integrator/record/element_recorder.hpp"
#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/run/chain_internal.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/decision_count_internal.hpp"
#include "saltus/fesd_integrator/run/element_interior_internal.hpp"
#include "saltus/fesd_integrator/run/event_tracker_internal.hpp"
#include "saltus/fesd_integrator/run/output_rows_internal.hpp"
#include "saltus/fesd_integrator/run/part_length_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/fesd_integrator/run/run_status_internal.hpp"
#include "saltus/fesd_integrator/run/switch_locator_internal.hpp"
#include "saltus/fesd_integrator/run/tangents_internal.hpp"
#include "saltus/fesd_integrator/watch/coarseness.hpp"

namespace saltus::fesd_integrator {

struct ElementGuess;
class StepProblem;

class Run {
 public:
  Run(const discretization::StageKernel& kernel, const discretization::PointFunctions& functions, const Facts& facts,
      const IntegrationOptions& options, const StepObserver& observer, SensitivityPropagation* propagation);
  [[nodiscard]] Integration run();
  /// Returns the elements of the run, if they were asked for.
  [[nodiscard]] std::vector<ElementPiece> take_pieces() { return rows_.take_pieces(); }

 private:
  void start();
  void take_elements();
  /// The continuation that agrees with IntegrationOptions::initial_mode, put first; false if there is none.
  [[nodiscard]] bool put_forced_first(std::vector<Continuation>& found) const;
  /// Functions at zero at the start, as the result counts them.
  [[nodiscard]] std::vector<int> functions_at_zero() const;
  [[nodiscard]] Integration take_integration();

  // run_step: a simulation step, or what lies between two changes of what is held.
  void advance(double end);
  /// The part of a simulation step that is tried next.
  struct StepPart {
    double end = 0.0;    ///< of the simulation step
    double limit = 0.0;  ///< of the part
    int elements = 0;    ///< that are left of it
  };
  [[nodiscard]] StepPart next_part(double end);
  /// A try of equal elements up to the limit of a part, and what is to be done about it.
  struct Attempt {
    enum class Outcome {
      all,        ///< every condition holds along them: they are accepted
      coarse,     ///< their errors are beyond their share: the part gets shorter
      crowded,    ///< more switches than elements can separate: the rest is a part of its own
      unsolved,   ///< no solution, or a switch was missed: the part is halved
      at_switch,  ///< a chain ends at a switch: it is accepted, and the next set decided
    };
    Outcome outcome = Outcome::all;
    double h = 0.0;  ///< of the elements of `all`, or those that are too coarse
    Located located = {};
  };
  [[nodiscard]] Attempt attempt(const StepPart& part);
  [[nodiscard]] Attempt attempt_before(const StepPart& part, const Violation& violation);
  void accept_part(StepPart& part, const Attempt& attempt);
  void refine_part(StepPart& part, double h);
  void halve_part(StepPart& part);
  void go_to_switch(StepPart& part, const Located& located);
  void accept_up_to(StepPart& part, const Located& located);
  void decide_at(StepPart& part, const Located& located);
  /// Where elements have no solution any more: whether a selection that slides has met another root at its bound, with
  /// which it goes out of the real numbers. The run has gone on from there then.
  [[nodiscard]] bool left_at_double_root();

  // run_decide: the sets that continue the solution.
  /// `at_zero` and `ended` as in Decision.
  struct Before {
    ActiveSet set;
    std::vector<double> selections;
  };
  [[nodiscard]] Before before_here() const { return {position_.set(), position_.selections()}; }
  struct AtPoint {
    std::vector<int> at_zero{};
    int ended = -1;
  };
  void decide(const AtPoint& here, std::string_view reason, const Before& before, const double* held_before);
  [[nodiscard]] std::vector<Continuation> continuations(const ActiveSet* before, const AtPoint& here);
  void continue_with(const std::vector<Continuation>& found);
  void hold_behind();
  [[nodiscard]] bool stopped_where_not_finite();

  // run_limits: switches that accumulate.
  /// How well the time of a switch is known that closed the elements before it.
  [[nodiscard]] double resolution_of(const Condition& condition, const std::vector<double>& selections_before);
  void note_switch(const Condition& condition, const Before& before);
  /// True if the run has gone on from the limit of a sequence of switches, before anything that is held changes.
  bool go_to_limit(CycleSeries::Wanted wanted);
  /// The set in which everything that a cycle changes rests, and what is at zero in it.
  struct Rest {
    std::vector<int> modes, at_zero;
  };
  [[nodiscard]] Rest rest_of(const CycleSeries::Limit& limit) const;

  // run_accept: elements that are taken.
  /// `closing`: the condition that is zero at the end; nullptr if the end is fixed.
  void accept_chain(std::size_t count, double end_time, const Condition* closing);
  void accept(const Element& element, const std::vector<double>& left, const std::vector<double>& right, double end);

  // run_fixed: without switch detection.
  void advance_fixed(double end);
  struct FixedSpan {
    double t = 0.0;  ///< left end
    double h = 0.0;
    double end = 0.0;  ///< t + h but for roundings
  };
  /// One element or, where it has no solution that was found, halves of it, or quarters, and so on.
  void advance_fixed_element(const FixedSpan& span);
  void accept_fixed(double end, double part);
  void stop_without_fixed_sets();

  // run_problem: by the problem with complementarities of the whole step.
  void advance_by_problem(StepProblem& problem, double end);
  void advance_by_problem(StepProblem& problem, double end, int halvings_allowed);
  /// Without selections there are no active sets to find.
  [[nodiscard]] bool can_fall_back() const {
    return context_.options.fallback && !tangents_.asked() && context_.kernel.selections() > 0;
  }
  /// By the problem, because no active sets were found; stops with this where that is of no help.
  void fall_back(double end, result::Termination termination, std::string message);
  /// The active sets of guessed elements, each solved again in its own.
  struct Guessed {
    std::vector<ActiveSet> sets;
    std::vector<bool> determined;  ///< ElementSolver::determined
  };
  [[nodiscard]] bool solve_guessed(const std::vector<ElementGuess>& guesses, Guessed& guessed);
  void selections_behind(const ElementGuess& guess, const ActiveSet& set, Point& left);
  void accept_guessed(const std::vector<ElementGuess>& guesses, const Guessed& guessed, double end);

  void stop(result::Termination termination, std::string message);
  [[nodiscard]] bool stopped() const { return status_.stopped(); }
  void reject() { status_.count_rejected(position_.t(), recorder_.events()); }

  RunContext context_;
  Position position_;
  RunStatus status_;
  PartLength length_;
  Coarseness coarseness_;
  Chain chain_;
  SwitchLocator locator_;
  Transition transition_;
  DecisionCount decisions_;
  CycleSeries cycles_;
  RestProjection rest_;
  FixedElement fixed_;
  Recorder recorder_;
  std::optional<ElementRecorder> element_recorder_;
  ElementInterior interior_;
  OutputRows rows_;
  EventTracker events_;
  Tangents tangents_;
  Before before_;  ///< of an element without switch detection; a member, so that steps do not allocate
  std::vector<double> held_before_;  ///< likewise
};

}  // namespace saltus::fesd_integrator
