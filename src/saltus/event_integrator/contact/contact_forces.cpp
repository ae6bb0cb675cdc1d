#include "saltus/event_integrator/contact/contact_forces.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Matrix;
using linalg::Vector;

/// Of margins: rounding of solves, and of the place where a mode was found to end.
constexpr double holds = -1e-8;

std::vector<ContactMode> mode_options(const ContactPoint& point, int i) {
  if (point.friction[static_cast<std::size_t>(i)] == 0.0) return {ContactMode::closed, ContactMode::open};
  if (point.in_plane(i)) {
    std::vector<ContactMode> modes{ContactMode::slip};
    if (point.along(point.velocity, i).is_zero()) modes.insert(modes.begin(), ContactMode::stick);
    if (point.has_gap[static_cast<std::size_t>(i)]) modes.push_back(ContactMode::open);
    return modes;
  }
  const double slip = point.velocity(point.tangent_row(i, 0));
  if (slip > 0.0) return {ContactMode::slip_up, ContactMode::open};
  if (slip < 0.0) return {ContactMode::slip_down, ContactMode::open};
  return {ContactMode::stick, ContactMode::slip_up, ContactMode::slip_down, ContactMode::open};
}

/// What accelerations and forces are relative to.
struct Sizes {
  double acceleration, force;
};

Sizes sizes_of(const ContactPoint& point, const ContactForces& found) {
  // Where a body leaves a gap, what is left of its force and acceleration is the rounding of their terms.
  constexpr double rounded = 1e-5;
  const double largest = (point.acceleration.abs() + (point.influence * found.forces).abs()).max();
  const double response = point.influence.max_abs();
  const double force = response > 0.0 ? rounded * point.terms / response : 0.0;
  return {std::max(rounded * point.terms, largest), std::max(force, found.forces.max_abs())};
}

/// The least margin of all conditions.
double margin_of(const ContactPoint& point, const std::vector<int>& resting, const ContactForces& found) {
  const auto [largest, force] = sizes_of(point, found);
  const auto part = [](double value, double size) { return size > 0.0 ? value / size : 0.0; };
  double least = std::numeric_limits<double>::infinity();
  const auto note = [&](double value, double size) { least = std::min(least, part(value, size)); };
  for (const int i : resting) {
    const auto mode = found.modes[static_cast<std::size_t>(i)];
    const double mu = point.friction[static_cast<std::size_t>(i)];
    if (mode == ContactMode::open) {
      note(found.acceleration(i), largest);
      continue;
    }
    const bool is_idle = contains(found.idle, i);
    if (!is_idle) note(found.forces(i), force);
    if (!is_idle && mode == ContactMode::stick) note(mu * found.forces(i) - point.along(found.forces, i).norm(), force);
    if (!slips(mode)) continue;
    const Vector& direction = found.directions[static_cast<std::size_t>(i)];
    const Vector velocity = point.along(point.velocity, i);
    velocity.is_zero() ? note(direction.dot(point.along(found.acceleration, i)), largest)
                       : note(direction.dot(velocity), velocity.norm());
  }
  return least;
}

void find_held_rows(const ContactPoint& point, const std::vector<int>& resting, const ContactForces& result,
                    HeldRows& rows) {
  rows.clear();
  for (const int i : resting) {
    const auto k = static_cast<std::size_t>(i);
    const auto mode = result.modes[k];
    if (mode == ContactMode::open || contains(result.idle, i)) continue;
    const bool given = !point.has_gap[k];
    if (given) rows.give(i);
    const int normal = given ? -1 : rows.hold(i);
    for (int tangent = 0; tangent < point.tangents[k]; ++tangent) {
      const int row = point.tangent_row(i, tangent);
      rows.share(row, normal, -point.friction[k] * result.directions[k](tangent));
      if (mode == ContactMode::stick) rows.hold(row);
    }
  }
}

HeldRows held_rows(const ContactPoint& point, const std::vector<int>& resting, const ContactForces& result) {
  HeldRows rows(point.velocity.size());
  find_held_rows(point, resting, result, rows);
  return rows;
}

/// @param rows  work space
bool solve_forces(const ContactPoint& point, const std::vector<int>& resting, HeldRows& rows, ContactForces& result) {
  find_held_rows(point, resting, result, rows);
  const auto solution = rows.solve(point.influence, point.acceleration, result.forces);
  if (solution == HeldRows::Solution::none) return false;
  result.is_open = solution == HeldRows::Solution::open;
  result.acceleration = point.acceleration + point.influence * result.forces;
  return true;
}

