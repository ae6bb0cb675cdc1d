// A mathematical program with complementarity constraints: the seam between whoever states one and whoever solves it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/chain.hpp"
#include "saltus/mpcc/multipliers.hpp"

namespace saltus::mpcc {

// Vectors: one column, entries one behind the other.
using ConstVectorView = linalg::ConstView;
using VectorView = linalg::View;

/// Holds places of the entries of a sparse matrix; entries of the same place add up.
struct Pattern {
  std::vector<int> row;
  std::vector<int> column;

  [[nodiscard]] int entries() const { return static_cast<int>(row.size()); }
  void add(int r, int c) {
    row.push_back(r);
    column.push_back(c);
  }
};

/// Holds lower <= . <= upper, componentwise; -inf and +inf where there is no bound.
struct Bounds {
  linalg::Vector lower;
  linalg::Vector upper;
};

/// Says whether one side of a pair is known to be nonnegative.
enum class Sign {
  constrained,  ///< 0 <= G_i(w) is a constraint of its own
  /// Follows from the bounds of w, nobody need impose it again. The side is affine, a sum of distances of variables
  /// from their finite bounds with positive weights (w_k - lower_k where dG_i/dw_k > 0, upper_k - w_k where it is < 0).
  /// So it is zero if and only if each of them is at that bound. A product of such sums is `implied`, too, but then it
  /// has to be a method's own (Problem::pair_group -1).
  implied,
};

/// Says which side of a pair is zero.
enum class ActiveSide {
  G,         ///< G_i is zero, H_i is not
  H,         ///< H_i is zero, G_i is not
  biactive,  ///< both
  none,      ///< neither: not complementary
};

/// Holds what a branch problem fixes besides the sides of its pairs (Problem::close_branch).
struct BranchClosure {
  std::vector<int> at_lower;               ///< variables fixed at their lower bounds
  std::vector<int> at_upper;               ///< and upper ones
  std::vector<std::pair<int, int>> equal;  ///< variables of equal value
  std::vector<int> dropped_rows;           ///< of g: those of a method, not of the user's problem
  /// Holds what the branch leaves open, not what the user asks for: variables fixed at a bound, and rows of g without
  /// bounds that are equations here, g = 0. A solver may do without them where they leave no solution.
  struct Freedom {
    std::vector<int> at_lower, at_upper, rows;
    [[nodiscard]] bool is_empty() const { return at_lower.empty() && at_upper.empty() && rows.empty(); }
  } freedom;
};

/// Holds another choice of sides, and where to begin to solve it.
struct BranchMove {
  std::vector<ActiveSide> sides;
  linalg::Vector start;
  /// Change of the objective to first order, by the multipliers of the branch; nothing where they do not say it.
  std::optional<double> price{};
  std::vector<int> appearing{};  ///< variables that may not come back to 0 before the branch is known to be better
  std::string name{};            ///< what it does
  bool is_simpler = false;       ///< it leaves out variables that are 0: the same objective is as good
};

/// Holds a point to begin at.
struct NamedStart {
  std::string name;
  linalg::Vector w;
  std::vector<ActiveSide> sides{};  ///< where they are known: its branch needs no relaxed problem
};

/// States min f(w)   subject to   lower_w <= w <= upper_w,   lower_g <= g(w) <= upper_g,   0 <= G(w) _|_ H(w) >= 0.
///
/// All constraint functions together are c(w) = (g, G, H), n_g + 2 n_pairs rows. Patterns are fixed for the life of the
/// problem; parameters live inside of it and may be changed between solutions. Without pairs it is a nonlinear program.
///
/// A value that is not finite marks a point where the problem is undefined; functions never throw. They are not const,
/// since they may use work space of the problem: one problem per thread.
class Problem {
 public:
  Problem() = default;
  virtual ~Problem() = default;
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  [[nodiscard]] virtual int variables() const = 0;    ///< n_w
  [[nodiscard]] virtual int constraints() const = 0;  ///< n_g
  [[nodiscard]] virtual int pairs() const = 0;        ///< rows of G and of H
  [[nodiscard]] int rows() const { return constraints() + 2 * pairs(); }

  [[nodiscard]] virtual const Bounds& variable_bounds() const = 0;
  [[nodiscard]] virtual const Bounds& constraint_bounds() const = 0;  ///< of g only
  /// Returns signs for the rows of G, then those of H: 2 n_pairs.
  [[nodiscard]] virtual const std::vector<Sign>& signs() const = 0;

