#include "saltus/event_integrator/contact/contact_point.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {

std::vector<int> rows_of(const ContactPoint& point, const std::vector<int>& contacts) {
  std::vector<int> rows;
  for (int first = 0; first < static_cast<int>(point.velocity.size()); first += point.contacts()) {
    for (const int i : contacts) rows.push_back(first + i);
  }
  return rows;
}

ContactPoint point_of(const ContactPoint& point, const std::vector<int>& contacts) {
  const auto rows = rows_of(point, contacts);
  ContactPoint part;
  part.influence = point.influence.selected(rows, rows);
  part.velocity = point.velocity.selected_rows(rows);
  if (point.acceleration.size() > 0) part.acceleration = point.acceleration.selected_rows(rows);
  part.free_terms = point.free_terms;
  part.terms = point.terms;
  for (const int i : contacts) {
    part.friction.push_back(point.friction[at(i)]);
    part.restitution.push_back(point.restitution[at(i)]);
    part.tangents.push_back(point.tangents[at(i)]);
    part.has_gap.push_back(point.has_gap[at(i)]);
  }
  return part;
}

std::vector<std::vector<int>> parts_of(const ContactPoint& point, const std::vector<int>& contacts) {
  const auto rows = static_cast<int>(point.velocity.size()), m = point.contacts();
  const auto touch = [&](int i, int k) {
    for (int row = i; row < rows; row += m) {
      for (int column = k; column < rows; column += m) {
        if (point.influence(row, column) != 0.0) return true;
      }
    }
    return false;
  };
  std::vector<std::vector<int>> parts;
  std::vector<int> left = contacts;
  while (!left.empty()) {
    auto& part = parts.emplace_back(1, left.front());
    left.erase(left.begin());
    for (std::size_t k = 0; k < part.size(); ++k) {
      const auto own = std::stable_partition(left.begin(), left.end(), [&](int i) { return !touch(part[k], i); });
      part.insert(part.end(), own, left.end());
      left.erase(own, left.end());
    }
    std::sort(part.begin(), part.end());
  }
  return parts;
}

void read_contacts(const std::vector<model::Contact>& contacts, const evaluation::ContactValues& values,
                   ContactPoint& point) {
  // Of many bodies a contact moves two, and each of these is moved by few contacts.
  const auto &rows = values.rows, &responses = values.responses;
  std::vector<std::vector<linalg::Index>> moving(at(responses.rows()));
  for (linalg::Index k = 0; k < responses.rows(); ++k) {
    for (linalg::Index j = 0; j < responses.cols(); ++j) {
      if (responses(k, j) != 0.0) moving[at(k)].push_back(j);
    }
  }
  point.influence.set_zero(rows.rows(), responses.cols());
  for (linalg::Index i = 0; i < rows.rows(); ++i) {
    for (linalg::Index k = 0; k < rows.cols(); ++k) {
      const double part = rows(i, k);
      if (part == 0.0) continue;
      for (const linalg::Index j : moving[at(k)]) point.influence(i, j) += part * responses(k, j);
    }
  }
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