/// Whether rows that are held hold others, too.
bool hold(const ContactPoint& point, const std::vector<int>& held, const std::vector<int>& rows) {
  const Matrix between = point.influence.selected(held, rows);
  linalg::OrthogonalFactors factors;
  factors.set_threshold(HeldRows::dependent);
  factors.compute(point.influence.selected(held, held));
  const Matrix left = point.influence.selected(rows, rows) - between.transpose() * factors.solve(between);
  return left.diagonal().max_abs() <= 1e-9 * point.influence.selected(rows, rows).diagonal().max();
}

/// Whether the normal forces of others keep a contact closed, and all of their forces keep it at rest if it sticks.
bool is_kept(const ContactPoint& point, const std::vector<int>& held, const ContactForces& found, int i) {
  std::vector<int> normals, tangents;
  std::copy_if(held.begin(), held.end(), std::back_inserter(normals), [&](int row) { return row < point.contacts(); });
  const bool sticks = found.modes[static_cast<std::size_t>(i)] == ContactMode::stick;
  for (int k = 0; sticks && k < point.tangents[static_cast<std::size_t>(i)]; ++k) {
    tangents.push_back(point.tangent_row(i, k));
  }
  return !normals.empty() && hold(point, normals, {i}) && (tangents.empty() || hold(point, held, tangents));
}

/// Where normal forces are open: without those of contacts that need none, so that the margin is the largest.
void drop_idle(const ContactPoint& point, const std::vector<int>& resting, HeldRows& rows, ContactForces& result) {
  if (!result.is_open) return;
  std::optional<ContactForces> best;
  for (auto i = resting.rbegin(); i != resting.rend(); ++i) {
    if (result.modes[static_cast<std::size_t>(*i)] == ContactMode::open || contains(result.idle, *i)) continue;
    ContactForces without = result;
    without.idle.push_back(*i);
    if (!is_kept(point, held_rows(point, resting, without).held(), without, *i)) continue;
    if (!solve_forces(point, resting, rows, without)) continue;
    without.margin = margin_of(point, resting, without);
    if (!best || without.margin > best->margin) best = std::move(without);
  }
  if (!best) return;
  result = std::move(*best);
  drop_idle(point, resting, rows, result);
}

/// Goes along forces that do not change the motion to where the modes hold best: the margin is a concave function.
void take_best_along(const Vector& open, const ContactPoint& point, const std::vector<int>& resting,
                     ContactForces& result) {
  constexpr double moved = 1e-9, widest = 1e6, golden = 0.6180339887498949;
  constexpr int refinements = 60;
  const Vector way = open * (result.forces.max_abs() / open.max_abs());
  if (!((point.influence * way).max_abs() <= moved * point.terms)) return;
  const ContactForces start = result;
  const auto margin_at = [&](double length) {
    result.forces = start.forces + length * way;
    return result.margin = margin_of(point, resting, result);
  };
  // Bodies that are squeezed hold the better the larger their forces are: large ones only where small ones do not hold.
  constexpr double large = 8.0;
  const auto rises_to = [&](double length) {
    const double before = margin_at(0.5 * length);
    return (before < holds || std::abs(length) <= large) && margin_at(length) > before;
  };
  double low = -1.0, high = 1.0;
  while (high < widest && rises_to(high)) high *= 2.0;
  while (low > -widest && rises_to(low)) low *= 2.0;
  for (int step = 0; step < refinements; ++step) {
    const double right = low + golden * (high - low), left = high - golden * (high - low);
    const bool rises = margin_at(left) < margin_at(right);
    (rises ? low : high) = rises ? left : right;
  }
  if (!(margin_at(0.5 * (low + high)) > start.margin)) result = start;
}

