#include "saltus/event_integrator/search/user_events.hpp"

namespace saltus::event_integrator {
namespace {

std::vector<model::EventRule> rules(const model::Layout& layout) {
  std::vector<model::EventRule> rules;
  for (const auto& event : layout.events) rules.push_back(model::rule_of(event));
  return rules;
}

}  // namespace

UserEvents::UserEvents(const evaluation::ModelKernel& kernel)
    : kernel_(kernel),
      layout_(kernel.layout()),
      states_(rules(kernel.layout()), model::EventStates::Order::expressions_first) {}

std::vector<std::size_t> UserEvents::update(double t, const double* x, const std::vector<double>& alpha,
                                            const std::vector<int>& signs) {
  return states_.update(signs, [&](std::size_t event, const double* guard_alpha) {
    return kernel_.condition(static_cast<int>(event), t, x, alpha.data(), guard_alpha);
  });
}

bool UserEvents::is_compared(int function) const {
  int guards = 0;
  int first = kernel_.switching_functions();
  for (const auto& event : layout_.events) {
    guards += static_cast<int>(event.guards.size());
    first += event.is_condition() ? 0 : 1;
  }
  return function >= first && function < first + guards;
}

bool UserEvents::stops(std::size_t event) const { return layout_.events[event].action == model::AtEvent::stop; }

}  // namespace saltus::event_integrator
