#include <tuple>
#include <utility>

#include "saltus/discretization/ocp/ocp_problem_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;
using Modes = ElementSides::Sides;

/// What is left to pay where modes are these: a side that is not zero any more is free.
double left_to_pay(const std::vector<double>& paid, const Modes& before, const Modes& modes) {
  double sum = 0.0;
  for (std::size_t k = 0; k < paid.size(); ++k) sum += modes[k] == before[k] ? paid[k] : 0.0;
  return sum;
}

/// A surface on one side of which too much is paid is slid on; one that is slid on is left to the side that saves more.
Modes freed_modes(const SurfaceStates& states, const std::vector<double>& paid, const Modes& before) {
  Modes changed = before;
  const double all = left_to_pay(paid, before, before);
  for (std::size_t surface = 0; all > 0.0 && surface < states.count(); ++surface) {
    double least = all;
    int best = 0;
    for (const int state : {-1, 0, 1}) {
      const double left = left_to_pay(paid, before, states.with(before, surface, state));
      if (left < least) std::tie(least, best) = std::pair(left, state);
    }
    if (least < all) changed = states.with(std::move(changed), surface, states.of(before, surface) != 0 ? 0 : best);
  }
  return changed;
}

}  // namespace

std::vector<ActiveSide> OcpProblem::freed(const std::vector<ActiveSide>& sides, mpcc::ConstVectorView w, double paid) {
  const auto& made = *implementation_->structure;
  const SurfaceStates states(made);
  const ElementSides modes(made, sides);
  linalg::Vector c(rows());
  functions(w, c);
  linalg::Vector of_pairs(pairs());
  for (int pair = 0; pair < pairs(); ++pair) {
    of_pairs[pair] = c[constraints() + pair + (sides[at(pair)] == ActiveSide::G ? 0 : pairs())];
  }
  std::vector<ActiveSide> changed = sides;
  for (std::size_t e = 0; e < made.element.size(); ++e) {
    const Modes before = modes.modes(e);
    std::vector<double> sums;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const double sum = modes.sum(of_pairs, e, k);
      sums.push_back(sum > paid ? sum : 0.0);
    }
    modes.write(freed_modes(states, sums, before), e, changed);
  }
  return changed;
}

}  // namespace saltus::discretization
