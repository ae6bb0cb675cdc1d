#include "saltus/solver/crossover/branch_problem.hpp"

#include <algorithm>
#include <utility>

#include "saltus/base/at.hpp"

namespace saltus::solver::crossover {

using mpcc::ConstVectorView;
using mpcc::VectorView;

BranchProblem::BranchProblem(mpcc::Problem& problem, Reduction reduction)
    : problem_(problem), reduction_(std::move(reduction)), cache_(problem) {
  find_patterns();
}

void BranchProblem::find_patterns() {
  jacobian_entries_.clear();
  hessian_entries_.clear();
  jacobian_pattern_ = {};
  hessian_pattern_ = {};
  std::vector<int> own_row(at(problem_.rows()), -1);
  for (std::size_t row = 0; row < reduction_.rows.size(); ++row)
    own_row[at(reduction_.rows[row])] = static_cast<int>(row);
  const auto& jacobian = problem_.jacobian_pattern();
  for (int entry = 0; entry < jacobian.entries(); ++entry) {
    const int row = own_row[at(jacobian.row[at(entry)])];
    const int column = reduction_.place[at(jacobian.column[at(entry)])];
    if (row < 0 || column < 0) continue;
    jacobian_entries_.push_back(entry);
    jacobian_pattern_.add(row, column);
  }
  const auto& hessian = problem_.hessian_pattern();
  for (int entry = 0; entry < hessian.entries(); ++entry) {
    const int i = hessian.row[at(entry)];
    const int j = hessian.column[at(entry)];
    const int row = reduction_.place[at(i)];
    const int column = reduction_.place[at(j)];
    if (row < 0 || column < 0) continue;
    hessian_entries_.push_back({entry, i != j && row == column ? 2.0 : 1.0});
    hessian_pattern_.add(std::max(row, column), std::min(row, column));
  }
}

void BranchProblem::keep_above(const std::vector<int>& variables, ConstVectorView w) {
  constexpr double part = 0.1;
  auto& [lower, upper] = reduction_.bounds;
  for (const int variable : variables) {
    const int place = reduction_.place[at(variable)];
    if (place >= 0) lower[place] = std::clamp(part * w[variable], lower[place], upper[place]);
  }
}

void BranchProblem::drop_rows(const std::vector<int>& rows) {
  std::vector<bool> is_dropped(reduction_.rows.size(), false);
  for (const int row : rows) is_dropped[at(row)] = true;
  linalg::Index next = 0;
  auto& [lower, upper] = reduction_.row_bounds;
  for (std::size_t row = 0; row < is_dropped.size(); ++row) {
    if (is_dropped[row]) {
      left_out_.push_back(reduction_.rows[row]);
      continue;
    }
    reduction_.rows[at(next)] = reduction_.rows[row];
    lower[next] = lower[index(row)];
    upper[next] = upper[index(row)];
    ++next;
  }
  reduction_.rows.resize(at(next));
  lower.resize_and_keep(next);
  upper.resize_and_keep(next);
  find_patterns();
}

linalg::Vector BranchProblem::full(ConstVectorView v) const {
  linalg::Vector w = reduction_.value;
  for (linalg::Index i = 0; i < w.size(); ++i) {
    if (reduction_.place[at(i)] >= 0) w[i] = v[reduction_.place[at(i)]];
  }
  return w;
}

linalg::Vector BranchProblem::reduced(ConstVectorView w) const {
  linalg::Vector v(variables());
  for (linalg::Index i = 0; i < v.size(); ++i) v[i] = w[reduction_.leader[at(i)]];
  return v.at_least(reduction_.bounds.lower).at_most(reduction_.bounds.upper);
}

std::vector<int> BranchProblem::elimination_blocks() const {
  const auto of_problem = problem_.elimination_blocks();
  std::vector<int> blocks(of_problem.empty() ? 0 : at(variables()), 0);
  for (std::size_t i = 0; i < of_problem.size(); ++i) {
    if (reduction_.place[i] < 0) continue;
    int& block = blocks[at(reduction_.place[i])];
    block = std::max(block, of_problem[i]);
  }
  return blocks;
}

void BranchProblem::objective_gradient(ConstVectorView v, VectorView gradient) {
  linalg::Vector whole(problem_.variables());
  problem_.objective_gradient(full(v), whole);
  gradient.set_zero();
  for (linalg::Index i = 0; i < whole.size(); ++i) {
    if (reduction_.place[at(i)] >= 0) gradient[reduction_.place[at(i)]] += whole[i];
  }
}

void BranchProblem::functions(ConstVectorView v, VectorView c) {
  const linalg::Vector& values = cache_.functions(full(v));
  for (linalg::Index row = 0; row < c.size(); ++row) c[row] = values[reduction_.rows[at(row)]];
}

void BranchProblem::jacobian(ConstVectorView v, VectorView values) {
  const linalg::Vector& entries = cache_.jacobian(full(v));
  for (linalg::Index e = 0; e < values.size(); ++e) values[e] = entries[jacobian_entries_[at(e)]];
}

void BranchProblem::hessian(ConstVectorView v, double objective_factor, ConstVectorView y, VectorView values) {
  linalg::Vector of_rows = linalg::Vector::zero(problem_.rows());
  for (linalg::Index row = 0; row < y.size(); ++row) of_rows[reduction_.rows[at(row)]] = y[row];
  linalg::Vector entries(problem_.hessian_pattern().entries());
  problem_.hessian(full(v), objective_factor, of_rows, entries);
  for (linalg::Index e = 0; e < values.size(); ++e) {
    values[e] = hessian_entries_[at(e)].factor * entries[hessian_entries_[at(e)].entry];
  }
}

}  // namespace saltus::solver::crossover
