// Equal elements of one active set, solved one after the other.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/part_length_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/fesd_integrator/run/root_warps_internal.hpp"
#include "saltus/fesd_integrator/watch/coarseness.hpp"

namespace saltus::fesd_integrator {

class Chain {
 public:
  /// All must outlive it.
  Chain(RunContext& context, Position& position, PartLength& length, const Coarseness& coarseness);

  enum class Solved { all, violated, missed, coarse, failed };
  /// Solves elements of length h from the position, up to the first that violates a condition, jumps over a switch or
  /// is too coarse.
  [[nodiscard]] Solved solve(int count, double h, Violation& violation);
  /// Does the same whatever they violate, with warps at both ends. `first`: whether there are no stage values of a try
  /// before, so that they are extrapolated.
  enum class Try { first, again };
  [[nodiscard]] bool solve_to_end(int count, double h, TimeWarp warp, Try which);
  /// Looks at solved elements again, at all conditions, in their order, and notes the selections between them. `take(k,
  /// answer, violation)` returns whether to go on.
  template <class Take>
  void look_again(int count, Take&& take);
  /// Returns whether an element's estimated error is beyond its share, and shorter ones are allowed; notes the share.
  [[nodiscard]] bool is_too_coarse(const Element& element, const std::vector<double>& errors);
  /// Forgets divisions: what was divided because it jumped over a switch has got to one, or to an end.
  void forget_jumps() { divided_for_look_ = 0; }

  /// Returns how many are solved.
  [[nodiscard]] std::size_t count() const { return count_; }
  void set_count(std::size_t count) { count_ = count; }
  [[nodiscard]] Element& element(std::size_t k) { return elements_[k]; }
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  /// Returns the selections at the left ends; that of the right end of the last one is behind.
  [[nodiscard]] std::vector<std::vector<double>>& left() { return left_; }
  /// Returns the errors of an element, as Watch::errors.
  [[nodiscard]] const std::vector<double>& errors(std::size_t k) const { return errors_[k]; }

  /// Returns the element before the position, if the next one continues it.
  [[nodiscard]] bool continues() const { return previous_.has_value(); }
  void continue_behind(std::size_t count) { previous_ = elements_[count - 1]; }
  void interrupt() { previous_.reset(); }
  [[nodiscard]] int warp_here(double h) { return previous_ ? 1 : warps_.behind(h); }
  [[nodiscard]] RootWarps& warps() { return warps_; }

 private:
  [[nodiscard]] const Element* before(int k) const;
  [[nodiscard]] ElementSolver::Outcome solve_from(const Point& left, double h, ElementSolver::Guess guess,
                                                  Element& element);
  /// Whether a condition ends along elements of h/2, h/4, ..., as far as it may end between them.
  [[nodiscard]] bool jumps_over(const Point& left, double h, int halvings);

  RunContext& context_;
  Position& position_;
  PartLength& length_;
  const Coarseness& coarseness_;
  RootWarps warps_;
  std::vector<Element> elements_;
  std::size_t count_ = 0;
  std::vector<std::vector<double>> left_;
  std::vector<std::vector<double>> errors_;
  int divided_for_look_ = 0;  ///< halvings of the current step because it jumped over a switch
  std::optional<Element> previous_;
};

template <class Take>
void Chain::look_again(int count, Take&& take) {
  auto selections = position_.selections();
  left_[0] = selections;
  for (int k = 0; k < count; ++k) {
    const auto index = static_cast<std::size_t>(k);
    Violation violation;
    const auto answer =
        context_.watch.look(elements_[index], position_.set(), context_.held.data(), selections, violation);
    left_[index + 1] = selections;
    errors_[index] = context_.watch.errors();
    if (!take(index, answer, violation)) return;
  }
}

}  // namespace saltus::fesd_integrator
