// A statement as functions of doubles with exact derivatives.
#pragma once

#include <vector>

#include "saltus/foreign/problem.hpp"
#include "saltus/foreign/statement.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::foreign {

/// Holds functions of w that are evaluated once per point.
class CachedFunction {
 public:
  CachedFunction() = default;
  CachedFunction(const std::string& name, const casadi::SX& w, const casadi::SX& first, const casadi::SX& second);
  /// Evaluates, if w is not the point of the last call.
  void at(mpcc::ConstVectorView w);
  [[nodiscard]] const linalg::Vector& first() const { return first_; }
  [[nodiscard]] const linalg::Vector& second() const { return second_; }

 private:
  model::ModelFunction function_;
  linalg::Vector w_, first_, second_;
};

struct Problem::Implementation {
  Statement statement;
  mpcc::Bounds variable_bounds, constraint_bounds, row_ranges;
  std::vector<mpcc::Sign> signs;
  mpcc::Pattern jacobian_pattern, hessian_pattern;
  CachedFunction values;       ///< objective; (g, G, H)
  CachedFunction derivatives;  ///< gradient; entries of the Jacobian
  model::ModelFunction hessian;
  model::ModelFunction bodies;  ///< of splits
};

}  // namespace saltus::foreign
