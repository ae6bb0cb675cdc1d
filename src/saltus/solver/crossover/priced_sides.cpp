#include "saltus/solver/crossover/priced_sides.hpp"

#include <limits>

#include "saltus/base/at.hpp"

namespace saltus::solver::crossover {

using mpcc::ConstVectorView;
using mpcc::VectorView;

PricedSides::PricedSides(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& zero, double price)
    : problem_(problem), cache_(problem), variable_bounds_(problem.variable_bounds()) {
  const auto closure = problem.close_branch(zero);
  for (const int i : closure.at_lower) variable_bounds_.upper[i] = variable_bounds_.lower[i];
  for (const int i : closure.at_upper) variable_bounds_.lower[i] = variable_bounds_.upper[i];
  equal_ = closure.equal;
  const int n_g = problem.constraints(), sides = 2 * problem.pairs();
  std::vector<bool> is_dropped(at(n_g), false);
  for (const int row : closure.dropped_rows) is_dropped[at(row)] = true;
  for (int row = 0; row < n_g; ++row) {
    if (!is_dropped[at(row)]) rows_.push_back(row);
  }
  const auto of_g = index(rows_.size());
  for (int side = 0; side < sides; ++side) {
    const bool is_of_method = problem.pair_group(side % problem.pairs()) < 0;
    if (!is_of_method && problem.signs()[at(side)] == mpcc::Sign::constrained) rows_.push_back(n_g + side);
  }
  bounds_.lower = linalg::Vector::zero(constraints());
  bounds_.upper = linalg::Vector::constant(constraints(), std::numeric_limits<double>::infinity());
  for (linalg::Index row = 0; row < of_g; ++row) {
    bounds_.lower[row] = problem.constraint_bounds().lower[rows_[at(row)]];
    bounds_.upper[row] = problem.constraint_bounds().upper[rows_[at(row)]];
  }
  bounds_.upper.tail(index(equal_.size())).set_zero();
  std::vector<int> own(at(problem.rows()), -1);
  for (std::size_t row = 0; row < rows_.size(); ++row) own[at(rows_[row])] = static_cast<int>(row);
  const auto& pattern = problem.jacobian_pattern();
  for (int entry = 0; entry < pattern.entries(); ++entry) {
    const int row = own[at(pattern.row[at(entry)])];
    if (row < 0) continue;
    entries_.push_back(entry);
    jacobian_pattern_.add(row, pattern.column[at(entry)]);
  }
  for (std::size_t i = 0; i < equal_.size(); ++i) {
    jacobian_pattern_.add(static_cast<int>(rows_.size() + i), equal_[i].first);
    jacobian_pattern_.add(static_cast<int>(rows_.size() + i), equal_[i].second);
  }
  price_ = linalg::Vector::zero(problem.rows());
  for (int pair = 0; pair < problem.pairs(); ++pair) {
    if (problem.pair_group(pair) < 0) continue;
    const bool is_G = zero[at(pair)] == mpcc::ActiveSide::G;
    price_[n_g + pair + (is_G ? 0 : problem.pairs())] = price;
  }
}

double PricedSides::objective(ConstVectorView w) { return problem_.objective(w) + price_.dot(cache_.functions(w)); }

void PricedSides::objective_gradient(ConstVectorView w, VectorView gradient) {
  problem_.objective_gradient(w, gradient);
  const auto& pattern = problem_.jacobian_pattern();
  const linalg::Vector& values = cache_.jacobian(w);
  for (int entry = 0; entry < pattern.entries(); ++entry) {
    gradient[pattern.column[at(entry)]] += price_[pattern.row[at(entry)]] * values[entry];
  }
}

void PricedSides::functions(ConstVectorView w, VectorView c) {
  const linalg::Vector& values = cache_.functions(w);
  for (std::size_t row = 0; row < rows_.size(); ++row) c[index(row)] = values[rows_[row]];
  for (std::size_t i = 0; i < equal_.size(); ++i) {
    c[index(rows_.size() + i)] = w[equal_[i].first] - w[equal_[i].second];
  }
}

void PricedSides::jacobian(ConstVectorView w, VectorView values) {
  const linalg::Vector& all = cache_.jacobian(w);
  for (std::size_t e = 0; e < entries_.size(); ++e) values[index(e)] = all[entries_[e]];
  for (std::size_t e = entries_.size(); e < at(values.size()); e += 2) {
    values[index(e)] = 1.0;
    values[index(e) + 1] = -1.0;
  }
}

void PricedSides::hessian(ConstVectorView w, double objective_factor, ConstVectorView y, VectorView values) {
  linalg::Vector of_rows = objective_factor * price_;
  for (std::size_t row = 0; row < rows_.size(); ++row) of_rows[rows_[row]] += y[index(row)];
  problem_.hessian(w, objective_factor, of_rows, values);
}

}  // namespace saltus::solver::crossover
