// A mathematical program with complementarity constraints: the seam between whoever states one and whoever solves it.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace saltus::mpcc {

using ConstVectorView = Eigen::Ref<const Eigen::VectorXd>;
using VectorView = Eigen::Ref<Eigen::VectorXd>;

/// Places of the entries of a sparse matrix; entries of the same place add up.
struct Pattern {
  std::vector<int> row;
  std::vector<int> column;

  [[nodiscard]] int entries() const { return static_cast<int>(row.size()); }
  void add(int r, int c) {
    row.push_back(r);
    column.push_back(c);
  }
};

/// lower <= . <= upper, componentwise; -inf and +inf where there is no bound.
struct Bounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

/// Whether one side of a pair is known to be nonnegative.
enum class Sign {
  constrained,  ///< 0 <= G_i(w) is a constraint of its own
  implied,      ///< follows from the bounds of w: nobody need impose it again
};

/// min f(w)   subject to   lower_w <= w <= upper_w,   lower_g <= g(w) <= upper_g,   0 <= G(w) _|_ H(w) >= 0.
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
  /// For the rows of G, then those of H: 2 n_pairs.
  [[nodiscard]] virtual const std::vector<Sign>& signs() const = 0;

  [[nodiscard]] virtual double objective(ConstVectorView w) = 0;
  virtual void objective_gradient(ConstVectorView w, VectorView gradient) = 0;  ///< n_w
  virtual void functions(ConstVectorView w, VectorView c) = 0;                  ///< rows()
  /// Values of dc/dw in the order of jacobian_pattern(), which has rows() rows.
  virtual void jacobian(ConstVectorView w, VectorView values) = 0;
  /// Values of the lower triangle of factor d2f/dw2 + sum_i y_i d2c_i/dw2 in the order of hessian_pattern().
  virtual void hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) = 0;
  [[nodiscard]] virtual const Pattern& jacobian_pattern() const = 0;
  [[nodiscard]] virtual const Pattern& hessian_pattern() const = 0;
};

}  // namespace saltus::mpcc
