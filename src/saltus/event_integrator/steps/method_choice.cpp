#include "saltus/event_integrator/steps/method_choice.hpp"

#include <algorithm>

namespace saltus::event_integrator {
namespace {

using ode::Method;

/// In a row, as the test for stiffness asks for.
constexpr int enough_steps = 15;
/// Of the code RADAU of Hairer and Wanner: steps between two changes of the order, and the rates of convergence of
/// Newton's iteration that lead to them.
constexpr int least_age = 10;
constexpr double fast_rate = 0.002, slow_rate = 0.8;
/// Of the limit of stability, for explicit steps to return: less than the test for stiffness suspects.
constexpr double comfortable = 0.5;
/// Attempts without stages, each a quarter as long as the one before.
constexpr int most_failures = 6;

Method higher(Method method) { return method == Method::radau5 ? Method::radau9 : Method::radau13; }
Method lower(Method method) { return method == Method::radau13 ? Method::radau9 : Method::radau5; }

}  // namespace

Method first_method(std::size_t states, const ode::Tolerances& tolerances) {
  constexpr double loose = 1e-6;
  constexpr std::size_t many = 64;  // from here on local steps pay, of explicit pairs
  if (tolerances.rtol >= loose) return Method::dopri5;
  return states < many ? Method::taylor : Method::dop853;
}

MethodChoice::MethodChoice(const IntegrationOptions& options, const Position& here)
    : chooses_(options.chooses_method), here_(here), first_(options.method), now_{first_} {}

std::vector<MethodChoice::Known>::iterator MethodChoice::find_mode() {
  return std::find_if(known_.begin(), known_.end(), [&](const Known& known) { return known.mode == here_.state.mode; });
}

void MethodChoice::forget_steps() {
  stiffness_.reset();
  short_enough_ = failures_ = age_ = 0;
}

void MethodChoice::begin_mode() {
  forget_steps();
  if (known_.empty()) return;
  const auto found = find_mode();
  now_ = found != known_.end() ? found->state : State{now_.method};
}

void MethodChoice::change_to(Method method) {
  now_.method = method;
  forget_steps();
  if (const auto found = find_mode(); found != known_.end()) {
    found->state = now_;
  } else if (known_.size() < capacity) {
    known_.push_back({here_.state.mode, now_});
  } else {
    known_[next_] = {here_.state.mode, now_};
    next_ = (next_ + 1) % capacity;
  }
}

void MethodChoice::count(Method method, double h) {
  if (!chooses_) return;
  auto& use = uses_[static_cast<std::size_t>(method)];
  ++use.steps;
  use.time += h;
}

void MethodChoice::accepted(ode::Stepper& stepper, const ode::Tolerances& tolerances, bool watched) {
  failures_ = 0;
  if (stepper.follows()) return;
  if (!ode::is_implicit(stepper.method())) {
    if (watched) look_at_explicit(stepper, tolerances);
  } else if (chooses_ && now_.method == stepper.method()) {
    look_at_implicit(stepper);
  }
}

void MethodChoice::look_at_explicit(const ode::Stepper& stepper, const ode::Tolerances& tolerances) {
  const bool chooses = chooses_ && now_.may_be_implicit;
  if ((stiff_at_ && !chooses) || !stiffness_.looks_stiff(stepper, tolerances)) return;
  if (chooses) return change_to(Method::radau5);
  stiff_at_ = here_.t;
}

void MethodChoice::look_at_implicit(ode::Stepper& stepper) {
  short_enough_ = stepper.stability_ratio_of_explicit() < comfortable ? short_enough_ + 1 : 0;
  if (short_enough_ >= enough_steps) return change_to(first_);
  if (++age_ < least_age) return;
  const double rate = stepper.contraction();
  const Method wanted = rate <= fast_rate ? higher(now_.method) : rate >= slow_rate ? lower(now_.method) : now_.method;
  if (wanted != now_.method) change_to(wanted);
}

void MethodChoice::failed(ode::Stages stages) {
  if (!chooses_ || !ode::is_implicit(now_.method) || ++failures_ < most_failures) return;
  if (stages != ode::Stages::undefined) {
    now_.may_be_implicit = false;
    if (!failure_) failure_ = Failure{here_.t, now_.method, stages};
  }
  change_to(first_);
}

std::vector<result::IntegratorUse> MethodChoice::uses() const {
  std::vector<result::IntegratorUse> result;
  for (std::size_t k = 0; k < uses_.size(); ++k) {
    if (uses_[k].steps == 0) continue;
    result.push_back(uses_[k]);
    result.back().name = ode::name(static_cast<Method>(k));
  }
  return result;
}

}  // namespace saltus::event_integrator
