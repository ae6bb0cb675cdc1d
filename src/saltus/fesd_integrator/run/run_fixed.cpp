// Without switch detection: elements of equal length, every stage with its own active set.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Of an element whose stages have no active sets that were found: across several switches there need not be any.
constexpr int most_halvings_of_element = 10;

}  // namespace

void Run::advance_fixed(double end) {
  // A time event inside a step divides it: the parts keep the mean length at most.
  const int count = std::max(1, static_cast<int>(std::ceil((end - t_) / nominal_ * options_.elements - 1e-9)));
  const double begin = t_, h = (end - t_) / count;
  if (propagation_ != nullptr) {
    propagation_->begin_fixed_steps(count, {end, x_.data(), held_.data(), changing_at(end)});
  }
  for (int i = 0; i < count && !stopped(); ++i) {
    advance_fixed_element({begin + i * h, h, i + 1 == count ? end : begin + (i + 1) * h});
  }
}

void Run::advance_fixed_element(const FixedSpan& span) {
  // In units of the smallest part.
  constexpr long whole = 1L << most_halvings_of_element;
  long done = 0, part = whole;
  while (done < whole && !stopped()) {
    const double fraction = static_cast<double>(part) / static_cast<double>(whole);
    if (!fixed_.solve(begin_here(), fraction * span.h, set_, held_.data(), chain_.elements[0])) {
      reject();
      if (stopped()) return;
      part /= 2;
      if (part > 0) continue;
      if (auto undefined = undefined_beyond()) {
        stop(result::Termination::evaluation_failed, std::move(*undefined));
        return;
      }
      stop(result::Termination::not_converged,
           fmt::format("no active sets of the stages were found for the element at t = {:.10g}; more "
                       "simulate.timestepping.steps, or method = \"fesd\"",
                       t_));
      return;
    }
    done += part;
    const double right =
        done == whole ? span.end : span.t + span.h * (static_cast<double>(done) / static_cast<double>(whole));
    set_before_ = set_;
    selections_before_ = selections_;
    if (propagation_ != nullptr) propagation_->fixed_step(chain_.elements[0], fixed_.sets(), held_.data(), fraction);
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
