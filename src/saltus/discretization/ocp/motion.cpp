#include <algorithm>
#include <utility>

#include "saltus/discretization/ocp/motion_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

/// Of an interval: so long a mode must go on to be one. What is left at the end of an interval is not missed.
constexpr double short_share = 1e-4;
/// A switch is found by bisection: to rounding.
constexpr int bisections = 45;

}  // namespace

/// What goes on first, then what differs at the surfaces that are reached.
std::optional<Motion::Step> Motion::step(std::size_t k, const std::vector<double>& left, double rest) const {
  const auto lambda = trial_.lambda(left);
  for (const auto& modes : states_.candidates(lambda, last_.empty() ? states_.on_all(lambda) : last_)) {
    Step step{{.modes = modes, .length = std::min(short_share, rest)}, {}};
    auto own = trial_.solve(left, k, modes, step.stretch.length);
    if (own && trial_.stands_still(left, *own)) {
      step.stretch.stands = true;
      own = trial_.solve_to_end(left, k, modes, step.stretch.length);
    }
    if (!own || !trial_.is_admissible(*own)) continue;
    step.own = std::move(*own);
    if (!step.stretch.stands) go_on(k, left, rest, step);
    return step;
  }
  return std::nullopt;
}

/// As long as the mode does.
void Motion::go_on(std::size_t k, const std::vector<double>& left, double rest, Step& step) const {
  double low = step.stretch.length, high = rest;
  for (int bisection = 0; bisection < bisections && low < high; ++bisection) {
    const double length = bisection == 0 ? rest : 0.5 * (low + high);
    auto own = trial_.solve(left, k, step.stretch.modes, length);
    if (own && trial_.is_admissible(*own)) {
      low = length;
      step.own = std::move(*own);
    } else {
      high = length;
    }
  }
  step.stretch.length = low;
}

std::optional<Stretches> Motion::interval(std::size_t k, std::vector<double>& left) {
  Stretches stretches;
  double rest = 1.0;
  while (rest > short_share) {
    if (static_cast<int>(stretches.size()) == made_.interval[k].elements) return std::nullopt;
    const auto next = step(k, left, rest);
    if (!next) return std::nullopt;
    if (!next->stretch.stands) rest -= next->stretch.length;
    left = trial_.right_of(next->own);
    last_ = next->stretch.modes;
    stretches.push_back(next->stretch);
  }
  return stretches;
}

std::optional<mpcc::NamedStart> OcpProblem::motion(mpcc::ConstVectorView w) {
  const auto& made = *implementation_->structure;
  if (made.kernel.pairs.empty()) return std::nullopt;
  Motion motion(made, w);
  std::vector<double> left = ElementTrial(made, w).left_of(0);
  ModeSequence sequence;
  for (std::size_t k = 0; k < made.interval.size(); ++k) {
    if (made.interval[k].elements > 1 && made.interval[k].lengths.empty()) return std::nullopt;
    auto stretches = motion.interval(k, left);
    if (!stretches) return std::nullopt;
    sequence.emplace(k, std::move(*stretches));
  }
  std::vector<ActiveSide> sides;
  linalg::Vector c(rows());
  functions(w, c);
  const auto G = c.segment(constraints(), pairs()), H = c.tail(pairs());
  for (int i = 0; i < pairs(); ++i) sides.push_back(G[i] <= H[i] ? ActiveSide::G : ActiveSide::H);
  auto realised = realise(made, ElementSides(made, sides), w, std::move(sequence));
  if (!realised || !realised->is_solved) return std::nullopt;
  return mpcc::NamedStart{.name = "a motion", .w = std::move(realised->w), .sides = std::move(realised->sides)};
}

}  // namespace saltus::discretization