  [[nodiscard]] virtual double objective(ConstVectorView w) = 0;
  virtual void objective_gradient(ConstVectorView w, VectorView gradient) = 0;  ///< n_w
  virtual void functions(ConstVectorView w, VectorView c) = 0;                  ///< rows()
  /// Evaluates values of dc/dw in the order of jacobian_pattern(), which has rows() rows.
  virtual void jacobian(ConstVectorView w, VectorView values) = 0;
  /// Evaluates values of the lower triangle of factor d2f/dw2 + sum_i y_i d2c_i/dw2 in the order of hessian_pattern().
  virtual void hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) = 0;
  [[nodiscard]] virtual const Pattern& jacobian_pattern() const = 0;
  [[nodiscard]] virtual const Pattern& hessian_pattern() const = 0;

  /// Returns where to begin, n_w; by default 0, moved onto the bounds.
  [[nodiscard]] virtual linalg::Vector start() const;
  /// Returns other points to begin at, n_w each: where they lead to may be compared. By default none.
  [[nodiscard]] virtual std::vector<NamedStart> other_starts() const { return {}; }
  /// Returns the motion of the controls at w of a dynamical system, with its sides; nothing where there is none, as by
  /// default, or time is over.
  [[nodiscard]] virtual std::optional<NamedStart> motion(ConstVectorView w, const std::function<bool()>& is_over) {
    static_cast<void>(w), static_cast<void>(is_over);
    return std::nullopt;
  }
  [[nodiscard]] virtual std::string name(int variable) const;  ///< by default "w[3]"
  /// Returns the name of a row of (g, G, H); by default "g[0]", "G[5]", "H[5]".
  [[nodiscard]] virtual std::string row_name(int row) const;
  /// Returns structure for solvers that use it; null for problems without any.
  [[nodiscard]] virtual const Chain* chain() const { return nullptr; }
  /// Returns the block of each variable in an order in which a linear solver may eliminate them, block by block with
  /// increasing numbers (elimination.hpp); empty where nothing is known.
  [[nodiscard]] virtual std::vector<int> elimination_blocks() const { return {}; }

  // A discretisation may add terms of its own to the objective and rows of its own to g. They steer the relaxed
  // problems and are no part of what the user asks for.

  /// Makes objective() and its derivatives contain the method's terms, scaled for a relaxed problem that starts at w.
  /// They never do before the first call, nor after without_method_terms().
  virtual void with_method_terms(ConstVectorView w) { static_cast<void>(w); }
  virtual void without_method_terms() {}
  /// Gives parameters that a method follows down with the relaxation their values at this part of it: 1 at the first
  /// relaxed problem of a path, 0 (as before the first call) for the problem itself.
  virtual void relaxed_by(double part) { static_cast<void>(part); }
  /// Returns groups of pairs, which have the same zero side in a branch problem; -1: a pair of the method's own, which
  /// a branch problem leaves out. By default every pair is its own group.
  [[nodiscard]] virtual int pair_group(int pair) const { return pair; }
  /// Returns what else a branch problem with these zero sides (G or H, one per pair) fixes, makes equal and leaves out.
  [[nodiscard]] virtual BranchClosure close_branch(const std::vector<ActiveSide>& sides) const;
  /// Gives variables that only the rows of a method ask for the values that these rows have at w, a solution of a
  /// branch problem. By default there are none.
  virtual void complete(VectorView w) { static_cast<void>(w); }
  /// Returns sides of which none is zero that may not be: those of a branch, but where sides that are zero there are
  /// more than `paid` at w. By default these are not zero, and the others of their pairs are.
  [[nodiscard]] virtual std::vector<ActiveSide> freed(const std::vector<ActiveSide>& sides, ConstVectorView w,
                                                      double paid);
  /// Returns other sides beside a solution of a branch, with which the objective may fall though no pair is biactive:
  /// what a closure keeps apart (an element of length zero has the modes of either neighbour). By default none.
  /// @param multipliers  of the problem at w, of which those of pairs bear what their sides are held by
  [[nodiscard]] virtual std::vector<BranchMove> neighbours(const std::vector<ActiveSide>& sides, ConstVectorView w,
                                                           const Multipliers& multipliers);
};

}  // namespace saltus::mpcc
