// Which modes the elements of an interval have, one after the other: read from a point, and made into another one.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"

namespace saltus::discretization {

/// Holds elements of equal modes and lengths, one behind the other, in an interval.
struct Stretch {
  ElementSides::Sides modes;
  double length = 0.0;  ///< of all of them, in parts of a control interval
  int elements = 1;
  bool stands = false;         ///< time stands still
  std::size_t origin = 0;      ///< an element: where equations have no solution its variables are a start
  linalg::Vector own{};        ///< those of one element instead, if they are known
  std::vector<double> left{};  ///< where it begins, if not where the one before ends
  [[nodiscard]] double of_element() const { return length / elements; }
  [[nodiscard]] bool has_vanished() const { return length <= vanished; }
};
using Stretches = std::vector<Stretch>;
/// Stretches of intervals by their numbers; an interval that is not there stays as it is.
using ModeSequence = std::map<std::size_t, Stretches>;

/// Returns the stretches of elements `first` to `end` - 1, which belong to one interval.
[[nodiscard]] Stretches stretches_of(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w,
                                     std::size_t first, std::size_t end);

/// Gives stretches as many elements as an interval has: elements are halved where time goes on, and where they would be
/// longer than the bound, a share of all of them. False where stretches are more than elements.
[[nodiscard]] bool fit(Stretches& stretches, int elements, double bound);

/// Holds a point whose elements have the modes of a sequence.
struct Realisation {
  ElementSides::Sides sides;
  linalg::Vector w;
  bool is_solved = true;  ///< the equations of all elements have a solution
  bool has_room = true;   ///< no element is longer than it may be
};

/// Solves the elements of a sequence one after the other. Elements too many divide the longest stretches; where there
/// are too few, stretches of length zero are left out, and others have fewer. Nothing where stretches are more than
/// elements.
/// @param w  controls, parameters, and what stays as it is
/// Cost: a few small linear systems per element of these intervals.
[[nodiscard]] std::optional<Realisation> realise(const OcpStructure& made, const ElementSides& modes,
                                                 mpcc::ConstVectorView w, ModeSequence sequence);

}  // namespace saltus::discretization
