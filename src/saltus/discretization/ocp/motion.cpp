#include <algorithm>
#include <cmath>
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
/// Of what is left of an interval.
constexpr double at_end = 1e-12;

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

/// While contacts hold time is slower than the numerical one: in parts of an interval.
double Motion::passed(const std::vector<double>& left, const Stretch& stretch) const {
  const int clock = made_.kernel.clock;
  if (clock < 0) return stretch.length;
  return (trial_.right_of(stretch.own)[at(clock)] - left[at(clock)]) / trial_.interval_length();
}

/// As long as the mode does, or until the interval ends.
void Motion::go_on(std::size_t k, const std::vector<double>& left, double rest, double below, Stretch& stretch) const {
  double length = stretch.length * rest / passed(left, stretch), high = 0.0;
  for (int bisection = 0; bisection < bisections && (high == 0.0 || stretch.length < high); ++bisection) {
    auto own = trial_.solve(left, k, stretch.modes, length, &stretch.own);
    if (own && trial_.is_admissible(*own, below)) {
      stretch.length = length;
      stretch.own = std::move(*own);
      const double part = rest / passed(left, stretch);
      if (high == 0.0 && std::abs(part - 1.0) <= at_end) return;
      if (high == 0.0) length *= part;
    } else {
      high = length;
    }
    if (high > 0.0) length = 0.5 * (stretch.length + high);
  }
}

std::optional<Stretches> Motion::interval(std::size_t k, std::vector<double>& left) {
  Stretches stretches;
  auto back = near_ && k > 0 ? near_->at_begin_of(k, left) : std::nullopt;
  if (back) left = *back;
  double rest = 1.0;
  while (rest > short_share) {
    if (stretches.size() == most_stretches) return std::nullopt;
    auto next = step(k, left, rest);
    if (!next) return std::nullopt;
    if (!next->stands) rest -= passed(left, *next);
    left = trial_.right_of(next->own);
    last_ = next->modes;
    stretches.push_back(std::move(*next));
  }
  if (back) stretches.front().left = std::move(*back);
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
                                                            const std::function<bool()>& is_over,
                                                            bool stays_near) const {
  const auto& made = *implementation_->structure;
  if (made.kernel.pairs.empty()) return nullptr;
  const auto near = stays_near ? std::optional<NearStates>(std::in_place, made, w, read(w).parameters) : std::nullopt;
  Motion motion(made, w, near ? &*near : nullptr, is_over);
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
