// The modes of elements in a branch, and moves that change those of several.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/ocp_structure_internal.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::discretization {

/// The share of an interval that an element gets which is to appear: far enough from zero to move.
inline constexpr double small_share = 0.02;
/// Lengths below this share of an interval are zero.
inline constexpr double vanished = 1e-6;

/// Holds the modes of elements: sides of their pairs by selection.
class ElementSides {
 public:
  using Sides = std::vector<mpcc::ActiveSide>;
  ElementSides(const OcpStructure& made, Sides sides)
      : made_(made), sides_(std::move(sides)), selections_(made.kernel.pairs.size()) {
    if (made.chain.elements.empty() || selections_ == 0) return;
    const int cross = made.chain.elements.front().pairs.count - made.kernel.correction_pairs;
    per_selection_ = cross / static_cast<int>(selections_);
  }

  [[nodiscard]] mpcc::ActiveSide of(std::size_t element, std::size_t selection) const {
    return sides_[first(element, selection)];
  }
  [[nodiscard]] bool are_equal(std::size_t a, std::size_t b) const {
    for (std::size_t k = 0; k < selections_; ++k) {
      if (of(a, k) != of(b, k)) return false;
    }
    return true;
  }
  /// Returns all of them, with the modes of element `from` in element `to`, too.
  [[nodiscard]] Sides copied(std::size_t from, std::size_t to) const {
    Sides changed = sides_;
    copy(from, to, changed);
    return changed;
  }
  /// Gives others the modes of element `from` in element `to`.
  void copy(std::size_t from, std::size_t to, Sides& changed) const { write(modes(from), to, changed); }
  /// Returns one side per selection of an element.
  [[nodiscard]] Sides modes(std::size_t element) const {
    Sides modes;
    for (std::size_t k = 0; k < selections_; ++k) modes.push_back(of(element, k));
    return modes;
  }
  void write(const Sides& modes, std::size_t to, Sides& changed) const {
    for (std::size_t k = 0; k < selections_; ++k) {
      std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(first(to, k)), per_selection_, modes[k]);
    }
  }
  [[nodiscard]] const Sides& all() const { return sides_; }

  /// Returns the sum of numbers of pairs, over those of a selection in an element.
  [[nodiscard]] double sum(mpcc::ConstVectorView of_pairs, std::size_t element, std::size_t selection) const {
    return of_pairs.segment(static_cast<linalg::Index>(first(element, selection)), per_selection_).sum();
  }

 private:
  [[nodiscard]] std::size_t first(std::size_t element, std::size_t selection) const {
    return static_cast<std::size_t>(made_.chain.elements[element].pairs.first) +
           selection * static_cast<std::size_t>(per_selection_);
  }

  const OcpStructure& made_;
  Sides sides_;
  std::size_t selections_;
  int per_selection_ = 0;
};

}  // namespace saltus::discretization
