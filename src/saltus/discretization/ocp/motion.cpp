#include <algorithm>
#include <memory>
#include <utility>

#include "saltus/discretization/ocp/motion_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

/// Of an interval: so long a mode must go on to be one. What is left at the end of an interval is not missed.
constexpr double short_share = 1e-3;
/// Of an interval: more are an accumulation, or no motion.
constexpr std::size_t most_stretches = 20;
/// Of modes, in a whole motion: where many surfaces meet they are as many as 3^n.
constexpr int most_trials = 1000;
/// A switch is found by bisection: to rounding.
constexpr int bisections = 45;
/// Of multipliers that have come to 0: the next mode may hold them there.
constexpr double at_bound = 3e-11;

}  // namespace

/// What goes on first, then what differs at the surfaces that are reached.
std::optional<Stretch> Motion::step(std::size_t k, const std::vector<double>& left, double rest) {
  const auto lambda = trial_.lambda(left);
  // Short elements hide what falls with the square of time.
  const double least = lambda.empty() ? 0.0 : *std::min_element(lambda.begin(), lambda.end());
  const double below = std::max(at_bound, -2.0 * least);
  for (const auto& modes : states_.candidates(lambda, last_.empty() ? states_.on_all(lambda) : last_)) {
    if (++trials_ > most_trials || is_over_()) return std::nullopt;
    Stretch stretch{.modes = modes, .length = std::min(short_share, rest)};
    auto own = trial_.solve(left, k, modes, stretch.length);
    if (own && trial_.stands_still(left, *own)) {
      stretch.stands = true;
      own = trial_.solve_to_end(left, k, modes, stretch.length);
    }
    if (!own || !trial_.is_admissible(*own, below)) continue;
    stretch.own = std::move(*own);
    if (!stretch.stands) go_on(k, left, rest, below, stretch);
    return stretch;
  }
  return std::nullopt;
}

/// As long as the mode does.
void Motion::go_on(std::size_t k, const std::vector<double>& left, double rest, double below, Stretch& stretch) const {
  double low = stretch.length, high = rest;
  for (int bisection = 0; bisection < bisections && low < high; ++bisection) {
    const double length = bisection == 0 ? rest : 0.5 * (low + high);
    auto own = trial_.solve(left, k, stretch.modes, length, &stretch.own);
    if (own && trial_.is_admissible(*own, below)) {
      low = length;
      stretch.own = std::move(*own);
    } else {
      high = length;
    }
  }
  stretch.length = low;
}

std::optional<Stretches> Motion::interval(std::size_t k, std::vector<double>& left) {
  Stretches stretches;
  double rest = 1.0;
  while (rest > short_share) {
    if (stretches.size() == most_stretches) return std::nullopt;
    auto next = step(k, left, rest);
    if (!next) return std::nullopt;
    if (!next->stands) rest -= next->length;
    left = trial_.right_of(next->own);
    last_ = next->modes;
    stretches.push_back(std::move(*next));
  }
  return stretches;
}

struct MotionModes {
  ModeSequence sequence;
};

std::vector<int> elements_of(const MotionModes& modes) {
  std::vector<int> counts;
  for (const auto& [k, stretches] : modes.sequence) counts.push_back(static_cast<int>(stretches.size()));
  return counts;
}

std::shared_ptr<const MotionModes> OcpProblem::motion_modes(mpcc::ConstVectorView w,
                                                            const std::function<bool()>& is_over) const {
  const auto& made = *implementation_->structure;
  if (made.kernel.pairs.empty()) return nullptr;
  Motion motion(made, w, is_over);
  std::vector<double> left = ElementTrial(made, w).left_of(0);
  MotionModes modes;
  for (std::size_t k = 0; k < made.interval.size(); ++k) {
    if (made.interval[k].elements > 1 && made.interval[k].lengths.empty()) return nullptr;
    auto stretches = motion.interval(k, left);
    if (!stretches) return nullptr;
    modes.sequence.emplace(k, std::move(*stretches));
  }
  return std::make_shared<const MotionModes>(std::move(modes));
}

std::optional<mpcc::NamedStart> OcpProblem::motion(mpcc::ConstVectorView w, const std::function<bool()>& is_over) {
  const auto modes = motion_modes(w, is_over);
  return modes ? motion(w, *modes) : std::nullopt;
}

std::optional<mpcc::NamedStart> OcpProblem::motion(mpcc::ConstVectorView w, const MotionModes& modes) {
  const auto& made = *implementation_->structure;
  std::vector<ActiveSide> sides;
  linalg::Vector c(rows());
  functions(w, c);
  const auto G = c.segment(constraints(), pairs()), H = c.tail(pairs());
  for (int i = 0; i < pairs(); ++i) sides.push_back(G[i] <= H[i] ? ActiveSide::G : ActiveSide::H);
  auto realised = realise(made, ElementSides(made, sides), w, modes.sequence);
  if (!realised) return std::nullopt;  // what shorter elements change at the next surface is left to the solver
  return mpcc::NamedStart{.name = "a motion", .w = std::move(realised->w), .sides = std::move(realised->sides)};
}

}  // namespace saltus::discretization
