// Which active set continues the solution: at a switch, and where something held changes.
#include <utility>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run/diagnosis_internal.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

std::vector<Continuation> Run::continuations(const ActiveSet* before, const AtPoint& here) {
  return transition_.continuations({position_.t(), position_.x(), context_.held.data(), before, here.at_zero,
                                    position_.size(), length_.trial(), here.ended});
}

void Run::decide(const AtPoint& here, std::string_view reason, const Before& before, const double* held_before) {
  const double t = position_.t();
  if (!decisions_.add(t)) {
    if (go_to_limit(CycleSeries::Wanted::soon)) return;
    stop(result::Termination::not_converged,
         fmt::format("the modes at t = {:.10g} change without end; try other simulate.fesd.steps", t));
    return;
  }
  const auto found = continuations(&before.set, here);
  if (found.empty()) {
    if (go_to_limit(CycleSeries::Wanted::soon) || stopped_where_not_finite()) return;
    if (can_fall_back()) return decisions_.leave_open();
    stop(result::Termination::no_admissible_mode,
         fmt::format("no mode continues the solution at t = {:.10g}; try method = \"event\"", t));
    return;
  }
  recorder_.switched(t, position_.x(), {&before.set, &before.selections, held_before}, found, context_.held.data(),
                     reason);
  continue_with(found);
  chain_.interrupt();
  events_.fire_at_switch();
  status_.check_events(t, recorder_.events());
}

void Run::continue_with(const std::vector<Continuation>& found) {
  position_.continue_with(found.front());
  const bool all = std::all_of(found.begin(), found.end(), [](const auto& other) { return other.determined; });
  if (!all && !status_.has_remark()) status_.remark(undetermined_message(context_, position_, recorder_));
}

bool Run::stopped_where_not_finite() {
  if (transition_.finite()) {
    auto steep = steep_derivative(context_, position_, length_.nominal());
    if (steep) stop(result::Termination::evaluation_failed, std::move(*steep));
    return steep.has_value();
  }
  stop(result::Termination::evaluation_failed,
       fmt::format("indicators of regions are not finite at t = {:.10g}; change the state there or their expressions, "
                   "or take reformulation = \"step\" or method = \"event\"",
                   position_.t()));
  return true;
}

void Run::hold_behind() {
  HeldValues& held = context_.held;
  held_before_.assign(held.data(), held.data() + context_.facts.held.size());
  if (held.set_behind(position_.t(), length_.nominal(), position_.x().data()) == HeldValues::Change::none) return;
  tangents_.held_changed(held_before_.data());
  chain_.interrupt();
  const std::size_t events = recorder_.events();
  decide({}, "a function of time changed", before_here(), held_before_.data());
  if (stopped() || recorder_.events() > events || !recorder_.ends_at(position_.t())) return;
  // Inputs and outputs are continuous from the right: a row asked for has the values behind a break, steps have both.
  const bool both = context_.options.rows == IntegrationOptions::Rows::at_elements;
  recorder_.row_behind(both ? Recorder::RowBefore::kept : Recorder::RowBefore::replaced, position_.set(),
                       position_.selections(), held.data());
}

}  // namespace saltus::fesd_integrator
