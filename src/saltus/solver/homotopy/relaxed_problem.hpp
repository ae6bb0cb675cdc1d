// A problem with complementarities as a nonlinear program: each pair by a relaxation.
#pragma once

#include <vector>

#include "saltus/mpcc/problem.hpp"
#include "saltus/solver/cached_functions.hpp"
#include "saltus/solver/homotopy/relaxation.hpp"
#include "saltus/solver/homotopy/steering.hpp"

namespace saltus::solver::homotopy {

/// States min f   subject to   bounds, g, G >= l and H >= l where that is not implied, phi(G_i, H_i; sigma) <= 0, with
/// rows in this order: g; the sides that are constrained; the inequalities of pair 0, pair 1, ... An elastic one
/// (steering l1, linf) has the parameters s of phi behind the variables of the problem, and min f + s / sigma. Sparsity
/// does not depend on sigma. Refers to the problem it relaxes; evaluates it once per point.
class RelaxedProblem final : public mpcc::Problem {
 public:
  RelaxedProblem(mpcc::Problem& problem, Relaxation relaxation, Steering steering = Steering::direct);
  void set_sigma(double sigma);  ///< > 0
  /// Returns w with parameters s of pairs behind it that it satisfies, if they are below their upper bound.
  [[nodiscard]] linalg::Vector with_elastic_variables(mpcc::ConstVectorView w);
  /// Returns multipliers of (g, G, H) in L = f + y'c that those of the rows here amount to: of a side also what phi
  /// asks of it.
  [[nodiscard]] linalg::Vector multipliers_of_problem(mpcc::ConstVectorView w, mpcc::ConstVectorView y);

  [[nodiscard]] int variables() const override { return problem_.variables() + elastic_; }
  [[nodiscard]] int constraints() const override { return static_cast<int>(bounds_.lower.size()); }
  [[nodiscard]] int pairs() const override { return 0; }
  [[nodiscard]] const mpcc::Bounds& variable_bounds() const override { return variable_bounds_; }
  [[nodiscard]] const mpcc::Bounds& constraint_bounds() const override { return bounds_; }
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const override { return no_signs_; }
  [[nodiscard]] double objective(mpcc::ConstVectorView w) override;
  void objective_gradient(mpcc::ConstVectorView w, mpcc::VectorView gradient) override;
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override;
  void jacobian(mpcc::ConstVectorView w, mpcc::VectorView values) override;
  void hessian(mpcc::ConstVectorView w, double objective_factor, mpcc::ConstVectorView y,
               mpcc::VectorView values) override;
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const override { return jacobian_pattern_; }
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const override { return hessian_pattern_; }
  [[nodiscard]] std::vector<int> elimination_blocks() const override;

 private:
  /// One entry of the gradient of a side of a pair.
  struct SideEntry {
    int entry = 0;  ///< in the Jacobian of the problem
    int column = 0;
    bool is_H = false;
  };
  /// One entry of the sum of outer products: coefficient phi_(p)(q) times two entries of the Jacobian.
  struct Product {
    int p = 0;  ///< entries of the Jacobian of the problem
    int q = 0;
    int sides = 0;        ///< how many of them belong to H: 0, 1, 2
    double factor = 1.0;  ///< 2 where both triangles fall on the same diagonal entry
  };
  void find_rows();
  void find_jacobian_pattern();
  void find_hessian_pattern();
  void find_elastic_hessian_pattern();
  /// Values of the mixed and second derivatives with respect to s of one pair, from `next` on.
  void add_elastic_hessian(int pair, const PairFunction& phi, mpcc::ConstVectorView jacobian, mpcc::VectorView values,
                           linalg::Index& next) const;
  [[nodiscard]] int elastic_column(int pair) const { return problem_.variables() + (elastic_ == 1 ? 0 : pair); }
  [[nodiscard]] PairFunction pair_at(int pair, int which, mpcc::ConstVectorView w, mpcc::ConstVectorView c) const;
  [[nodiscard]] int pair_row(int pair, int which) const { return first_pair_row_ + pair * inequalities_ + which; }

  mpcc::Problem& problem_;
  CachedFunctions cache_;
  Relaxation relaxation_;
  int inequalities_;
  int elastic_ = 0;  ///< how many variables s there are
  double sigma_ = 1.0;
  mpcc::Bounds variable_bounds_;
  mpcc::Bounds bounds_;
  std::vector<mpcc::Sign> no_signs_;
  std::vector<int> sign_row_;  ///< for each side the row of its own, or -1
  int first_pair_row_ = 0;
  std::vector<std::vector<SideEntry>> gradients_;  ///< one per pair: entries of G, then those of H
  std::vector<int> copied_entries_;                ///< of the Jacobian of the problem, which come first
  std::vector<std::vector<Product>> products_;     ///< one per pair
  mpcc::Pattern jacobian_pattern_;
  mpcc::Pattern hessian_pattern_;
  int first_elastic_entry_ = 0;  ///< of the Hessian, where there are any
  linalg::Vector y_;             ///< of the rows of the problem
};

}  // namespace saltus::solver::homotopy
