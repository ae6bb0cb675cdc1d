#include "saltus/solver/homotopy/relaxed_problem.hpp"

#include <algorithm>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/mpcc/elimination.hpp"

namespace saltus::solver::homotopy {

using mpcc::ConstVectorView;
using mpcc::Sign;
using mpcc::VectorView;

namespace {

/// Parameters above relax nothing any more that is of the size of a scaled problem; mpcc.md's choice, and nosnoc's.
constexpr double largest_elastic = 10.0;
/// phi is not smooth at s = 0, where interior points never are; guards against a start there.
constexpr double smallest_elastic = 1e-16;

int elastic_variables(Steering steering, int pairs) {
  if (steering == Steering::direct || pairs == 0) return 0;
  return steering == Steering::l1 ? pairs : 1;
}

}  // namespace

RelaxedProblem::RelaxedProblem(mpcc::Problem& problem, Relaxation relaxation, Steering steering)
    : problem_(problem),
      cache_(problem),
      relaxation_(relaxation),
      inequalities_(inequalities(relaxation)),
      elastic_(elastic_variables(steering, problem.pairs())),
      y_(problem.rows()) {
  const int n = problem.variables();
  variable_bounds_.lower = linalg::Vector::zero(n + elastic_);
  variable_bounds_.upper = linalg::Vector::constant(n + elastic_, largest_elastic);
  variable_bounds_.lower.head(n) = problem.variable_bounds().lower;
  variable_bounds_.upper.head(n) = problem.variable_bounds().upper;
  find_rows();
  find_jacobian_pattern();
  find_hessian_pattern();
  if (elastic_ > 0) find_elastic_hessian_pattern();
  set_sigma(1.0);
}

void RelaxedProblem::find_rows() {
  const int n_g = problem_.constraints();
  int row = n_g;
  for (const Sign sign : problem_.signs()) sign_row_.push_back(sign == Sign::constrained ? row++ : -1);
  first_pair_row_ = row;
  row += problem_.pairs() * inequalities_;
  const double infinity = std::numeric_limits<double>::infinity();
  bounds_.lower = linalg::Vector::constant(row, -infinity);
  bounds_.upper = linalg::Vector::constant(row, infinity);
  bounds_.lower.head(n_g) = problem_.constraint_bounds().lower;
  bounds_.upper.head(n_g) = problem_.constraint_bounds().upper;
  bounds_.upper.tail(row - first_pair_row_).set_zero();
}

void RelaxedProblem::set_sigma(double sigma) {
  SALTUS_ASSERT(sigma > 0.0);
  sigma_ = sigma;
  // Parameters of the problem may have changed since it was solved last.
  cache_.forget();
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
      if (elastic_ > 0) jacobian_pattern_.add(pair_row(pair, which), elastic_column(pair));
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

void RelaxedProblem::find_elastic_hessian_pattern() {
  first_elastic_entry_ = hessian_pattern_.entries();
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    for (const auto& side : gradients_[at(pair)]) hessian_pattern_.add(elastic_column(pair), side.column);
    hessian_pattern_.add(elastic_column(pair), elastic_column(pair));
  }
}

PairFunction RelaxedProblem::pair_at(int pair, int which, ConstVectorView w, ConstVectorView c) const {
  const int G = problem_.constraints() + pair;
  // In this order what is not a number is the smallest one: the values of the pair say that the point is none.
  const double sigma = elastic_ > 0 ? std::max(smallest_elastic, w[elastic_column(pair)]) : sigma_;
  return pair_function(relaxation_, which, c[G], c[G + problem_.pairs()], sigma);
}

linalg::Vector RelaxedProblem::with_elastic_variables(ConstVectorView w) {
  const int n = problem_.variables();
  linalg::Vector extended(n + elastic_);
  extended.head(n) = w.head(n);
  extended.tail(elastic_).set_constant(std::min(sigma_, largest_elastic));
  if (elastic_ == 0) return extended;
  const linalg::Vector& c = cache_.functions(w.head(n));
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    // The parameter is normalised such that a b <= s, whatever the relaxation.
    const int G = problem_.constraints() + pair;
    double& s = extended[elastic_column(pair)];
    s = std::clamp(c[G] * c[G + problem_.pairs()], s, largest_elastic);
  }
  return extended;
}

std::vector<int> RelaxedProblem::elimination_blocks() const {
  auto blocks = problem_.elimination_blocks();
  if (blocks.empty()) return blocks;
  blocks.resize(at(variables()), -1);
  mpcc::place_with_rows(blocks, jacobian_pattern_, constraints());
  return blocks;
}

