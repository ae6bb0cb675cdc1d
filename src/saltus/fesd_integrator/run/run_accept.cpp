// Elements that are taken: their rows, their events, and the position behind them.
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

void Run::accept(const Element& element, const std::vector<double>& left, const std::vector<double>& right,
                 double end) {
  rows_.begin_element(element, left);
  if (!events_.record(element, left, end)) return;
  if (element_recorder_) element_recorder_->add(element, left, right, end, position_.set(), context_.held.data());
  position_.move_to(end, element, right);
  if (status_.count_step(end)) events_.update_here();
}

void Run::accept_chain(std::size_t count, double end_time, const Condition* closing) {
  tangents_.chain(chain_, count, end_time, closing);
  for (std::size_t i = 0; i < count && !stopped(); ++i) {
    const Element& element = chain_.element(i);
    if (position_.is_determined()) coarseness_.note(element, chain_.errors(i));
    accept(element, chain_.left()[i], chain_.left()[i + 1], i + 1 == count ? end_time : element.t + element.h);
    if (i + 1 == count) break;
    rows_.emit_here();
  }
  chain_.continue_behind(count);
}

}  // namespace saltus::fesd_integrator
