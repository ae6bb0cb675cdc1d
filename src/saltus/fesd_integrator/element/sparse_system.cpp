#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/sparse_system_internal.hpp"

namespace saltus::fesd_integrator {

using Eigen::Index;

bool SparseSystem::Factors::is_singular(const Eigen::VectorXd& column_sizes) const {
  constexpr double singular = 1e-13;  // as in DenseSystem
  for (Index column = 0; column < cols(); ++column) {
    const double size = column_sizes(column);
    const Index j = m_perm_c.indices()(column);
    for (SCMatrix::InnerIterator entry(m_Lstore, j); entry; ++entry) {
      if (entry.index() != j) continue;
      if (!(std::abs(entry.value()) > singular * size)) return true;
      break;
    }
  }
  return false;
}

void SparseSystem::reset(Index n) {
  if (n != right_.size()) {
    places_.clear();
    analysed_ = false;
    dense_ = {};
  }
  next_ = 0;
  factorised_ = false;
  right_.setZero(n);
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
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [row, column] : places_) {
    triplets.emplace_back(static_cast<int>(row), static_cast<int>(column), 0.0);
  }
  matrix_.resize(right_.size(), right_.size());
  matrix_.setFromTriplets(triplets.begin(), triplets.end());
  slot_.clear();
  for (const auto& [row, column] : places_) {
    const int* const rows = matrix_.innerIndexPtr();
    const int* const first = rows + matrix_.outerIndexPtr()[column];
    const int* const last = rows + matrix_.outerIndexPtr()[column + 1];
    slot_.push_back(std::lower_bound(first, last, static_cast<int>(row)) - rows);
  }
  is_diagonal_ = matrix_.nonZeros() == matrix_.cols() &&
                 std::all_of(places_.begin(), places_.end(), [](const auto& at) { return at.first == at.second; });
  if (!is_diagonal_) factors_.analyzePattern(matrix_);
  analysed_ = true;
}

/// False if something is not finite.
bool SparseSystem::take_entries() {
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  for (std::size_t k = 0; k < next_; ++k) matrix_.valuePtr()[slot_[k]] += given_[k];
  column_sizes_.setZero(right_.size());
  bool finite = right_.allFinite();
  for (Index column = 0; column < matrix_.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix_, column); entry; ++entry) {
      finite = finite && std::isfinite(entry.value());
      column_sizes_(column) = std::max(column_sizes_(column), std::abs(entry.value()));
    }
  }
  return finite;
}

/// False where the matrix is singular.
bool SparseSystem::factorise() {
  if (is_diagonal_) return column_sizes_.minCoeff() > 0.0;
  factors_.factorize(matrix_);
  return factors_.info() == Eigen::Success && !factors_.is_singular(column_sizes_);
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
  dense_.matrix() = matrix_;
  dense_.right() = right_;
  const bool solved = dense_.solve(negligible, unit);
  right_ = dense_.right();
  return solved;
}

bool SparseSystem::solve_again() {
  if (factorised_) {
    if (is_diagonal_) {
      right_.array() /= Eigen::Map<const Eigen::ArrayXd>(matrix_.valuePtr(), matrix_.cols());
    } else {
      right_ = factors_.solve(right_).eval();
    }
    return right_.allFinite();
  }
  dense_.right() = right_;
  const bool solved = dense_.solve_again();
  right_ = dense_.right();
  return solved;
}

Eigen::MatrixXd SparseSystem::null_space() const {
  return factorised_ || right_.size() == 0 ? Eigen::MatrixXd(right_.size(), 0) : dense_.null_space();
}

}  // namespace saltus::fesd_integrator
