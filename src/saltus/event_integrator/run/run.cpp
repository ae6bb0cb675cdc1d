#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/stop.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

Run::Run(evaluation::ModelKernel& kernel, const IntegrationOptions& options, Way way)
    : way_(way),
      run_(kernel, options),
      resolver_(run_, *this),
      steps_(options, kernel.layout(), run_.field, run_.here, run_.tolerances),
      zeros_(run_.switching, run_.here, run_.field, run_.search),
      nested_(kernel, run_.here, run_.search, run_.tolerances, zeros_),
      locator_(kernel.states(), steps_.stepper(), run_.field, run_.search, run_.tolerances.step()),
      fast_(run_),
      switches_(run_.switching, run_.here, run_.span(), run_.tolerances),
      jump_accumulation_(run_.switching, run_.here),
      choices_(run_.switching, options, run_.here, run_.recorder),
      evaluations_before_(kernel.field_evaluations()) {
  fast_.applies = way == Way::fast_where_ordinary && has_ordinary_switches();
}

FollowedChoices::Progress Run::progress() const {
  auto statistics = statistics_;
  statistics.rhs_evaluations = run_.kernel.field_evaluations() - evaluations_before_;
  return {run_.rows.arrival(), statistics};
}

/// The start, and the first step. A mode may begin along a root there.
bool Run::begin() {
  if (!resolver_.start()) return false;
  Position& here = run_.here;
  if (!run_.jumps.none()) jump_accumulation_.note(resolver_.cascade(), run_.jumps);
  start_step();
  here.time_scale = here.h;
  const auto& orders = event().transition.zero_order;
  if (event().rooted < 0 && std::any_of(orders.begin(), orders.end(), [](int order) { return order > 1; })) {
    event().rooted = zeros_.root_here();
    if (event().rooted >= 0) take_side_of_root();
    if (!run_.running) return false;
  }
  here.h = steps_.memory().change(here.state.mode, here.t, here.h);
  run_.rows.skip_here();
  if (run_.recorder.events() > 0) choices_.watch(run_.field);
  return true;
}

CompactIntegration Run::to_end(const StepObserver& observer, const TakeRecording& take) {
  // Inside of a decision that lasts, too.
  const StopScope scope([&] { return observer && !observes(observer); });
  try {
    take_steps(observer, take);
  } catch (const Stopped&) {
    run_.end(Termination::stopped_by_user, fmt::format("stopped at {}", run_.where()));
  }
  return finish();
}

bool Run::observes(const StepObserver& observer) const {
  return observer({run_.here.t, static_cast<long>(statistics_.steps), run_.recorder.events(), run_.here.x}) ==
         Continue::yes;
}

/// One step at a time, and the instants that it meets.
void Run::take_steps(const StepObserver& observer, const TakeRecording& take) {
  const Position& here = run_.here;
  bool goes_on = begin();
  while (goes_on && run_.running && here.t < run_.options.until) {
    if (statistics_.steps + statistics_.rejected >= run_.options.max_steps) {
      run_.end(Termination::iteration_limit,
               fmt::format("max_steps = {} reached at {}{}", run_.options.max_steps, run_.where(), advice_on_steps()));
      break;
    }
    if (event().spiral) begin_spiral();
    if (event().rooted >= 0) leave_root();
    if (next_.any()) pass_instants();
    if (!run_.running || here.t >= run_.options.until) break;
    const double h = std::max(here.h, 2.0 * here.smallest_step());
    steps_.begin(run_.options.max_step ? std::min(h, *run_.options.max_step) : h);
    while (run_.running && attempt() == Step::shortened) {
    }
    if (next_.any()) pass_instants();
    if (run_.running && observer && !observes(observer)) {
      run_.end(Termination::stopped_by_user, fmt::format("stopped at {}", run_.where()));
    }
    if (take && run_.recorder.has_many()) take(run_.recorder.hand_over());
  }
}

/// What a run returns, with a row where it ends.
CompactIntegration Run::finish() {
  const Position& here = run_.here;
  if (!run_.recorder.ends_at(here.t)) run_.row(here.t, here.x);
  CompactIntegration result;
  result.status = std::move(run_.status);
  // Beside a two-fold point steps are short for another reason.
  const bool limited = result.status.termination != result::Termination::outside_class;
  if (const auto stiff_at = steps_.choice().stiff_at(); limited && stiff_at) {
    result.status.message += fmt::format("{}the model looks stiff from t = {:.6g} on: {}",
                                         result.status.message.empty() ? "" : "; ", *stiff_at, advice_on_stiffness());
  }
  result.status.time_reached = here.t;
  result.statistics = statistics_;
  result.statistics.integrators = steps_.choice().uses();
  result.statistics.thinned_from = run_.rows.thinned_from();
  result.statistics.rhs_evaluations = run_.kernel.field_evaluations() - evaluations_before_;
  choices_.families().close(here.t);
  result.recording = run_.recorder.take();
  result.recording.families = choices_.families().take();
  result.chosen = choices_.begin_at_choice(result.recording, result.statistics);
  result.pieces = run_.rows.take_pieces(result.recording.row_times);
  return result;
}

/// What may help where explicit steps are limited by stability; of a choice, what it has tried.
std::string Run::advice_on_stiffness() const {
  const auto& failure = steps_.choice().failure();
  if (!failure) return "integrator = \"auto\" or \"radau5\" may need far fewer steps";
  return fmt::format("{} was tried, and found no stages at t = {:.6g}: {}; steps are explicit from there on",
                     ode::name(failure->method), failure->t, ode::reason(failure->stages));
}

/// What may help where all steps are used up.
std::string Run::advice_on_steps() {
  std::string norm = evaluation::vanishing_norm(run_.kernel, run_.here.t, run_.here.x);
  if (!norm.empty()) return norm;
  const std::string cycles = ContractingCycles(run_.switching, run_.here, run_.recorder).describe();
  const std::string raise = "; raise simulate.max_steps if they are meant";
  if (!cycles.empty()) return "; " + cycles;  // more steps are of no use
  const bool explicit_steps = !run_.options.chooses_method && !ode::is_implicit(run_.options.method);
  const bool is_told = steps_.choice().stiff_at().has_value();  // at the end of the message
  return raise + (explicit_steps && !is_told ? ", or try --integrator radau5: the model may be stiff" : "");
}

}  // namespace saltus::event_integrator
