#include "saltus/fesd_integrator/user_events.hpp"

#include <cmath>

namespace saltus::fesd_integrator {

UserEvents::UserEvents(const discretization::PointFunctions& functions, const std::vector<EventFact>& facts)
    : functions_(functions),
      facts_(facts),
      values_(functions.event_functions()),
      signs_(functions.event_functions(), 0),
      states_(facts.size(), 0) {}

std::vector<std::size_t> UserEvents::update(double t, const double* x, const double* selections, const double* held,
                                            std::optional<std::size_t> crossed) {
  // Zeros are located to about this; a value that has a sign is further away at the end of an element.
  constexpr double zero = 1e-13;
  functions_.event_values(t, x, selections, held, values_.data());
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (crossed == k) {
      signs_[k] = -signs_[k];
    } else if (std::abs(values_[k]) > zero) {
      signs_[k] = values_[k] > 0.0 ? 1 : -1;
    }
  }
  std::vector<std::size_t> fired;
  std::size_t place = 0;
  for (std::size_t e = 0; e < facts_.size(); ++e) {
    const auto& fact = facts_[e];
    int now = 0, change = 0;
    if (!fact.condition) {
      now = signs_[place++];
      if (now == 0) continue;  // still at the zero it started from
      change = states_[e] == 0 ? 0 : now - states_[e];
    } else {
      std::vector<double> steps;
      for (const bool true_at_equality : fact.true_at_equality) {
        const int sign = signs_[place++];
        steps.push_back(sign > 0 || (sign == 0 && true_at_equality) ? 1.0 : 0.0);
      }
      now = functions_.condition(e, t, x, selections, held, steps.data()) ? 1 : 0;
      change = started_ ? now - states_[e] : 0;
    }
    states_[e] = now;
    if (change != 0 && (fact.direction == 0 || fact.direction * change > 0)) fired.push_back(e);
  }
  started_ = true;
  return fired;
}

}  // namespace saltus::fesd_integrator
