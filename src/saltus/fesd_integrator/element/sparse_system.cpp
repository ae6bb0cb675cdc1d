#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/sparse_system_internal.hpp"

namespace saltus::fesd_integrator {

using linalg::Index;

void SparseSystem::reset(Index n) {
  if (n != right_.size()) {
    places_.clear();
    analysed_ = false;
    dense_ = {};
  }
  next_ = 0;
  factorised_ = false;
  right_.set_zero(n);
}

void SparseSystem::add(Index row, Index column, double value) {
  const Place place(row, column);
  if (next_ == places_.size() || places_[next_] != place) {
    places_.resize(next_);
    places_.push_back(place);
    analysed_ = false;
  }
  given_.resize(std::max(given_.size(), places_.size()));
  given_[next_++] = value;
}

/// The matrix of all places, and the order of its elimination.
void SparseSystem::analyse() {
  places_.resize(next_);
  std::vector<linalg::Triplet> triplets;
  for (const auto& [row, column] : places_) triplets.push_back({row, column, 0.0});
  matrix_ = linalg::SparseColumns(right_.size(), right_.size(), triplets);
  slot_.clear();
  for (const auto& [row, column] : places_) {
    const auto rows = matrix_.inner().begin();
    const auto first = rows + matrix_.start()[at(column)], last = rows + matrix_.start()[at(column) + 1];
    slot_.push_back(at(std::lower_bound(first, last, static_cast<int>(row)) - rows));
  }
  is_diagonal_ = matrix_.entries() == matrix_.cols() &&
                 std::all_of(places_.begin(), places_.end(), [](const auto& at) { return at.first == at.second; });
  if (!is_diagonal_) factors_.analyse(matrix_);
  analysed_ = true;
}

/// False if something is not finite.
bool SparseSystem::take_entries() {
  const auto values = matrix_.values();
  std::ranges::fill(values, 0.0);
  for (std::size_t k = 0; k < next_; ++k) values[slot_[k]] += given_[k];
  column_sizes_.set_zero(right_.size());
  bool finite = right_.all_finite();
  for (Index column = 0; column < matrix_.cols(); ++column) {
    for (const auto entry : matrix_.along(column)) {
      finite = finite && std::isfinite(entry.value);
      column_sizes_(column) = std::max(column_sizes_(column), std::abs(entry.value));
    }
  }
  return finite;
}

/// False where the matrix is singular.
bool SparseSystem::factorise() {
  if (is_diagonal_) return column_sizes_.min() > 0.0;
  constexpr double singular = 1e-13;  // the rounding level of a column, as in DenseSystem
  return factors_.factorise(matrix_) &&
         !factors_.has_small_pivot({column_sizes_.begin(), column_sizes_.end()}, singular);
}

bool SparseSystem::solve(double negligible, DenseSystem::Unit unit) {
  if (right_.size() == 0) return true;
  if (!analysed_ || next_ != places_.size()) analyse();
  if (!take_entries()) return false;
  factorised_ = factorise();
  return factorised_ ? solve_again() : solve_dense(negligible, unit);
}

bool SparseSystem::solve_dense(double negligible, DenseSystem::Unit unit) {
  dense_.reserve(right_.size());
  dense_.reset(right_.size());
  auto matrix = dense_.matrix();
  for (Index column = 0; column < matrix_.cols(); ++column) {
    for (const auto [row, value] : matrix_.along(column)) matrix(row, column) = value;
  }
  dense_.right() = right_;
  const bool solved = dense_.solve(negligible, unit);
  right_ = dense_.right();
  return solved;
}

bool SparseSystem::solve_again() {
  if (factorised_) {
    if (is_diagonal_) {
      const auto diagonal = matrix_.values();
      for (Index i = 0; i < right_.size(); ++i) right_[i] /= diagonal[at(i)];
    } else {
      solution_.resize(right_.size());
      factors_.SparseLuOf::solve({right_.begin(), right_.end()}, {solution_.begin(), solution_.end()});
      right_ = solution_;
    }
    return right_.all_finite();
  }
  dense_.right() = right_;
  const bool solved = dense_.solve_again();
  right_ = dense_.right();
  return solved;
}

linalg::Matrix SparseSystem::null_space() const {
  return factorised_ || right_.size() == 0 ? linalg::Matrix(right_.size(), 0) : dense_.null_space();
}

}  // namespace saltus::fesd_integrator
