#include "saltus/event_integrator/contact/shared_friction.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// A force that may follow, along the changes that are open: of itself, and of what its share leaves of it.
struct Follower {
  int row;
  double room;  ///< in the cone, relative to it
  Vector own, equation;
};

std::vector<Follower> followers_of(const ContactPoint& point, const std::vector<int>& resting,
                                   const ContactForces& found, const Matrix& open) {
  std::vector<Follower> followers;
  for (const int i : resting) {
    if (found.faces[at(i)] != ContactMode::stick || contains(found.idle, i)) continue;
    const double normal = found.z(i), limit = point.friction[at(i)] * normal;
    const double room = limit > 0.0 ? 1.0 - point.along(found.z, i).norm() / limit : 0.0;
    for (int tangent = 0; tangent < point.tangents[at(i)]; ++tangent) {
      const int row = point.tangent_row(i, tangent);
      const double part = limit > 0.0 ? found.z(row) / normal : 0.0;
      const Vector own = open.row(row);
      followers.push_back({row, std::clamp(room, 0.0, 1.0), own, own - part * Vector(open.row(i))});
    }
  }
  return followers;
}

Matrix with_unit_columns(Matrix columns) {
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) /= columns.col(k).norm();
  return columns;
}

}  // namespace

std::vector<int> rows_that_follow(const ContactPoint& point, const std::vector<int>& resting,
                                  const ContactForces& found) {
  if (!found.is_open) return {};
  const Matrix open = with_unit_columns(switching::open_changes(problem_of(point, resting), found));
  auto followers = followers_of(point, resting, found, open);
  std::vector<int> rows;
  constexpr double at_edge = 0.1;  // weight of what has no room
  // Deep inside of their cones first; of equal ones the last: the first ones hold.
  const auto value = [](const Follower& one) {
    return (at_edge + one.room) * std::min(one.own.norm(), one.equation.norm());
  };
  constexpr double dependent = 1e-6, better = 1.0 + 1e-6;
  while (index(rows.size()) < open.cols() && !followers.empty()) {
    auto best = followers.begin();
    for (auto other = best; other != followers.end(); ++other) {
      if (better * value(*other) >= value(*best)) best = other;
    }
    if (!(value(*best) > dependent)) break;
    rows.push_back(best->row);
    const Vector own = best->own.normalized(), equation = best->equation.normalized();
    followers.erase(best);
    for (auto& other : followers) {
      other.own.add_scaled(-own.dot(other.own), own);
      other.equation.add_scaled(-equation.dot(other.equation), equation);
    }
  }
  return rows;
}

}  // namespace saltus::event_integrator