/// Along one after the other; while the modes do not hold, along mixtures of them, too: the margin has edges, on which
/// no single one leads on.
void take_best(const ContactPoint& point, const std::vector<int>& resting, ContactForces& result) {
  if (!result.is_open) return;
  const Matrix open = held_rows(point, resting, result).open(point.influence);
  for (linalg::Index k = 0; k < open.cols(); ++k) take_best_along(open.col(k), point, resting, result);
  constexpr int mixtures = 20;
  constexpr double golden_angle = 2.399963229728653;
  for (linalg::Index n = 1; n < mixtures * open.cols() && open.cols() > 1 && result.margin < holds; ++n) {
    Vector mixture = Vector::zero(open.rows());
    for (linalg::Index k = 0; k < open.cols(); ++k) {
      mixture += std::sin(golden_angle * static_cast<double>(n * (k + 1))) / open.col(k).max_abs() * open.col(k);
    }
    take_best_along(mixture, point, resting, result);
  }
}

/// Against the forces that would keep these contacts from slipping; where others hold them, too, these forces are not
/// one, and the way is that of a motion without friction.
void guess_directions(const ContactPoint& point, const std::vector<int>& resting, const std::vector<int>& free,
                      HeldRows& rows, ContactForces& result) {
  ContactForces guess = result;
  for (const int i : free) guess.modes[static_cast<std::size_t>(i)] = ContactMode::stick;
  const bool sticks = solve_forces(point, resting, rows, guess) && !guess.is_open;
  const bool moves = !sticks && solve_forces(point, resting, rows, guess = result);
  for (const int i : free) {
    const Vector needed = sticks  ? Vector(-point.along(guess.forces, i))
                          : moves ? point.along(guess.acceleration, i)
                                  : point.along(point.acceleration, i);
    result.directions[static_cast<std::size_t>(i)] =
        needed.norm() > 0.0 ? Vector(needed.normalized()) : Vector{1.0, 0.0};
  }
}

/// Whether the motion is the same whatever forces are taken of those that these modes leave open.
bool is_determined(const ContactPoint& point, const std::vector<int>& resting, const ContactForces& found) {
  ContactForces base = found;
  base.idle.clear();
  if (!found.is_open && found.idle.empty()) return true;
  const Matrix open = held_rows(point, resting, base).open(point.influence);
  const double response = point.influence.max_abs();
  constexpr double small = 1e-6, moved = 1e-12;
  for (linalg::Index k = 0; k < open.cols(); ++k) {
    const Vector forces = open.col(k) * (small * point.terms / (response * open.col(k).max_abs()));
    const Vector change = point.influence * forces;
    if (!(change.max_abs() > moved * point.terms)) continue;
    for (const double sign : {1.0, -1.0}) {
      ContactForces other = base;
      other.forces += sign * forces;
      other.acceleration += sign * change;
      if (margin_of(point, resting, other) >= holds) return false;
    }
  }
  return true;
}

/// @param rows  work space
bool find_forces(const ContactPoint& point, const std::vector<int>& resting, const std::vector<ContactMode>& modes,
                 HeldRows& rows, ContactForces& result) {
  result.modes = modes;
  result.directions.assign(modes.size(), Vector::zero(2));
  result.idle.clear();
  std::vector<int> free;
  for (const int i : resting) {
    const auto mode = modes[static_cast<std::size_t>(i)];
    auto& direction = result.directions[static_cast<std::size_t>(i)];
    const Vector velocity = point.along(point.velocity, i);
    if (mode == ContactMode::slip_up) direction = Vector{1.0, 0.0};
    if (mode == ContactMode::slip_down) direction = Vector{-1.0, 0.0};
    if (mode != ContactMode::slip) continue;
    if (velocity.is_zero()) {
      free.push_back(i);
    } else {
      direction = velocity.normalized();
    }
  }
  const auto solve = [&] { return solve_forces(point, resting, rows, result); };
  if (!free.empty()) guess_directions(point, resting, free, rows, result);
  const bool solved = free.empty()
                          ? solve()
                          : find_directions(point, free, result.directions, result.forces, result.acceleration, solve);
  if (!solved) return false;
  result.margin = margin_of(point, resting, result);
  drop_idle(point, resting, rows, result);
  take_best(point, resting, result);
  return true;
}

