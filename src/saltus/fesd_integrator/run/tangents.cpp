#include "saltus/fesd_integrator/run/tangents_internal.hpp"

namespace saltus::fesd_integrator {

void Tangents::set_time_event(double t, std::optional<std::size_t> changing) {
  event_ = t;
  // At the end of the run nothing follows that could depend on it.
  changing_ = t < context_.options.until ? changing : std::nullopt;
}

void Tangents::chain(Chain& chain, std::size_t count, double end, const Condition* closing) {
  if (propagation_ == nullptr) return;
  const auto changing = changing_at(end);
  propagation_->chain({chain.elements().data(), count}, {chain.left().data(), count + 1}, position_.set(),
                      context_.held.data(), closing, changing);
  ends_fixed_ = closing == nullptr && !changing;
}

void Tangents::switched_here(const Condition& condition) {
  if (propagation_ == nullptr || !std::exchange(ends_fixed_, false)) return;
  propagation_->switched_here(position_.t(), position_.x(), position_.selections(), context_.held.data(),
                              position_.set(), condition);
}

void Tangents::begin_fixed_steps(int count, double end) {
  if (propagation_ == nullptr) return;
  propagation_->begin_fixed_steps(count, {end, position_.x().data(), context_.held.data(), changing_at(end)});
}

void Tangents::fixed_step(const Element& element, std::span<const ActiveSet> sets, double part) {
  if (propagation_ != nullptr) propagation_->fixed_step(element, sets, context_.held.data(), part);
}

void Tangents::held_changed(const double* before) {
  if (propagation_ == nullptr || !(position_.t() < context_.options.until)) return;
  propagation_->held_changed(position_.t(), position_.x().data(), position_.selections().data(), before,
                             context_.held.data());
}

}  // namespace saltus::fesd_integrator
