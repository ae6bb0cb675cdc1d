// Newton's corrections from the systems of an active set.
#pragma once

#include <utility>
#include <vector>

#include "saltus/linalg/block_ldl.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::solver::crossover {

/// Holds which bounds and rows hold with equality, and where the others stand in the system.
struct ActiveSet {
  std::vector<int> column;  ///< of each variable that no active bound holds; else -1
  linalg::Vector held;      ///< values of the others
  std::vector<int> line;    ///< of each active row; else -1
  linalg::Vector target;    ///< values of active rows
  int variables = 0;
  int rows = 0;
};

/// Holds the lower triangle of a symmetric matrix; entries of one place add up.
struct Symmetric {
  linalg::Index size = 0;
  std::vector<int> rows, columns;
  std::vector<double> values;

  void add(int row, int column, double value);
  [[nodiscard]] linalg::Vector times(const linalg::Vector& x) const;
};

/// Solves exact systems of an active set by corrections with the factors of a regularised one, as rows may depend on
/// each other. The factors need not be of the same point.
/// Cost: one factorisation, in the order of the problem, wherever old factors correct too slowly.
class Corrector {
 public:
  Corrector(const mpcc::Problem& nlp, const ActiveSet& active) : nlp_(nlp), active_(active) {}

  /// Places of entries are those of the first call.
  [[nodiscard]] linalg::Vector solve(const Symmetric& system, const linalg::Vector& right);

 private:
  void factorise(Symmetric system);
  /// The solution and the norm of what it leaves.
  [[nodiscard]] std::pair<linalg::Vector, double> corrected(const Symmetric& system, const linalg::Vector& right);

  const mpcc::Problem& nlp_;
  const ActiveSet& active_;
  bool has_factors_ = false;
  linalg::BlockLdl factors_;
};

}  // namespace saltus::solver::crossover
