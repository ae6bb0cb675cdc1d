// Without switch detection: elements of equal length, every stage with its own active set.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run_internal.hpp"

namespace saltus::fesd_integrator {

void Run::advance_fixed(double end) {
  // A time event inside a step divides it: the parts keep the mean length at most.
  const int count = std::max(1, static_cast<int>(std::ceil((end - t_) / nominal_ * options_.elements - 1e-9)));
  const double begin = t_, h = (end - t_) / count;
  if (propagation_ != nullptr) {
    propagation_->begin_fixed_steps(count, {end, x_.data(), held_.data(), changing_at(end)});
  }
  for (int i = 0; i < count && !stopped(); ++i) {
    const double right = i + 1 == count ? end : begin + (i + 1) * h;
    if (!fixed_.solve(begin_here(), h, set_, held_.data(), chain_.elements[0])) {
      stop(result::Termination::not_converged,
           fmt::format("no active sets of the stages were found for the element at t = {:.10g}; more "
                       "simulate.timestepping.steps, or method = \"fesd\"",
                       t_));
      return;
    }
    set_before_ = set_;
    selections_before_ = selections_;
    if (propagation_ != nullptr) propagation_->fixed_step(chain_.elements[0], fixed_.sets(), held_.data());
    accept(chain_.elements[0], selections_, fixed_.end_selections(), right);
    if (stopped()) return;
    if (!(fixed_.end_set() == set_before_)) {
      recorder_.switched(t_, x_, {&set_before_, &selections_before_, held_.data()},
                         {{fixed_.end_set(), fixed_.end_selections()}}, held_.data(), "seen at the end of an element");
    }
    set_ = fixed_.end_set();
    selections_ = fixed_.end_selections();
    row_here();
  }
}

}  // namespace saltus::fesd_integrator
