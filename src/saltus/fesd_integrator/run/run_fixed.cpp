// Without switch detection: elements of equal length, every stage with its own active set.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run/diagnosis_internal.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Of an element whose stages have no active sets that were found: across several switches there need not be any.
constexpr int most_halvings_of_element = 10;

}  // namespace

void Run::advance_fixed(double end) {
  // A time event inside a step divides it: the parts keep the mean length at most.
  const double begin = position_.t();
  const double steps = (end - begin) / length_.nominal();
  const int count = std::max(1, static_cast<int>(std::ceil(steps * context_.options.elements - 1e-9)));
  const double h = (end - begin) / count;
  tangents_.begin_fixed_steps(count, end);
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
    if (!fixed_.solve(position_.left_end(), fraction * span.h, position_.set(), context_.held.data(),
                      chain_.element(0))) {
      reject();
      part /= 2;
      if (part == 0 && !stopped()) stop_without_fixed_sets();
      continue;
    }
    done += part;
    const double right = span.t + span.h * (static_cast<double>(done) / static_cast<double>(whole));
    accept_fixed(done == whole ? span.end : right, fraction);
  }
}

void Run::accept_fixed(double end, double part) {
  before_.set = position_.set();
  before_.selections = position_.selections();
  interior_.take_stage_sets(fixed_.sets());
  tangents_.fixed_step(chain_.element(0), fixed_.sets(), part);
  accept(chain_.element(0), before_.selections, fixed_.end_selections(), end);
  if (stopped()) return;
  if (!(fixed_.end_set() == before_.set)) {
    recorder_.switched(end, position_.x(), {&before_.set, &before_.selections, context_.held.data()},
                       {{fixed_.end_set(), fixed_.end_selections()}}, context_.held.data(),
                       "seen at the end of an element");
  }
  position_.continue_with(fixed_.end_set(), fixed_.end_selections());
  rows_.emit_here();
}

void Run::stop_without_fixed_sets() {
  if (auto undefined = undefined_beyond(context_, position_, length_.nominal())) {
    stop(result::Termination::evaluation_failed, std::move(*undefined));
    return;
  }
  stop(result::Termination::not_converged,
       fmt::format("no active sets of the stages were found for the element at t = {:.10g}; more "
                   "simulate.timestepping.steps, or method = \"fesd\"",
                   position_.t()));
}

}  // namespace saltus::fesd_integrator