/// The forces of frictionless contacts whose rows do not depend on each other, by an active set: who pulls most opens,
/// who closes most is closed. False where that finds nothing.
bool find_only_forces(const ContactPoint& point, const std::vector<int>& resting, HeldRows& rows,
                      ContactForces& found) {
  found.modes.assign(point.friction.size(), ContactMode::open);
  found.directions.assign(found.modes.size(), Vector::zero(2));
  for (const int i : resting) found.modes[static_cast<std::size_t>(i)] = ContactMode::closed;
  for (std::size_t step = 0; step < 4 * resting.size(); ++step) {
    if (!solve_forces(point, resting, rows, found) || found.is_open) return false;
    const auto [acceleration, force] = sizes_of(point, found);
    double worst = -1e-12;
    ContactMode* changes = nullptr;
    for (const int i : resting) {
      auto& mode = found.modes[static_cast<std::size_t>(i)];
      const double left = mode == ContactMode::open ? found.acceleration(i) / acceleration : found.forces(i) / force;
      if (!(left < worst)) continue;
      worst = left;
      changes = &mode;
    }
    if (changes == nullptr) return true;
    *changes = *changes == ContactMode::open ? ContactMode::closed : ContactMode::open;
  }
  return false;
}

/// Frictionless contacts whose rows do not depend on each other have one motion, by one set of forces: who clearly
/// presses is closed in all modes that hold, who clearly leaves is open.
/// @param options  by resting contact
void drop_impossible(const ContactPoint& point, const std::vector<int>& resting, HeldRows& rows,
                     std::vector<std::vector<ContactMode>>& options) {
  const auto has_friction = [&](int i) { return point.friction[static_cast<std::size_t>(i)] != 0.0; };
  constexpr std::size_t few = 2;  // as fast tried
  ContactForces found;
  if (resting.size() <= few || std::any_of(resting.begin(), resting.end(), has_friction)) return;
  if (!find_only_forces(point, resting, rows, found)) return;
  const auto [acceleration, force] = sizes_of(point, found);
  constexpr double clear = 1e-3;
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const int i = resting[k];
    const bool presses = found.forces(i) > clear * force, leaves = found.acceleration(i) > clear * acceleration;
    if (presses || leaves) options[k].assign(1, presses ? ContactMode::closed : ContactMode::open);
  }
}

}  // namespace

bool forces_in(const ContactPoint& point, const std::vector<int>& resting, const std::vector<ContactMode>& modes,
               ContactForces& result) {
  HeldRows rows(point.velocity.size());
  return find_forces(point, resting, modes, rows, result);
}

bool carry_without(const ContactPoint& point, const std::vector<int>& resting, const std::vector<int>& idle,
                   ContactForces& found) {
  HeldRows rows(point.velocity.size());
  found.idle = idle;
  if (!solve_forces(point, resting, rows, found)) return false;
  found.margin = margin_of(point, resting, found);
  return found.margin >= holds;
}

std::vector<ContactForces> admissible_forces(const ContactPoint& point, const std::vector<int>& resting,
                                             const std::vector<std::vector<ContactMode>>& excluded) {
  std::vector<std::vector<ContactMode>> all;
  for (const int i : resting) {
    auto some = mode_options(point, i);
    const auto& without = excluded[static_cast<std::size_t>(i)];
    std::erase_if(some, [&](ContactMode mode) { return contains(without, mode); });
    if (some.empty()) return {};
    all.push_back(std::move(some));
  }
  HeldRows rows(point.velocity.size());
  if (std::all_of(excluded.begin(), excluded.end(), [](const auto& modes) { return modes.empty(); }))
    drop_impossible(point, resting, rows, all);
  std::vector<ContactForces> result;
  std::vector<std::size_t> number(all.size(), 0);
  std::vector<ContactMode> modes(point.friction.size(), ContactMode::open);
  ContactForces found;
  constexpr long most = 100000;
  for (long tried = 0; tried < most; ++tried) {
    for (std::size_t k = 0; k < all.size(); ++k) modes[static_cast<std::size_t>(resting[k])] = all[k][number[k]];
    if (find_forces(point, resting, modes, rows, found) && found.margin >= holds) result.push_back(std::move(found));
    std::size_t k = 0;
    while (k < all.size() && ++number[k] == all[k].size()) number[k++] = 0;
    if (k == all.size()) break;
    if (result.size() > 16) break;
  }
  return result;
}

bool have_one_motion(const ContactPoint& point, const std::vector<int>& resting,
                     const std::vector<ContactForces>& found, std::size_t chosen) {
  constexpr double rounded = 1e-6;
  const auto moves_alike = [&](const ContactForces& other) {
    return (other.acceleration - found[chosen].acceleration).max_abs() <= rounded * point.terms;
  };
  return std::all_of(found.begin(), found.end(), moves_alike) && is_determined(point, resting, found[chosen]);
}

}  // namespace saltus::event_integrator
