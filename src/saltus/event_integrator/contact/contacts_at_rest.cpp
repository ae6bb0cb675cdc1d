// Which gaps and rates of contacts are none.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"

namespace saltus::event_integrator {

/// What the gap is made of: what its rounding is relative to.
double Contacts::gap_terms(int contact, const std::vector<double>& x) const {
  double terms = 0.0;
  for (std::size_t k = 0; k < system_.positions.size(); ++k) {
    terms += std::abs(values_.rows(contact, static_cast<Eigen::Index>(k)) * x[at(system_.positions[k])]);
  }
  return terms;
}

/// Whether a contact opens and falls back before its gap, or the time, would be more than rounding. Without an end to
/// them such bounces would go on for ever: no speed is small enough to end at once.
bool Contacts::rises_by_nothing(const ContactMoment& moment, int contact, const ContactPoint& point,
                                const std::vector<double>& x) const {
  if (!contacts_[at(contact)].has_gap) return false;
  constexpr double roundings = 64.0 * rounding_unit;
  const double speed = std::abs(point.normal_velocity(contact)), pull = std::max(0.0, -point.acceleration(contact));
  return speed * speed <= 2.0 * pull * roundings * gap_terms(contact, x) ||
         speed <= pull * roundings * std::abs(moment.t);
}

/// Whether a gap and its rate are 0 within the tolerances: that of another contact in the same impacts.
bool Contacts::comes_to_rest(const ContactMoment& moment, int contact, const ContactPoint& point,
                             const std::vector<double>& x) const {
  const auto& [rtol, atol] = moment.tolerances;
  return std::abs(values_.gap(contact)) <= atol + rtol * gap_terms(contact, x) &&
         (std::abs(point.normal_velocity(contact)) <= 64.0 * slowest(moment, point, x) ||
          rises_by_nothing(moment, contact, point, x));
}

double Contacts::tolerated(int function, const std::vector<double>& x) const {
  const auto leaves = [&](const auto& contact) {
    return contact.has_gap && x[at(contact.closed)] == 0.0 && kernel_.jump_guard(contact.jump, 0) == function;
  };
  return std::any_of(contacts_.begin(), contacts_.end(), leaves) ? none_at_start : 0.0;
}

}  // namespace saltus::event_integrator
