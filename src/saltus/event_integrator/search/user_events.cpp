#include "saltus/event_integrator/search/user_events.hpp"

namespace saltus::event_integrator {
namespace {

std::vector<model::EventRule> rules(const model::System& system) {
  std::vector<model::EventRule> rules;
  for (const auto& event : system.events) rules.push_back(model::rule_of(event));
  return rules;
}

}  // namespace

UserEvents::UserEvents(const evaluation::ModelKernel& kernel, const model::System& system)
    : kernel_(kernel), system_(system), states_(rules(system), model::EventStates::Order::expressions_first) {}

std::vector<std::size_t> UserEvents::update(double t, const double* x, const std::vector<double>& alpha,
                                            const std::vector<int>& signs) {
  return states_.update(signs, [&](std::size_t event, const double* guard_alpha) {
    return kernel_.condition(static_cast<int>(event), t, x, alpha.data(), guard_alpha);
  });
}

bool UserEvents::is_compared(int function) const {
  int guards = 0;
  int first = kernel_.switching_functions();
  for (const auto& event : system_.events) {
    guards += static_cast<int>(event.guards.numel());
    first += model::rule_of(event).condition ? 0 : 1;
  }
  return function >= first && function < first + guards;
}

bool UserEvents::stops(std::size_t event) const { return system_.events[event].action == model::AtEvent::stop; }

}  // namespace saltus::event_integrator
