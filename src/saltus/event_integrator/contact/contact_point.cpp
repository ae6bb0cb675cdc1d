#include "saltus/event_integrator/contact/contact_point.hpp"

#include <cstddef>

namespace saltus::event_integrator {

void read_contacts(const std::vector<model::Contact>& contacts, const evaluation::ContactValues& values,
                   ContactPoint& point) {
  point.influence.resize(values.rows.rows(), values.responses.cols());
  linalg::multiply(values.rows, values.responses, point.influence);
  point.velocity = values.velocity;
  point.restitution.assign(values.restitution.begin(), values.restitution.end());
  point.friction.clear();
  point.has_gap.clear();
  point.tangents.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto& contact = contacts[i];
    const double friction = contact.has_friction ? values.friction(static_cast<linalg::Index>(i)) : 0.0;
    const bool is_smooth = contact.friction_varies ? friction <= model::no_friction : !contact.has_friction;
    point.friction.push_back(is_smooth ? 0.0 : friction);
    point.has_gap.push_back(contact.has_gap);
    point.tangents.push_back(is_smooth ? 0 : contact.tangents());
  }
}

}  // namespace saltus::event_integrator
