#include "saltus/event_integrator/user_events.hpp"

#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {

UserEvents::UserEvents(const evaluation::ModelKernel& kernel, const model::System& system)
    : kernel_(kernel), system_(system), places_(system.events.size()), state_(system.events.size(), 0) {
  // The kernel numbers the expressions first, then the guards of the conditions.
  int next = 0;
  for (std::size_t e = 0; e < places_.size(); ++e) {
    if (system.events[e].guards.numel() == 0) places_[e].push_back(next++);
  }
  for (std::size_t e = 0; e < places_.size(); ++e) {
    for (casadi_int g = 0; g < system.events[e].guards.numel(); ++g) places_[e].push_back(next++);
  }
}

std::vector<int> UserEvents::update(double t, const double* x, const std::vector<double>& alpha,
                                    const std::vector<int>& signs) {
  std::vector<int> fired;
  for (std::size_t e = 0; e < places_.size(); ++e) {
    const auto& event = system_.events[e];
    int now = 0;
    int change = 0;
    if (event.guards.numel() == 0) {
      now = signs[at(places_[e].front())];
      if (now == 0) continue;  // still at the zero it started from
      change = state_[e] == 0 ? 0 : now - state_[e];
    } else {
      std::vector<double> guard_alpha;
      for (std::size_t g = 0; g < places_[e].size(); ++g) {
        const int sign = signs[at(places_[e][g])];
        guard_alpha.push_back(sign > 0 || (sign == 0 && event.true_at_equality[g]) ? 1.0 : 0.0);
      }
      now = kernel_.condition(static_cast<int>(e), t, x, alpha.data(), guard_alpha.data()) ? 1 : 0;
      change = started_ ? now - state_[e] : 0;
    }
    state_[e] = now;
    const bool wanted = event.direction == model::Direction::both ||
                        (event.direction == model::Direction::up ? change > 0 : change < 0);
    if (change != 0 && wanted) fired.push_back(static_cast<int>(e));
  }
  started_ = true;
  return fired;
}

bool UserEvents::stops(int event) const { return system_.events[at(event)].action == model::AtEvent::stop; }

}  // namespace saltus::event_integrator
