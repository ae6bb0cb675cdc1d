#include "saltus/event_integrator/contact/contact_forces.hpp"

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
