// Which model functions are affine in (t, x), and their rows, or linear parts, as functions of (p, alpha).
#pragma once

#include <cstddef>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/evaluation/sparse/used_symbols_internal.hpp"
#include "saltus/model/graph/model_function.hpp"
#include "saltus/ode/linear_field.hpp"

namespace saltus::evaluation {

using model::ModelFunction;

/// Returns for every entry of `expression` whether it is affine in t and x (`fixed` >= 0: but for this component, a
/// constant), by the operations it is made of. Sufficient, not necessary: x * x / x is not.
[[nodiscard]] std::vector<bool> affine_entries(const casadi::SX& expression, const ModelSymbols& symbols,
                                               int fixed = -1);

/// Holds rows of the affine entries of a vector of functions.
class AffineRowFunctions {
 public:
  AffineRowFunctions() = default;
  AffineRowFunctions(const casadi::SX& functions, const ModelSymbols& symbols, const std::vector<bool>& affine);
  void fill(const double* p, const double* alpha, AffineRows& rows);
  /// Evaluates coefficients, rates, offsets. Valid as long as this does not move.
  [[nodiscard]] ModelFunction& function() { return values_; }

 private:
  ModelFunction values_;
  std::vector<double> origin_;
  std::vector<std::size_t> start_, column_;
};

/// Holds one function as a row, if it is affine in what is not fixed.
class AffineRowFunction {
 public:
  AffineRowFunction() = default;
  AffineRowFunction(const casadi::SX& function, const casadi::SX& t, UsedSymbols used, int fixed);
  [[nodiscard]] bool is_affine() const { return !values_.is_null(); }
  void fill(FixedState fixed, const double* p, const double* alpha, AffineRow& row);

 private:
  ModelFunction values_;  ///< null where it is not affine; of the used symbols
  std::vector<std::size_t> states_, parameters_, alphas_;
  int fixed_ = -1;  ///< position among the states
  std::vector<double> origin_, p_, alpha_;
};

/// Holds the linear part of a right-hand side, if it is affine.
class LinearFieldFunction {
 public:
  LinearFieldFunction(const casadi::SX& f, const ModelSymbols& symbols);
  [[nodiscard]] bool is_affine() const { return !values_.is_null(); }
  /// Returns whether it is the same for all selections.
  [[nodiscard]] bool is_constant() const { return constant_; }
  void fill(const double* p, const double* alpha, ode::LinearField& field);

 private:
  ModelFunction values_;  ///< entries of A row by row, c; null where it is not affine
  bool constant_ = false;
  std::vector<std::size_t> start_, column_;  ///< of the entries
  std::vector<double> entries_;
};

}  // namespace saltus::evaluation
