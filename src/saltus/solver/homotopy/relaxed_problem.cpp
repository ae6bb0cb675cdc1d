#include "saltus/solver/homotopy/relaxed_problem.hpp"

#include <algorithm>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::solver::homotopy {

using mpcc::ConstVectorView;
using mpcc::Sign;
using mpcc::VectorView;

RelaxedProblem::RelaxedProblem(mpcc::Problem& problem, Relaxation relaxation)
    : problem_(problem),
      relaxation_(relaxation),
      inequalities_(inequalities(relaxation)),
      c_(problem.rows()),
      jacobian_(problem.jacobian_pattern().entries()),
      y_(problem.rows()) {
  find_rows();
  find_jacobian_pattern();
  find_hessian_pattern();
  set_sigma(1.0);
}

void RelaxedProblem::find_rows() {
  const int n_g = problem_.constraints();
  int row = n_g;
  for (const Sign sign : problem_.signs()) sign_row_.push_back(sign == Sign::constrained ? row++ : -1);
  first_pair_row_ = row;
  row += problem_.pairs() * inequalities_;
  const double infinity = std::numeric_limits<double>::infinity();
  bounds_.lower = Eigen::VectorXd::Constant(row, -infinity);
  bounds_.upper = Eigen::VectorXd::Constant(row, infinity);
  bounds_.lower.head(n_g) = problem_.constraint_bounds().lower;
  bounds_.upper.head(n_g) = problem_.constraint_bounds().upper;
  bounds_.upper.tail(row - first_pair_row_).setZero();
}

void RelaxedProblem::set_sigma(double sigma) {
  SALTUS_ASSERT(sigma > 0.0);
  sigma_ = sigma;
  for (const int row : sign_row_) {
    if (row >= 0) bounds_.lower[row] = lower_bound(relaxation_, sigma);
  }
}

void RelaxedProblem::find_jacobian_pattern() {
  const auto& pattern = problem_.jacobian_pattern();
  const int n_g = problem_.constraints();
  const int pairs = problem_.pairs();
  gradients_.resize(static_cast<std::size_t>(pairs));
  std::vector<std::vector<SideEntry>> of_H(gradients_.size());
  for (int entry = 0; entry < pattern.entries(); ++entry) {
    const auto e = static_cast<std::size_t>(entry);
    const int row = pattern.row[e];
    const int side = row - n_g;
    const int own_row = side < 0 ? row : sign_row_[at(side)];
    if (own_row >= 0) {
      copied_entries_.push_back(entry);
      jacobian_pattern_.add(own_row, pattern.column[e]);
    }
    if (side < 0) continue;
    const bool is_H = side >= pairs;
    auto& entries = (is_H ? of_H : gradients_)[at(is_H ? side - pairs : side)];
    entries.push_back({entry, pattern.column[e], is_H});
  }
  for (int pair = 0; pair < pairs; ++pair) {
    auto& gradient = gradients_[at(pair)];
    const auto& more = of_H[at(pair)];
    gradient.insert(gradient.end(), more.begin(), more.end());
    for (int which = 0; which < inequalities_; ++which) {
      for (const auto& side : gradient) jacobian_pattern_.add(pair_row(pair, which), side.column);
    }
  }
}

void RelaxedProblem::find_hessian_pattern() {
  hessian_pattern_ = problem_.hessian_pattern();
  const bool mixed_only = is_bilinear(relaxation_);
  products_.resize(gradients_.size());
  for (std::size_t pair = 0; pair < gradients_.size(); ++pair) {
    const auto& gradient = gradients_[pair];
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const auto& p = gradient[i];
        const auto& q = gradient[j];
        const int sides = static_cast<int>(p.is_H) + static_cast<int>(q.is_H);
        if (mixed_only && sides != 1) continue;
        hessian_pattern_.add(std::max(p.column, q.column), std::min(p.column, q.column));
        products_[pair].push_back({p.entry, q.entry, sides, i != j && p.column == q.column ? 2.0 : 1.0});
      }
    }
  }
}

PairFunction RelaxedProblem::pair_at(int pair, int which) const {
  const int G = problem_.constraints() + pair;
  return pair_function(relaxation_, which, c_[G], c_[G + problem_.pairs()], sigma_);
}

void RelaxedProblem::functions(ConstVectorView w, VectorView c) {
  problem_.functions(w, c_);
  const int n_g = problem_.constraints();
  c.head(n_g) = c_.head(n_g);
  for (std::size_t side = 0; side < sign_row_.size(); ++side) {
    if (sign_row_[side] >= 0) c[sign_row_[side]] = c_[n_g + static_cast<int>(side)];
  }
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    for (int which = 0; which < inequalities_; ++which) c[pair_row(pair, which)] = pair_at(pair, which).value;
  }
}

void RelaxedProblem::jacobian(ConstVectorView w, VectorView values) {
  problem_.functions(w, c_);
  problem_.jacobian(w, jacobian_);
  Eigen::Index next = 0;
  for (const int entry : copied_entries_) values[next++] = jacobian_[entry];
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    for (int which = 0; which < inequalities_; ++which) {
      const PairFunction phi = pair_at(pair, which);
      for (const auto& side : gradients_[at(pair)]) {
        values[next++] = (side.is_H ? phi.b : phi.a) * jacobian_[side.entry];
      }
    }
  }
}

void RelaxedProblem::hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) {
  problem_.functions(w, c_);
  problem_.jacobian(w, jacobian_);
  const int n_g = problem_.constraints();
  const int pairs = problem_.pairs();
  y_.head(n_g) = y.head(n_g);
  for (std::size_t side = 0; side < sign_row_.size(); ++side) {
    y_[n_g + static_cast<int>(side)] = sign_row_[side] >= 0 ? y[sign_row_[side]] : 0.0;
  }
  Eigen::Index next = problem_.hessian_pattern().entries();
  for (int pair = 0; pair < pairs; ++pair) {
    std::array<double, 3> second{};
    for (int which = 0; which < inequalities_; ++which) {
      const PairFunction phi = pair_at(pair, which);
      const double multiplier = y[pair_row(pair, which)];
      y_[n_g + pair] += multiplier * phi.a;
      y_[n_g + pairs + pair] += multiplier * phi.b;
      second[0] += multiplier * phi.aa;
      second[1] += multiplier * phi.ab;
      second[2] += multiplier * phi.bb;
    }
    for (const auto& product : products_[at(pair)]) {
      values[next++] = product.factor * second[at(product.sides)] * jacobian_[product.p] * jacobian_[product.q];
    }
  }
  problem_.hessian(w, objective_factor, y_, values.head(problem_.hessian_pattern().entries()));
}

}  // namespace saltus::solver::homotopy
