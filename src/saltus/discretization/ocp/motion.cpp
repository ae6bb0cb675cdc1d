#include <algorithm>
#include <utility>

#include "saltus/discretization/ocp/motion_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;
using Modes = ElementSides::Sides;

/// Of an interval: so long a mode must go on to be one. What is left at the end of an interval is not missed.
constexpr double short_share = 1e-4;
/// Surfaces that may be reached at once: there are three modes for each.
constexpr std::size_t most_reached = 5;
/// A switch is found by bisection: to rounding.
constexpr int bisections = 45;

/// As many pieces as there are elements: the longest in which time goes on are divided into equal ones.
std::vector<MotionPiece> divided(const std::vector<MotionPiece>& pieces, int elements) {
  std::vector<int> parts(pieces.size(), 1);
  for (int n = static_cast<int>(pieces.size()); n < elements; ++n) {
    std::size_t longest = 0;
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      const auto part = [&](std::size_t p) { return pieces[p].stands ? 0.0 : pieces[p].length / parts[p]; };
      if (part(i) > part(longest)) longest = i;
    }
    ++parts[longest];
  }
  std::vector<MotionPiece> all;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (int part = 0; part < parts[i]; ++part) {
      all.push_back(pieces[i]);
      all.back().length /= parts[i];
    }
  }
  return all;
}

/// Writes the elements of interval k into the variables.
/// @return whether the equations of all of them have a solution
bool write(const OcpStructure& made, std::size_t k, const std::vector<MotionPiece>& pieces, std::vector<double> left,
           linalg::Vector& w) {
  const auto& interval = made.interval[k];
  double sum = 0.0;
  for (const auto& piece : pieces) sum += piece.length;
  const ElementTrial trial(made, w);
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    const auto e = at(interval.first_element) + n;
    const auto own = trial.solve(left, k, pieces[n].modes, pieces[n].length);
    if (!own) return false;
    left = trial.right_of(*own);
    w.segment(made.element[e].first, own->size()) = *own;
    const int h = made.element[e].length;
    if (h >= 0) w[h] = pieces[n].length / sum;
  }
  const int speed = interval.shared[at(made.kernel.shared.speed())];
  if (speed >= 0) w[speed] = sum;
  return true;
}

}  // namespace

/// What goes on first, then what differs at the surfaces that are reached: 0 is to slide. None where these are many.
std::vector<Modes> Motion::candidates(const std::vector<double>& lambda) const {
  Modes here(lambda.size());
  for (std::size_t k = 0; k < lambda.size(); ++k) here[k] = lambda[k] > on_surface ? ActiveSide::G : ActiveSide::H;
  std::vector<std::size_t> reached;
  for (std::size_t s = 0; s < states_.count(); ++s) {
    if (states_.is_on(s, lambda)) reached.push_back(s);
  }
  if (reached.size() > most_reached) return {};
  std::vector<Modes> list{here};
  for (const std::size_t s : reached) {
    const std::size_t count = list.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (const int state : {-1, 1}) list.push_back(states_.with(list[i], s, state));
    }
  }
  const auto changes = [&](const Modes& modes) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < last_.size(); ++k) count += modes[k] != last_[k] ? 1U : 0U;
    return count;
  };
  std::stable_sort(list.begin(), list.end(), [&](const Modes& a, const Modes& b) { return changes(a) < changes(b); });
  return list;
}

std::optional<Motion::Step> Motion::step(std::size_t k, const std::vector<double>& left, double rest) const {
  for (const auto& modes : candidates(trial_.lambda(left))) {
    Step step{{modes, std::min(short_share, rest), false}, {}};
    auto own = trial_.solve(left, k, modes, step.piece.length);
    if (own && trial_.stands_still(left, *own)) {
      step.piece.stands = true;
      own = trial_.solve_to_end(left, k, modes, step.piece.length);
    }
    if (!own || !trial_.is_admissible(*own)) continue;
    step.own = std::move(*own);
    if (!step.piece.stands) go_on(k, left, rest, step);
    return step;
  }
  return std::nullopt;
}

/// As long as the mode does.
void Motion::go_on(std::size_t k, const std::vector<double>& left, double rest, Step& step) const {
  double low = step.piece.length, high = rest;
  for (int bisection = 0; bisection < bisections && low < high; ++bisection) {
    const double length = bisection == 0 ? rest : 0.5 * (low + high);
    auto own = trial_.solve(left, k, step.piece.modes, length);
    if (own && trial_.is_admissible(*own)) {
      low = length;
      step.own = std::move(*own);
    } else {
      high = length;
    }
  }
  step.piece.length = low;
}

std::optional<std::vector<MotionPiece>> Motion::interval(std::size_t k, std::vector<double>& left) {
  std::vector<MotionPiece> pieces;
  double rest = 1.0;
  while (rest > short_share) {
    if (static_cast<int>(pieces.size()) == made_.interval[k].elements) return std::nullopt;
    const auto next = step(k, left, rest);
    if (!next) return std::nullopt;
    if (!next->piece.stands) rest -= next->piece.length;
    left = trial_.right_of(next->own);
    last_ = next->piece.modes;
    pieces.push_back(next->piece);
  }
  return pieces;
}

bool realise(const OcpStructure& made, linalg::Vector& w, ElementSides::Sides& sides) {
  const linalg::Vector begin_w = w;
  Motion motion(made, begin_w);
  const ElementSides modes(made, sides);
  std::vector<double> left = ElementTrial(made, begin_w).left_of(0);
  for (std::size_t k = 0; k < made.interval.size(); ++k) {
    const auto begin = left;
    const auto pieces = motion.interval(k, left);
    if (!pieces) return false;
    const auto elements = divided(*pieces, made.interval[k].elements);
    const bool have_lengths = elements.size() == 1 || !made.interval[k].lengths.empty();
    if (!have_lengths || !write(made, k, elements, begin, w)) return false;
    for (std::size_t n = 0; n < elements.size(); ++n) {
      modes.write(elements[n].modes, at(made.interval[k].first_element) + n, sides);
    }
  }
  return true;
}

std::optional<mpcc::NamedStart> OcpProblem::motion(mpcc::ConstVectorView w) {
  const auto& made = *implementation_->structure;
  if (made.kernel.pairs.empty()) return std::nullopt;
  mpcc::NamedStart start{.name = "a motion", .w = w, .sides = {}};
  linalg::Vector c(rows());
  functions(w, c);
  const auto G = c.segment(constraints(), pairs()), H = c.tail(pairs());
  for (int i = 0; i < pairs(); ++i) start.sides.push_back(G[i] <= H[i] ? ActiveSide::G : ActiveSide::H);
  if (!realise(made, start.w, start.sides)) return std::nullopt;
  return start;
}

}  // namespace saltus::discretization
