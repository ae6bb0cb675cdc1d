// Small problems whose functions are polynomials, with exact dense derivatives; for tests.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// coefficient * prod_i w_i^powers_i; missing powers are 0.
struct Monomial {
  double coefficient;
  std::vector<int> powers;

  [[nodiscard]] int power(int i) const {
    return static_cast<std::size_t>(i) < powers.size() ? powers[static_cast<std::size_t>(i)] : 0;
  }
  [[nodiscard]] double value(ConstVectorView w) const {
    double product = coefficient;
    for (int i = 0; i < w.size(); ++i) product *= std::pow(w[i], power(i));
    return product;
  }
  [[nodiscard]] Monomial derivative(int i) const {
    Monomial result = *this;
    result.coefficient *= power(i);
    result.powers.resize(std::max(result.powers.size(), static_cast<std::size_t>(i) + 1));
    if (power(i) > 0) --result.powers[static_cast<std::size_t>(i)];
    return result;
  }
};

struct Polynomial {
  std::vector<Monomial> terms;

  [[nodiscard]] double value(ConstVectorView w) const {
    double sum = 0.0;
    for (const auto& term : terms) sum += term.value(w);
    return sum;
  }
  [[nodiscard]] Polynomial derivative(int i) const {
    Polynomial result;
    for (const auto& term : terms) result.terms.push_back(term.derivative(i));
    return result;
  }
};

/// What a PolynomialProblem is made of.
struct PolynomialStatement {
  int variables = 0;
  Polynomial f;
  std::vector<Polynomial> g;
  std::vector<Polynomial> G;
  std::vector<Polynomial> H;
  Bounds w_bounds;  ///< none if empty
  Bounds g_bounds;
  std::vector<int> elimination_blocks{};  ///< unknown if empty
};

class PolynomialProblem : public Problem {
 public:
  explicit PolynomialProblem(PolynomialStatement statement) : statement_(std::move(statement)) {
    auto& [n, f, g, G, H, w_bounds, g_bounds, blocks] = statement_;
    if (w_bounds.lower.size() == 0) {
      w_bounds.upper = linalg::Vector::constant(n, std::numeric_limits<double>::infinity());
      w_bounds.lower = -w_bounds.upper;
    }
    rows_ = g;
    rows_.insert(rows_.end(), G.begin(), G.end());
    rows_.insert(rows_.end(), H.begin(), H.end());
    signs_.assign(G.size() + H.size(), Sign::constrained);
    for (int row = 0; row < rows(); ++row) {
      for (int i = 0; i < n; ++i) jacobian_.add(row, i);
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) hessian_.add(i, j);
    }
  }

  [[nodiscard]] int variables() const override { return statement_.variables; }
  [[nodiscard]] int constraints() const override { return static_cast<int>(statement_.g.size()); }
  [[nodiscard]] int pairs() const override { return static_cast<int>(statement_.G.size()); }
  [[nodiscard]] const Bounds& variable_bounds() const override { return statement_.w_bounds; }
  [[nodiscard]] const Bounds& constraint_bounds() const override { return statement_.g_bounds; }
  [[nodiscard]] const std::vector<Sign>& signs() const override { return signs_; }
  [[nodiscard]] double objective(ConstVectorView w) override { return statement_.f.value(w); }
  void objective_gradient(ConstVectorView w, VectorView gradient) override {
    for (int i = 0; i < variables(); ++i) gradient[i] = statement_.f.derivative(i).value(w);
  }
  void functions(ConstVectorView w, VectorView c) override {
    for (std::size_t row = 0; row < rows_.size(); ++row) c[static_cast<linalg::Index>(row)] = rows_[row].value(w);
  }
  void jacobian(ConstVectorView w, VectorView values) override {
    linalg::Index next = 0;
    for (const auto& row : rows_) {
      for (int i = 0; i < variables(); ++i) values[next++] = row.derivative(i).value(w);
    }
  }
  void hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) override {
    linalg::Index next = 0;
    for (int i = 0; i < variables(); ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum = objective_factor * statement_.f.derivative(i).derivative(j).value(w);
        for (std::size_t row = 0; row < rows_.size(); ++row) {
          sum += y[static_cast<linalg::Index>(row)] * rows_[row].derivative(i).derivative(j).value(w);
        }
        values[next++] = sum;
      }
    }
  }
  [[nodiscard]] const Pattern& jacobian_pattern() const override { return jacobian_; }
  [[nodiscard]] const Pattern& hessian_pattern() const override { return hessian_; }
  [[nodiscard]] std::vector<int> elimination_blocks() const override { return statement_.elimination_blocks; }
  /// Lets tests say that a side follows from bounds.
  void set_sign(int side, Sign sign) { signs_[static_cast<std::size_t>(side)] = sign; }

 private:
  PolynomialStatement statement_;
  std::vector<Polynomial> rows_;
  std::vector<Sign> signs_;
  Pattern jacobian_;
  Pattern hessian_;
};

}  // namespace saltus::mpcc
