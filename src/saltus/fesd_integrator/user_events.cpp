#include "saltus/fesd_integrator/user_events.hpp"

#include <cmath>

namespace saltus::fesd_integrator {
namespace {

std::vector<model::EventRule> rules(const std::vector<EventFact>& facts) {
  std::vector<model::EventRule> rules;
  for (const auto& fact : facts) rules.push_back(fact.rule);
  return rules;
}

}  // namespace

UserEvents::UserEvents(const discretization::PointFunctions& functions, const std::vector<EventFact>& facts)
    : functions_(functions),
      states_(rules(facts), model::EventStates::Order::by_entry),
      values_(functions.event_functions()),
      signs_(functions.event_functions(), 0) {}

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
  return states_.update(signs_, [&](std::size_t event, const double* steps) {
    return functions_.condition(event, t, x, selections, held, steps);
  });
}

}  // namespace saltus::fesd_integrator
