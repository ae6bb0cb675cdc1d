// Functions of a few neighbouring variables with exact derivatives, made once and used for every element of a chain.
#pragma once

#include <string>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/native_functions.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::discretization {

/// Holds what an element, or the boundary between two, adds to a problem: an objective and rows (g, G, H) over local
/// variables z and parameters. All of g are equations g = 0.
struct LocalExpressions {
  casadi::SX objective = 0.0;
  std::vector<casadi::SX> g;  ///< scalars
  std::vector<casadi::SX> G;
  std::vector<casadi::SX> H;
  std::vector<mpcc::Sign> G_signs;
  std::vector<mpcc::Sign> H_signs;

  void equation(const casadi::SX& rows) {
    for (casadi_int i = 0; i < rows.numel(); ++i) g.push_back(rows(i));
  }
  /// Appends the other's expressions to these.
  [[nodiscard]] LocalExpressions joined(const LocalExpressions& other) const;
  /// Adds a pair whose sides are both sums of variables with lower bound 0.
  void pair(const casadi::SX& a, const casadi::SX& b, mpcc::Sign sign = mpcc::Sign::implied) {
    G.push_back(a);
    H.push_back(b);
    G_signs.push_back(sign);
    H_signs.push_back(mpcc::Sign::implied);
  }
};

class LocalFunction {
 public:
  LocalFunction() = default;
  LocalFunction(const std::string& name, const casadi::SX& z, const casadi::SX& parameters,
                const LocalExpressions& expressions);
  /// Adds its functions to those that are to become native code together; `native` and this stay where they are.
  void join(evaluation::NativeFunctions& native, std::vector<model::ModelFunction*>& functions);

  [[nodiscard]] int variables() const { return variables_; }
  [[nodiscard]] int equations() const { return equations_; }
  [[nodiscard]] int pairs() const { return pairs_; }
  [[nodiscard]] const std::vector<mpcc::Sign>& signs() const { return signs_; }  ///< of G, then of H
  [[nodiscard]] bool has_objective() const { return has_objective_; }
  /// Returns patterns over rows (g, G, H) and local variables; of the Hessian the lower triangle.
  [[nodiscard]] const mpcc::Pattern& jacobian_pattern() const { return jacobian_pattern_; }
  [[nodiscard]] const mpcc::Pattern& hessian_pattern() const { return hessian_pattern_; }

  void values(const double* z, const double* parameters, double* objective, double* rows);
  void gradient(const double* z, const double* parameters, double* gradient);  ///< of the objective, dense
  void jacobian(const double* z, const double* parameters, double* values);
  void hessian(const double* z, const double* parameters, double factor, const double* y, double* values);
  /// Returns the number of elementary operations of one evaluation of everything.
  [[nodiscard]] long operations() const;

 private:
  int variables_ = 0, equations_ = 0, pairs_ = 0;
  bool has_objective_ = false;
  std::vector<mpcc::Sign> signs_;
  mpcc::Pattern jacobian_pattern_;
  mpcc::Pattern hessian_pattern_;
  model::ModelFunction values_, gradient_, jacobian_, hessian_;
  evaluation::NativeFunctions* native_ = nullptr;
};

}  // namespace saltus::discretization
