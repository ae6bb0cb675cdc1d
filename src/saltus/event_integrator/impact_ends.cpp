#include "saltus/event_integrator/impact_ends.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/contact_functions.hpp"
#include "saltus/event_integrator/contact/contact_point.hpp"
#include "saltus/event_integrator/contact/impact.hpp"
#include "saltus/event_integrator/contact/impact_orders.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::event_integrator {
namespace {

/// The contacts where the impact is, with the velocities of a state.
ContactPoint contacts_with(const evaluation::ModelKernel& kernel, const result::Event& event,
                           const std::vector<double>& x, evaluation::ContactValues& values) {
  auto state = event.x;
  for (const int v : kernel.layout().velocities) state[at(v)] = x[at(v)];
  const std::vector<double> alpha(at(kernel.switching_functions()), 0.5);
  kernel.contacts(event.t, state.data(), alpha.data(), values);
  ContactPoint point;
  read_contacts(kernel.layout().contacts, values, point);
  return point;
}

/// Those whose gap is 0 to the errors of a located time.
std::vector<int> touching_in(const result::Event& event, const linalg::Vector& gaps) {
  constexpr double located = 1e-12;
  double size = 0.0;
  for (const double value : event.x) size = std::max(size, std::abs(value));
  std::vector<int> touching;
  for (linalg::Index i = 0; i < gaps.size(); ++i) {
    if (gaps(i) <= located * size) touching.push_back(static_cast<int>(i));
  }
  return touching;
}

}  // namespace

bool may_end_elsewhere(const evaluation::ModelKernel& kernel, const result::Event& event) {
  evaluation::ContactValues values;
  const auto before = contacts_with(kernel, event, event.x, values);
  const auto touching = touching_in(event, values.gap);
  if (touching.size() < 2) return false;
  const auto impulses = impact(before, touching);
  if (!impulses) return false;
  if (find_other_end(before, touching, *impulses)) return true;
  const linalg::Vector together = before.velocity + before.influence * *impulses;
  const auto after = contacts_with(kernel, event, event.x_after, values);
  constexpr double same = 1e-5;  // slips in a plane end at eps_t, and elements have errors
  return (after.velocity - together).max_abs() > same * before.velocity.max_abs();
}

}  // namespace saltus::event_integrator
