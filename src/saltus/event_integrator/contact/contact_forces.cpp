#include "saltus/event_integrator/contact/contact_forces.hpp"

#include <algorithm>
#include <numeric>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::event_integrator {

using switching::Block;

switching::PointProblem problem_of(const ContactPoint& point, const std::vector<int>& resting) {
  switching::PointProblem problem{{}, point.influence, point.acceleration, point.terms};
  for (int i = 0; i < point.contacts(); ++i) {
    Block& block = problem.blocks.emplace_back();
    block.row = i;
    if (!contains(resting, i)) continue;
    block.kind = point.friction[at(i)] == 0.0 ? Block::Kind::half_line : Block::Kind::friction;
    block.friction = point.friction[at(i)];
    block.is_given = !point.has_gap[at(i)];
    const linalg::Vector velocity = point.along(point.velocity, i);
    for (int tangent = 0; tangent < point.tangents[at(i)]; ++tangent) {
      block.tangents[at(tangent)] = point.tangent_row(i, tangent);
      block.velocity[at(tangent)] = velocity(tangent);
    }
  }
  return problem;
}

namespace {

/// Of all contacts, with those of a part.
ContactForces with_part(ContactForces all, const std::vector<int>& part, const std::vector<int>& rows,
                        const ContactForces& own) {
  for (std::size_t k = 0; k < part.size(); ++k) {
    all.faces[at(part[k])] = own.faces[k];
    all.directions[at(part[k])] = own.directions[k];
  }
  for (const int k : own.idle) all.idle.push_back(part[at(k)]);
  for (std::size_t k = 0; k < rows.size(); ++k) all.z(rows[k]) = own.z(index(k));
  all.is_open = all.is_open || own.is_open;
  all.is_stressed = all.is_stressed || own.is_stressed;
  return all;
}

/// Those of a part with the first ones of the others, and all together while they are few.
std::vector<ContactForces> joined(const std::vector<ContactForces>& all, const std::vector<int>& part,
                                  const std::vector<int>& rows, const std::vector<ContactForces>& own) {
  constexpr std::size_t few = 64;
  std::vector<ContactForces> result;
  for (std::size_t k = 0; k < own.size(); ++k) {
    const std::size_t others = k == 0 || all.size() * own.size() <= few ? all.size() : 1;
    for (std::size_t i = 0; i < others; ++i) result.push_back(with_part(all[i], part, rows, own[k]));
  }
  return result;
}

}  // namespace

switching::PointSolutions forces_of(const ContactPoint& point, const std::vector<int>& resting,
                                    const switching::FaceHints& hints) {
  const auto m = at(point.contacts());
  const auto parts = parts_of(point, resting);
  const auto problem = problem_of(point, resting);
  if (parts.size() == 1 && parts.front().size() == m) return switching::solve_point(problem, hints);
  ContactForces none;
  none.faces.assign(m, ContactMode::open);
  none.directions.assign(m, linalg::Vector::zero(2));
  none.z = linalg::Vector::zero(point.velocity.size());
  switching::PointSolutions found{{none}, true};
  for (const auto& part : parts) {
    const ContactPoint own = point_of(point, part);
    std::vector<int> all(part.size());
    std::iota(all.begin(), all.end(), 0);
    switching::FaceHints of_part{.holds = hints.holds};
    for (const int i : part) {
      if (!hints.excluded.empty()) of_part.excluded.push_back(hints.excluded[at(i)]);
      if (!hints.before.empty()) of_part.before.push_back(hints.before[at(i)]);
    }
    const auto solutions = switching::solve_point(problem_of(own, all), of_part);
    found.all = joined(found.all, part, rows_of(point, part), solutions.all);
    found.complete = found.complete && solutions.complete;
  }
  for (auto& one : found.all) {
    std::sort(one.idle.begin(), one.idle.end());
    one.y = point.acceleration + point.influence * one.z;
    one.margin = switching::margin_of(problem, one);
  }
  return found;
}

bool forces_in(const ContactPoint& point, const std::vector<int>& resting, const std::vector<ContactMode>& modes,
               ContactForces& result) {
  return switching::solve_on(problem_of(point, resting), modes, result);
}

std::optional<switching::PointVertex> rates_by_pivots(const ContactPoint& point, const std::vector<int>& touching,
                                                      const linalg::Vector& velocity,
                                                      const std::vector<bool>& pushing) {
  using switching::Face;
  const linalg::Vector none = linalg::Vector::zero(velocity.size());
  switching::PointProblem problem{problem_of(point, touching).blocks, point.influence, none, point.influence.max_abs()};
  for (const int i : touching) {
    Block& block = problem.blocks[at(i)];
    if (pushing[at(i)]) block.kind = Block::Kind::friction;
    if (!pushing[at(i)] && velocity(i) > 0.0) block.kind = Block::Kind::absent;
    block.is_given = pushing[at(i)];
    block.is_bounded = !pushing[at(i)];
    const linalg::Vector along = point.along(velocity, i);
    block.velocity = {along[0], along[1]};
  }
  const std::vector<Face> all{Face::stick, Face::slip, Face::slip_up, Face::slip_down, Face::closed, Face::open};
  return switching::vertex_by_pivots(problem, std::vector(problem.blocks.size(), all));
}

}  // namespace saltus::event_integrator
