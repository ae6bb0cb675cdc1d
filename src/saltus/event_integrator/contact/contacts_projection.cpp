// Gaps, rates and tangential velocities that are held at 0.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::event_integrator {

using linalg::Vector;

/// The smallest change of velocities that changes these rows by so much; they do not depend on each other.
const Vector& Contacts::least_change(const std::vector<int>& rows, const Vector& change) {
  auto& work = projection_;
  const auto n = index(rows.size());
  work.influence.resize(n, n);  // its lower half: the other one is not read
  for (linalg::Index k = 0; k < n; ++k) {
    const auto response = values_.responses.col(rows[at(k)]);
    for (linalg::Index i = k; i < n; ++i) work.influence(i, k) = values_.rows.row(rows[at(i)]).dot(response);
  }
  work.pushes = change;
  if (n == 1 && work.influence(0, 0) > 0.0) {
    work.pushes /= work.influence(0, 0);
  } else {
    work.factors.compute(work.influence);
    work.factors.solve_in_place(work.pushes);
  }
  work.least.set_zero(values_.responses.rows());
  for (linalg::Index k = 0; k < n; ++k) work.least.add_scaled(work.pushes(k), values_.responses.col(rows[at(k)]));
  return work.least;
}

bool Contacts::hold() {
  auto& rows = projection_.start.held;
  rows.clear();
  const auto m = static_cast<int>(contacts_.size());
  for (int i = 0; i < m; ++i) {
    if (activity(i).carries) rows.push_back(i);
  }
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < 2; ++k) {
      if (activity(i).holds[at(k)]) rows.push_back(m * (1 + k) + i);
    }
  }
  return !rows.empty();
}

/// @param touching  what opens there does not begin below its gap: the correction of another one would leave it there,
///                  to their roundings, and its fall would have no sign to change
/// @return whether x changed
bool Contacts::correct_positions(const std::vector<int>& touching, std::vector<double>& x) {
  auto& rows = projection_.rows;
  rows.clear();
  for (const int row : projection_.start.held) {
    if (row < static_cast<int>(contacts_.size())) rows.push_back(row);
  }
  if (!touching.empty()) {
    linalg::RowBasis basis = no_rows();
    for (const int row : rows) basis.takes(values_.rows.row(row));
    std::copy_if(touching.begin(), touching.end(), std::back_inserter(rows),
                 [&](int row) { return values_.gap(row) < 0.0 && basis.takes(values_.rows.row(row)); });
  }
  if (std::all_of(rows.begin(), rows.end(), [&](int row) { return values_.gap(row) == 0.0; })) return false;
  projection_.change.resize(index(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) projection_.change(index(k)) = values_.gap(rows[k]);
  const Vector& moved = least_change(rows, projection_.change);
  bool changed = false;
  for (std::size_t k = 0; k < layout_.positions.size(); ++k) {
    double& position = x[at(layout_.positions[k])];
    const double next = position - moved(static_cast<linalg::Index>(k));
    changed = changed || next != position;
    position = next;
  }
  return changed;
}

void Contacts::change_velocities(const std::vector<int>& rows, const Vector& change, std::vector<double>& x) {
  const Vector& velocities = least_change(rows, change);
  for (std::size_t k = 0; k < layout_.velocities.size(); ++k) {
    x[at(layout_.velocities[k])] += velocities(static_cast<linalg::Index>(k));
  }
}

/// Of what is held. Slips in a plane stay what they were before positions were corrected, if they are to be kept: the
/// smaller they are, the more would another velocity turn them, and forces with them.
void Contacts::correct_velocities(Slips slips, std::vector<double>& x) {
  const auto& [held, before, velocity] = projection_.start;
  auto& rows = projection_.rows;
  auto& change = projection_.change;
  rows = held;
  const bool at_rest = std::all_of(rows.begin(), rows.end(), [&](int row) { return values_.velocity(row) == 0.0; });
  if (at_rest && values_.velocity == velocity) return;
  if (slips == Slips::kept) keep_slips(rows);
  change.resize(index(rows.size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double wanted = r < held.size() ? 0.0 : velocity(rows[r]);
    change(index(r)) = wanted - values_.velocity(rows[r]);
  }
  change_velocities(rows, change, x);
  drop_own_roundings(held, before, x);
}

/// A velocity that is held by itself is 0, not its rounding.
/// @param rows    those that have been brought to 0 from `before`, where the values are known
void Contacts::drop_own_roundings(const std::vector<int>& rows, const std::vector<double>& before,
                                  std::vector<double>& x) const {
  for (const int r : rows) {
    const auto row = values_.rows.row(r);
    if (row.nonzeros() != 1) continue;
    const linalg::Index only = row.abs().index_of_max();
    const auto k = at(layout_.velocities[static_cast<std::size_t>(only)]);
    const double own = row(only) * before[k], moving = values_.velocity(r) - own;
    if (std::abs(moving) <= 4.0 * rounding_unit * std::abs(own)) x[k] = 0.0;
  }
}

/// What counts as 0 is 0, along the ground, too: a slip that begins from a rounding against it would end at once.
/// Values are those at x.
void Contacts::put_at_rest(const ContactPoint& point, const std::vector<int>& resting, std::vector<double>& x) {
  std::vector<int> rows;
  linalg::RowBasis basis = no_rows();
  for (const int i : resting) {
    for (int row = i; row <= i + point.contacts(); row += point.contacts()) {
      const bool counts = row == i || point.tangents[at(i)] == 1;
      if (counts && point.velocity(row) == 0.0 && basis.takes(values_.rows.row(row))) rows.push_back(row);
    }
  }
  if (values_.velocity.selected_rows(rows).is_zero()) return;
  const auto before = x;
  change_velocities(rows, -values_.velocity.selected_rows(rows), x);
  drop_own_roundings(rows, before, x);
}

/// Adds the tangential rows of slips in a plane that do not depend on the ones that are there.
void Contacts::keep_slips(std::vector<int>& rows) const {
  const auto m = static_cast<int>(contacts_.size());
  std::optional<linalg::RowBasis> basis;
  for (int i = 0; i < m; ++i) {
    if (mode_of(i) != ContactMode::slip) continue;
    if (!basis) {
      basis.emplace(no_rows());
      for (const int row : rows) basis->takes(values_.rows.row(row));
    }
    for (int k = 0; k < 2; ++k) {
      if (basis->takes(values_.rows.row(m * (1 + k) + i))) rows.push_back(m * (1 + k) + i);
    }
  }
}

bool Contacts::project(double t, const std::vector<double>& alpha, std::vector<double>& x,
                       const std::vector<int>& touching, Slips slips) {
  if (!hold()) return false;
  projection_.start.x = x;
  // The gap of a step is within its tolerances: two corrections leave rounding.
  for (int iteration = 0; iteration < 3; ++iteration) {
    kernel_.contacts(t, x.data(), alpha.data(), values_);
    if (iteration == 0) projection_.start.velocity = values_.velocity;
    if (!correct_positions(touching, x)) break;
  }
  correct_velocities(slips, x);
  return x != projection_.start.x;
}

}  // namespace saltus::event_integrator
