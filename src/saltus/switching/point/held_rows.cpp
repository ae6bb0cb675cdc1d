#include "saltus/switching/point/held_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::switching {

void HeldRows::clear() {
  given_.set_zero();
  held_.clear();
  shares_.clear();
}

int HeldRows::hold(int row) {
  held_.push_back(row);
  return static_cast<int>(held_.size()) - 1;
}

void HeldRows::share(int row, int unknown, double part) {
  if (unknown < 0) {
    given_(row) = part;
  } else {
    shares_.push_back({row, unknown, part});
  }
}

template <class Unknowns, class Forces>
void HeldRows::add(const Unknowns& unknowns, Forces& forces) const {
  for (std::size_t k = 0; k < held_.size(); ++k) forces.row(held_[k]) += unknowns.row(index(k));
  for (const auto& share : shares_) forces.row(share.row) += share.part * unknowns.row(share.unknown);
}

auto HeldRows::solve(const linalg::Matrix& effects, const linalg::Vector& constant, linalg::Vector& z) -> Solution {
  z = given_;
  if (held_.empty()) return Solution::one;
  const auto n = index(held_.size());
  right_.resize(n);
  for (linalg::Index k = 0; k < n; ++k) {
    const int row = held_[at(k)];
    right_(k) = -(constant(row) + effects.row(row).dot(given_));
  }
  if (const auto solution = eliminate(effects)) {
    if (*solution != Solution::none) add(unknowns_, z);
    return *solution;
  }
  const linalg::Matrix rows = rows_of(effects);
  linalg::OrthogonalFactors factors;
  factors.set_threshold(dependent);
  factors.compute(rows);
  unknowns_ = factors.solve(right_);
  const double size = rows.max_abs() * unknowns_.max_abs() + right_.max_abs();
  if (!((rows * unknowns_ - right_).max_abs() <= contradiction * size)) return Solution::none;
  add(unknowns_, z);
  return factors.rank() < n ? Solution::open : Solution::one;
}

/// By complete pivoting, in the memory that is there; nothing where the rank is not clear.
auto HeldRows::eliminate(const linalg::Matrix& effects) -> std::optional<Solution> {
  const std::size_t n = held_.size(), width = n + 1;
  table_.resize(n * width);
  order_.resize(n);
  const auto row_of = [&](std::size_t i) { return table_.data() + i * width; };
  for (std::size_t i = 0; i < n; ++i) {
    double* row = row_of(i);
    for (std::size_t k = 0; k < n; ++k) row[k] = effects(held_[i], held_[k]);
    for (const auto& share : shares_) row[at(share.unknown)] += share.part * effects(held_[i], share.row);
    row[n] = right_(index(i));
    order_[i] = static_cast<int>(i);
  }
  constexpr double clear = 1e-7, none = 1e-12;
  double largest = 0.0;
  std::size_t rank = 0;
  for (; rank < n; ++rank) {
    std::size_t row = rank, column = rank;
    double pivot = std::abs(row_of(rank)[rank]);
    for (std::size_t i = rank; i < n; ++i) {
      for (std::size_t k = rank; k < n; ++k) {
        if (std::abs(row_of(i)[k]) > pivot) pivot = std::abs(row_of(row = i)[column = k]);
      }
    }
    largest = std::max(largest, pivot);
    if (pivot <= none * largest) break;
    if (!(pivot > clear * largest)) return std::nullopt;
    if (row != rank) std::swap_ranges(row_of(row), row_of(row) + width, row_of(rank));
    for (std::size_t i = 0; i < n && column != rank; ++i) std::swap(row_of(i)[column], row_of(i)[rank]);
    std::swap(order_[column], order_[rank]);
    const double* from = row_of(rank);
    for (std::size_t i = rank + 1; i < n; ++i) {
      double* to = row_of(i);
      const double factor = to[rank] / from[rank];
      to[rank] = 0.0;
      for (std::size_t k = rank + 1; k < width; ++k) to[k] -= factor * from[k];
    }
  }
  if (rank < n) return solve_least(rank, largest);
  substitute_back();
  return Solution::one;
}

/// The solution of regular rows behind an elimination.
void HeldRows::substitute_back() {
  const std::size_t n = held_.size(), width = n + 1;
  unknowns_.resize(index(n));
  for (std::size_t i = n; i-- > 0;) {
    const double* row = table_.data() + i * width;
    double sum = row[n];
    for (std::size_t k = i + 1; k < n; ++k) sum -= row[k] * unknowns_(order_[k]);
    unknowns_(order_[i]) = sum / row[i];
  }
}

/// The least solution of the rows behind an elimination, made orthogonal one after the other.
auto HeldRows::solve_least(std::size_t rank, double largest) -> Solution {
  const std::size_t n = held_.size(), width = n + 1;
  unknowns_.set_zero(index(n));
  for (std::size_t i = 0; i < rank; ++i) {
    double* row = table_.data() + i * width;
    for (std::size_t j = 0; j < i; ++j) {
      const double* other = table_.data() + j * width;
      const double part = std::inner_product(other, other + n, row, 0.0);
      for (std::size_t k = 0; k < width; ++k) row[k] -= part * other[k];
    }
    const double size = std::sqrt(std::inner_product(row, row + n, row, 0.0));
    for (std::size_t k = 0; k < width; ++k) row[k] /= size;
    for (std::size_t k = 0; k < n; ++k) unknowns_(order_[k]) += row[n] * row[k];
  }
  const double size = largest * unknowns_.max_abs() + right_.max_abs();
  for (std::size_t i = rank; i < n; ++i) {
    if (!(std::abs(table_[i * width + n]) <= contradiction * size)) return Solution::none;
  }
  return Solution::open;
}

linalg::Matrix HeldRows::rows_of(const linalg::Matrix& effects) const {
  linalg::Matrix rows = effects.selected(held_, held_);
  for (const auto& share : shares_) rows.col(share.unknown) += share.part * effects.col(share.row).selected_rows(held_);
  return rows;
}

linalg::Matrix HeldRows::open(const linalg::Matrix& effects) const {
  const auto n = index(held_.size());
  linalg::FullLu factors;
  factors.set_threshold(dependent);
  if (n > 0) factors.compute(rows_of(effects));
  if (n == 0 || factors.rank() == n) return linalg::Matrix(given_.size(), 0);
  const linalg::Matrix kernel = factors.kernel();
  linalg::Matrix forces = linalg::Matrix::zero(given_.size(), kernel.cols());
  add(kernel, forces);
  return forces;
}

}  // namespace saltus::switching
