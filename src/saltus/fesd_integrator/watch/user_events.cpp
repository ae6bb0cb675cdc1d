#include "saltus/fesd_integrator/watch/user_events.hpp"

#include <cmath>
#include <limits>

namespace saltus::fesd_integrator {
namespace {

std::vector<model::EventRule> rules(const std::vector<EventFact>& facts) {
  std::vector<model::EventRule> rules;
  for (const auto& fact : facts) rules.push_back(fact.rule);
  return rules;
}

/// Zeros are located to about this; a value that has a sign is further away at the end of an element.
constexpr double zero = 1e-13;

}  // namespace

UserEvents::UserEvents(const discretization::PointFunctions& functions, const std::vector<EventFact>& facts,
                       double span)
    : functions_(functions),
      states_(rules(facts), model::EventStates::Order::by_entry),
      values_(functions.event_functions()),
      values_before_(functions.event_functions()),
      span_(span),
      signs_(functions.event_functions(), 0),
      crossed_at_(functions.event_functions(), -std::numeric_limits<double>::infinity()) {}

/// Newton's method finds times of zeros to some hundred roundings.
double UserEvents::resolution(double t) const { return 1e-13 * (std::abs(t) + span_); }

std::vector<std::size_t> UserEvents::update(double t, const double* x, const double* selections, const double* held,
                                            std::optional<std::size_t> crossed) {
  if (t > t_) values_before_.swap(values_);
  t_ = t;
  functions_.event_values(t, x, selections, held, values_.data());
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (crossed == k) {
      signs_[k] = -signs_[k];
      crossed_at_[k] = t;
    } else if (std::abs(values_[k]) > zero && !crosses_at(k, t)) {
      signs_[k] = values_[k] > 0.0 ? 1 : -1;
    }
  }
  return changes(t, x, selections, held);
}

void UserEvents::settle(double t, const double* x, const double* selections, const double* held) {
  std::vector<double> values(signs_.size());
  functions_.event_values(t, x, selections, held, values.data());
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (signs_[k] == 0 && std::abs(values[k]) > zero) signs_[k] = values[k] > 0.0 ? 1 : -1;
  }
  static_cast<void>(changes(t, x, selections, held));
}

std::vector<std::size_t> UserEvents::changes(double t, const double* x, const double* selections, const double* held) {
  return states_.update(signs_, [&](std::size_t event, const double* steps) {
    return functions_.condition(event, t, x, selections, held, steps);
  });
}

}  // namespace saltus::fesd_integrator
