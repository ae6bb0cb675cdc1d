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

}  // namespace saltus::event_integrator
