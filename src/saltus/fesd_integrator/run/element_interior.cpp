#include "saltus/fesd_integrator/run/element_interior_internal.hpp"

namespace saltus::fesd_integrator {

void ElementInterior::go_to(const Element& element, const std::vector<double>& selections, double theta) {
  context_.solver.interpolate(element, theta, x_.data());
  if (!project(element.t + theta * element.h, x_, selections)) selections_ = selections;
}

bool ElementInterior::project(double t, const std::vector<double>& x, const std::vector<double>& guess) {
  selections_ = guess;
  const ActiveSet& set = position_.set();
  if (set.sliding().empty()) return true;
  if (!context_.projected.solve(t, x.data(), set, context_.held.data(), selections_.data())) return false;
  if (!set.balances().empty()) {
    margins_.evaluate(set, field_view(context_.projected.values()), selections_.data());
  }
  return true;
}

}  // namespace saltus::fesd_integrator
