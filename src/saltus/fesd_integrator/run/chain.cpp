#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/run/chain_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Elements that may jump over a switch are compared with parts of them, down to this power of 1/2.
constexpr int most_divisions_for_look = 8;

}  // namespace

Chain::Chain(RunContext& context, Position& position, PartLength& length, const Coarseness& coarseness)
    : context_(context), position_(position), length_(length), coarseness_(coarseness), warps_(context, position) {
  const auto elements = static_cast<std::size_t>(context.options.elements);
  elements_.resize(elements);
  left_.resize(elements + 1);
  errors_.resize(elements);
}

bool Chain::is_too_coarse(const Element& element, const std::vector<double>& errors) {
  // Weights that nothing determines wander from stage to stage: no length makes these elements alike.
  if (!position_.is_determined()) return false;
  return length_.is_too_coarse(element.h, coarseness_.share(element, errors));
}

const Element* Chain::before(int k) const { return k > 0 ? &elements_[at(k - 1)] : previous_ ? &*previous_ : nullptr; }

ElementSolver::Outcome Chain::solve_from(const Point& left, double h, ElementSolver::Guess guess, Element& element) {
  const ActiveSet& set = position_.set();
  const double* held = context_.held.data();
  const auto outcome = context_.solver.solve(left, h, {&set, 1}, held, guess, element);
  if (outcome == ElementSolver::Outcome::solved || guess == ElementSolver::Guess::left_end) return outcome;
  return context_.solver.solve(left, h, {&set, 1}, held, ElementSolver::Guess::left_end, element);
}

Chain::Solved Chain::solve(int count, double h, Violation& violation) {
  count_ = 0;
  length_.begin_chain();
  left_[0] = position_.selections();
  Point& left = position_.left_end();
  const int behind = warp_here(h);
  for (int i = 0; i < count; ++i) {
    auto& element = elements_[at(i)];
    element.warp = {i == 0 ? behind : 1, 1};
    auto guess = position_.first_guess();
    const Element* last = before(i);
    if (position_.is_determined() && last != nullptr && h <= 2.0 * last->h && last->warp.is_none()) {
      context_.solver.extrapolate(*last, h, element);
      guess = ElementSolver::Guess::stages;
    }
    if (solve_from(left, h, guess, element) != ElementSolver::Outcome::solved) return Solved::failed;
    auto& right = left_[static_cast<std::size_t>(i) + 1];
    right = left.selections;
    count_ = static_cast<std::size_t>(i) + 1;
    switch (context_.watch.look(element, position_.set(), context_.held.data(), right, violation)) {
      case Watch::Answer::not_finite:
        return Solved::failed;
      case Watch::Answer::violated:
        return Solved::violated;
      case Watch::Answer::holds:
        break;
    }
    errors_[at(i)] = context_.watch.errors();
    if (is_too_coarse(element, context_.watch.errors())) return Solved::coarse;
    if (context_.watch.may_miss() && divided_for_look_ < most_divisions_for_look &&
        jumps_over(left, h, most_divisions_for_look)) {
      ++divided_for_look_;
      return Solved::missed;
    }
    left.t = position_.t() + (i + 1) * h;
    left.x = element.end;
    left.selections = right;
    left.size = element.size;
  }
  return Solved::all;
}

bool Chain::solve_to_end(int count, double h, TimeWarp warp, Try which) {
  Violation ignored;
  Point left = position_.left_end();
  for (int k = 0; k < count; ++k) {
    auto& element = elements_[at(k)];
    const Element* last = before(k);
    element.warp = {k == 0 ? warp.left : 1, k + 1 == count ? warp.right : 1};
    const bool continues = last != nullptr && last->warp.is_none() && element.warp.is_none();
    if (which == Try::first && continues) context_.solver.extrapolate(*last, h, element);
    const bool has_stages = position_.is_determined() && (which == Try::again || continues);
    const auto guess = has_stages ? ElementSolver::Guess::stages : position_.first_guess();
    auto right = left.selections;
    if (solve_from(left, h, guess, element) != ElementSolver::Outcome::solved ||
        context_.watch.look(element, position_.set(), context_.held.data(), right, ignored) ==
            Watch::Answer::not_finite) {
      return false;
    }
    left = {position_.t() + (k + 1) * h, element.end, right, element.size};
  }
  return true;
}

bool Chain::jumps_over(const Point& left, double h, int halvings) {
  if (halvings == 0) return false;
  Point from = left;
  Element half;
  const Element& whole = elements_[count_ - 1];
  for (int i = 0; i < 2; ++i) {
    half.warp = {from.t == whole.t ? whole.warp.left : 1, 1};
    Violation ignored;
    if (solve_from(from, 0.5 * h, position_.first_guess(), half) != ElementSolver::Outcome::solved) return true;
    auto right = from.selections;
    const auto answer = context_.watch.look(half, position_.set(), context_.held.data(), right, ignored);
    if (answer != Watch::Answer::holds) return true;
    if (context_.watch.may_miss() && jumps_over(from, 0.5 * h, halvings - 1)) return true;
    from = {from.t + 0.5 * h, half.end, right, half.size};
  }
  return false;
}

}  // namespace saltus::fesd_integrator
