#include <fmt/format.h>

#include "saltus/fesd_integrator/run/run_status_internal.hpp"

namespace saltus::fesd_integrator {

void RunStatus::stop(double t, result::Termination termination, std::string message) {
  if (!status_) status_ = result::Status{termination, std::move(message), t};
}

bool RunStatus::count_step(double t) {
  ++statistics_.steps;
  return within_max_steps(t);
}

void RunStatus::count_rejected(double t, std::size_t events) {
  ++statistics_.rejected;
  if (within_max_steps(t)) show_progress(t, events);
}

bool RunStatus::within_max_steps(double t) {
  if (statistics_.steps + statistics_.rejected < options_.max_steps) return true;
  stop(t, result::Termination::iteration_limit,
       fmt::format("max_steps = {} reached at t = {:.10g} ({} elements, {} tries that were divided); raise "
                   "simulate.max_steps or take fewer steps",
                   options_.max_steps, t, statistics_.steps, statistics_.rejected));
  return false;
}

void RunStatus::check_events(double t, std::size_t events) {
  if (static_cast<long>(events) < options_.max_events) return;
  stop(t, result::Termination::iteration_limit,
       fmt::format("max_events = {} reached at t = {:.10g}; raise simulate.max_events if they are meant",
                   options_.max_events, t));
}

void RunStatus::show_progress(double t, std::size_t events, std::span<const double> x) {
  if (stopped() || !observer_) return;
  const Progress progress{t, static_cast<long>(statistics_.steps), static_cast<long>(events), x};
  if (observer_(progress) == Continue::no) {
    stop(t, result::Termination::stopped_by_user, fmt::format("stopped at t = {:.10g}", t));
  }
}

void RunStatus::remark(std::string message) {
  if (!remark_) remark_ = std::move(message);
}

result::Status RunStatus::at_end(double t) const {
  auto status = status_.value_or(result::Status{result::Termination::completed, "", t});
  status.time_reached = t;
  if (!status_ && remark_) status.message = *remark_;
  return status;
}

}  // namespace saltus::fesd_integrator
