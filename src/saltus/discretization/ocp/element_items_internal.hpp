// The elements of an interval as a list from which others can be written.
#pragma once

#include <utility>
#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"

namespace saltus::discretization {

/// Holds an element whose variables another one takes, with modes and its length in parts of a control interval's.
struct Item {
  std::size_t element = 0;
  double length = 0.0;
  ElementSides::Sides modes{};
  linalg::Vector own{};  ///< its variables, where it has been solved anew
};
using Items = std::vector<Item>;

/// Reads intervals as items, and writes moves from changed ones.
class ElementItems {
 public:
  ElementItems(const OcpStructure& made, const ElementSides& modes, mpcc::ConstVectorView w)
      : made_(made), modes_(modes), w_(w) {}

  [[nodiscard]] Items of_interval(std::size_t k) const;
  [[nodiscard]] bool stands_still(std::size_t element) const;
  [[nodiscard]] bool is_at_bound(const Item& item) const;
  [[nodiscard]] double value(int place) const { return value_at(place, w_, made_.constants); }
  /// Adds the move to these items in these intervals, if they fit.
  void add(std::vector<std::pair<std::size_t, Items>> changes, std::vector<mpcc::BranchMove>& moves) const;
  /// Adds the move to these items in one interval, if they fit, its elements solved anew, one after the other.
  /// @return whether they have room: they fit, and none begins longer than it may be
  bool add_solved(std::size_t k, Items items, std::vector<mpcc::BranchMove>& moves) const;
  [[nodiscard]] static double length_of(const Items& items);

 private:
  [[nodiscard]] int speed_of(std::size_t k) const;
  [[nodiscard]] bool fit(Items& items, int elements) const;
  [[nodiscard]] bool make_equal(std::size_t k, Items& items) const;
  void begin_at_end(std::size_t from, std::size_t to, linalg::Vector& start) const;
  void write(std::size_t k, const Items& items, mpcc::BranchMove& move) const;

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
};

}  // namespace saltus::discretization
