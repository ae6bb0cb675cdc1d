// A point of a grid as elements one after the other, to be cut anew.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/discretization/ocp/element_sides_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {

/// Is the polynomial through columns at different nodes.
class Polynomial {
 public:
  /// Adds a column, unless there is one at this node.
  void add(double node, linalg::Vector value);
  [[nodiscard]] linalg::Vector at(double place) const;

 private:
  std::vector<std::pair<double, linalg::Vector>> points_;
};

/// Holds an element that has a length; times are those of the right-hand side, from 0 on.
struct Piece {
  std::size_t element = 0;
  double begin = 0.0, end = 0.0;
  std::vector<bool> modes;    ///< whether the selection of a pair is zero
  Polynomial states, lambda;  ///< over the element, from 0 to 1
};

/// Reads a point of a problem as pieces.
class EarlierPoint {
 public:
  EarlierPoint(const OcpStructure& made, const OcpSolution& solution, mpcc::ConstVectorView w);

  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
  /// Returns what the interval of an element shares.
  [[nodiscard]] const std::vector<int>& shared(const Piece& piece) const {
    return made_.interval[at(made_.element[piece.element].interval)].shared;
  }
  [[nodiscard]] double value(int place) const { return value_at(place, w_, made_.constants); }
  /// Returns where interval k of so many ends.
  [[nodiscard]] double end_of(int k, int intervals) const;
  /// Returns a group over the stages, or the points of the multipliers, at a place in an element.
  [[nodiscard]] linalg::Vector sampled(const Piece& piece, const VariableBlock& block, double place) const;
  [[nodiscard]] linalg::Vector group_of(std::size_t element, const VariableBlock& block, int group) const {
    return w_.segment(made_.element[element].variable(block.at(group)), block.size);
  }
  /// Returns whether the clock stands.
  [[nodiscard]] bool stands(const Piece& piece) const;

 private:
  [[nodiscard]] Piece piece_of(std::size_t e, double begin, const SolvedElement& solved,
                               const linalg::Vector& left) const;
  [[nodiscard]] double where_clock_is(double time) const;
  void find_least_at_start(const OcpSolution& solution);

  const OcpStructure& made_;
  mpcc::ConstVectorView w_;
  linalg::Vector least_at_start_;
  std::vector<Piece> pieces_;
  std::vector<double> nodes_;  ///< right ends of the intervals
};

}  // namespace saltus::discretization
