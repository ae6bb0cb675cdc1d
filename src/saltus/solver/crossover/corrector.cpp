#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/linalg/block_order.hpp"
#include "saltus/mpcc/elimination.hpp"
#include "saltus/solver/crossover/corrector_internal.hpp"

namespace saltus::solver::crossover {
namespace {

/// Weight of the regularisation: small beside anything that matters, large beside rounding of entries of order 1.
constexpr double regularisation = 1e-9;
constexpr int refinements = 5;
/// Of the right-hand side may be left by old factors.
constexpr double enough = 1e-6;

/// The block of each row of the system in which it is eliminated; by minimum degree where the problem has no order.
std::vector<int> blocks_of(const mpcc::Problem& nlp, const ActiveSet& active, const Symmetric& system) {
  const auto of_variables = nlp.elimination_blocks();
  if (of_variables.empty()) {
    return linalg::blocks_by_minimum_degree(system.size, active.rows, system.rows, system.columns);
  }
  const auto of_rows = mpcc::blocks_of_rows(of_variables, nlp.jacobian_pattern(), nlp.constraints());
  std::vector<int> blocks(at(system.size));
  for (std::size_t i = 0; i < of_variables.size(); ++i) {
    if (active.column[i] >= 0) blocks[at(active.column[i])] = of_variables[i];
  }
  for (std::size_t i = 0; i < of_rows.size(); ++i) {
    if (active.line[i] >= 0) blocks[at(active.variables + active.line[i])] = of_rows[i];
  }
  return linalg::divide_blocks(active.rows, system.rows, system.columns, blocks);
}

}  // namespace

void Symmetric::add(int row, int column, double value) {
  rows.push_back(std::max(row, column));
  columns.push_back(std::min(row, column));
  values.push_back(value);
}

linalg::Vector Symmetric::times(const linalg::Vector& x) const {
  linalg::Vector product = linalg::Vector::zero(size);
  for (std::size_t e = 0; e < rows.size(); ++e) {
    product[rows[e]] += values[e] * x[columns[e]];
    if (rows[e] != columns[e]) product[columns[e]] += values[e] * x[rows[e]];
  }
  return product;
}

linalg::Vector Corrector::solve(const Symmetric& system, const linalg::Vector& right) {
  if (has_factors_) {
    auto [solution, left] = corrected(system, right);
    if (left <= enough * right.norm()) return solution;
  }
  factorise(system);
  return corrected(system, right).first;
}

void Corrector::factorise(Symmetric system) {
  for (int i = 0; i < system.size; ++i) system.add(i, i, i < active_.variables ? regularisation : -regularisation);
  if (!has_factors_) {
    factors_.analyse(system.size, system.rows, system.columns, blocks_of(nlp_, active_, system));
  }
  factors_.factorise(system.values);
  has_factors_ = true;
}

std::pair<linalg::Vector, double> Corrector::corrected(const Symmetric& system, const linalg::Vector& right) {
  linalg::Vector solution = linalg::Vector::zero(right.size());
  linalg::Vector rest = right;
  double left = right.norm();
  for (int i = 0; i < refinements; ++i) {
    linalg::Vector next = rest;
    factors_.solve({next.data(), at(next.size())});
    next += solution;
    const linalg::Vector next_rest = right - system.times(next);
    const double next_left = next_rest.norm();
    if (!(next_left <= left)) break;
    solution = next;
    rest = next_rest;
    left = next_left;
  }
  return {solution, left};
}

}  // namespace saltus::solver::crossover