double RelaxedProblem::objective(ConstVectorView w) {
  const double f = problem_.objective(w.head(problem_.variables()));
  return elastic_ > 0 ? f + w.tail(elastic_).sum() / sigma_ : f;
}

void RelaxedProblem::objective_gradient(ConstVectorView w, VectorView gradient) {
  const int n = problem_.variables();
  problem_.objective_gradient(w.head(n), gradient.head(n));
  gradient.tail(elastic_).set_constant(1.0 / sigma_);
}

void RelaxedProblem::functions(ConstVectorView w, VectorView c) {
  const linalg::Vector& values = cache_.functions(w.head(problem_.variables()));
  const int n_g = problem_.constraints();
  c.head(n_g) = values.head(n_g);
  for (std::size_t side = 0; side < sign_row_.size(); ++side) {
    if (sign_row_[side] >= 0) c[sign_row_[side]] = values[n_g + index(side)];
  }
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    for (int which = 0; which < inequalities_; ++which) {
      c[pair_row(pair, which)] = pair_at(pair, which, w, values).value;
    }
  }
}

void RelaxedProblem::jacobian(ConstVectorView w, VectorView values) {
  const linalg::Vector& c = cache_.functions(w.head(problem_.variables()));
  const linalg::Vector& entries = cache_.jacobian(w.head(problem_.variables()));
  linalg::Index next = 0;
  for (const int entry : copied_entries_) values[next++] = entries[entry];
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    for (int which = 0; which < inequalities_; ++which) {
      const PairFunction phi = pair_at(pair, which, w, c);
      for (const auto& side : gradients_[at(pair)]) {
        values[next++] = (side.is_H ? phi.b : phi.a) * entries[side.entry];
      }
      if (elastic_ > 0) values[next++] = phi.s;
    }
  }
}

linalg::Vector RelaxedProblem::multipliers_of_problem(ConstVectorView w, ConstVectorView y) {
  const linalg::Vector& c = cache_.functions(w.head(problem_.variables()));
  const int n_g = problem_.constraints();
  const int pairs = problem_.pairs();
  y_.head(n_g) = y.head(n_g);
  for (std::size_t side = 0; side < sign_row_.size(); ++side) {
    y_[n_g + index(side)] = sign_row_[side] >= 0 ? y[sign_row_[side]] : 0.0;
  }
  for (int pair = 0; pair < pairs; ++pair) {
    for (int which = 0; which < inequalities_; ++which) {
      const PairFunction phi = pair_at(pair, which, w, c);
      y_[n_g + pair] += y[pair_row(pair, which)] * phi.a;
      y_[n_g + pairs + pair] += y[pair_row(pair, which)] * phi.b;
    }
  }
  return y_;
}

void RelaxedProblem::add_elastic_hessian(int pair, const PairFunction& phi, ConstVectorView jacobian, VectorView values,
                                         linalg::Index& next) const {
  for (const auto& side : gradients_[at(pair)]) values[next++] = (side.is_H ? phi.bs : phi.as) * jacobian[side.entry];
  values[next++] = phi.ss;
}

void RelaxedProblem::hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) {
  const auto own = w.head(problem_.variables());
  const linalg::Vector& c = cache_.functions(own);
  const linalg::Vector& entries = cache_.jacobian(own);
  static_cast<void>(multipliers_of_problem(w, y));
  const int own_entries = problem_.hessian_pattern().entries();
  linalg::Index next = own_entries;
  linalg::Index elastic = first_elastic_entry_;
  for (int pair = 0; pair < problem_.pairs(); ++pair) {
    PairFunction second;  // sum over the inequalities of the pair, each times its multiplier
    for (int which = 0; which < inequalities_; ++which) {
      const PairFunction phi = pair_at(pair, which, w, c);
      const double multiplier = y[pair_row(pair, which)];
      second.aa += multiplier * phi.aa;
      second.ab += multiplier * phi.ab;
      second.bb += multiplier * phi.bb;
      second.as += multiplier * phi.as;
      second.bs += multiplier * phi.bs;
      second.ss += multiplier * phi.ss;
    }
    const std::array<double, 3> of_sides{second.aa, second.ab, second.bb};
    for (const auto& product : products_[at(pair)]) {
      values[next++] = product.factor * of_sides[at(product.sides)] * entries[product.p] * entries[product.q];
    }
    if (elastic_ > 0) add_elastic_hessian(pair, second, entries, values, elastic);
  }
  problem_.hessian(own, objective_factor, y_, values.head(own_entries));
}

}  // namespace saltus::solver::homotopy
