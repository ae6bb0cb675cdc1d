#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/ode/sparse/radau_systems_internal.hpp"

namespace saltus::ode {

template <std::size_t pairs>
bool RadauSystems<pairs>::use(const JacobianPattern* pattern) {
  if (started_ && pattern == pattern_) return false;
  started_ = true;
  pattern_ = pattern;
  groups_.clear();
  if (pattern == nullptr) {
    jacobian_.resize(n_, n_);
    return true;
  }
  groups_ = column_groups(*pattern);
  entries_.assign(pattern->row.size(), 0.0);
  elimination_ = elimination_of(*pattern);
  joint_.use(elimination_);
  sparse_real_.use(*pattern, elimination_);
  for (Pair& pair : pairs_) pair.sparse.use(*pattern, elimination_);
  return true;
}

template <std::size_t pairs>
bool RadauSystems<pairs>::all_finite() const {
  if (pattern_ == nullptr) return jacobian_.all_finite();
  return std::all_of(entries_.begin(), entries_.end(), [](double entry) { return std::isfinite(entry); });
}

template <std::size_t pairs>
bool RadauSystems<pairs>::set_column(linalg::Index column, const Vector& difference, double increment) {
  if (pattern_ == nullptr) {
    linalg::View entries = jacobian_.col(column);
    for (linalg::Index i = 0; i < n_; ++i) entries[i] = difference[i] / increment;
    return entries.all_finite();
  }
  const auto j = static_cast<std::size_t>(column);
  bool finite = true;
  for (std::size_t k = pattern_->start[j]; k < pattern_->start[j + 1]; ++k) {
    entries_[k] = difference[static_cast<linalg::Index>(pattern_->row[k])] / increment;
    finite = finite && std::isfinite(entries_[k]);
  }
  return finite;
}

template <std::size_t pairs>
void RadauSystems<pairs>::multiply(const Vector& x, Vector& product) const {
  product.set_zero();
  for (linalg::Index j = 0; j < n_; ++j) {
    if (pattern_ == nullptr) {
      product.add_scaled(x[j], jacobian_.col(j));
      continue;
    }
    const auto column = static_cast<std::size_t>(j);
    for (std::size_t k = pattern_->start[column]; k < pattern_->start[column + 1]; ++k) {
      product[static_cast<linalg::Index>(pattern_->row[k])] += entries_[k] * x[j];
    }
  }
}

template <std::size_t pairs>
bool RadauSystems<pairs>::factorize(const Shifts& shifts) {
  if (pattern_ != nullptr) {
    Joint shift;
    shift.real = shifts.real;
    for (std::size_t k = 0; k < pairs; ++k) {
      shift.re[k] = shifts.complex[k].real();
      shift.im[k] = shifts.complex[k].imag();
    }
    along_diagonal_ = joint_.factorize(entries_, shift);
    if (along_diagonal_) return true;
    find_still_rows();
    if (!sparse_real_.factorize(entries_, shifts.real)) return false;
    for (std::size_t k = 0; k < pairs; ++k) {
      if (!pairs_[k].sparse.factorize(entries_, shifts.complex[k])) return false;
    }
    return true;
  }
  find_still_rows();
  real_matrix_ = jacobian_;
  real_matrix_ *= -1.0;
  real_matrix_.diagonal().add_to_all(shifts.real);
  real_.compute(real_matrix_);
  for (std::size_t k = 0; k < pairs; ++k) pairs_[k].dense.compute_shifted(jacobian_, shifts.complex[k]);
  return true;
}

/// Discrete states do not move, not by roundings either: pivots would give them some of those of other rows.
template <std::size_t pairs>
void RadauSystems<pairs>::find_still_rows() {
  still_.assign(static_cast<std::size_t>(n_), true);
  for (std::size_t k = 0; pattern_ != nullptr && k < entries_.size(); ++k) {
    if (entries_[k] != 0.0) still_[pattern_->row[k]] = false;
  }
  for (linalg::Index i = 0; pattern_ == nullptr && i < n_; ++i) still_[at(i)] = jacobian_.row(i).is_zero();
}

template <std::size_t pairs>
void RadauSystems<pairs>::solve(linalg::ConstView right, linalg::View solution) {
  if (pattern_ == nullptr) {
    solution = right;
    real_.solve_in_place(solution);
  } else if (along_diagonal_) {
    joint_.solve_real([&](std::size_t i) { return right[index(i)]; },
                      [&](std::size_t i, double value) { solution[index(i)] = value; });
  } else {
    const std::size_t n = at(n_);
    sparse_real_.solve({right.data(), n}, {solution.data(), n});
  }
}

template <std::size_t pairs>
void RadauSystems<pairs>::solve_joint(const Matrix& right, Matrix& solution) {
  const auto read = [&](std::size_t i) {
    Joint number;
    const auto row = index(i);
    number.real = right(row, 0);
    for (std::size_t k = 0; k < pairs; ++k) {
      number.re[k] = right(row, index(2 * k + 1));
      number.im[k] = right(row, index(2 * k + 2));
    }
    return number;
  };
  joint_.solve(read, [&](std::size_t i, const Joint& number) {
    const auto row = index(i);
    solution(row, 0) = number.real;
    for (std::size_t k = 0; k < pairs; ++k) {
      solution(row, index(2 * k + 1)) = number.re[k];
      solution(row, index(2 * k + 2)) = number.im[k];
    }
  });
}

template <std::size_t pairs>
void RadauSystems<pairs>::solve_all(const Matrix& right, Matrix& solution) {
  if (pattern_ != nullptr && along_diagonal_) return solve_joint(right, solution);
  solve(right.col(0), solution.col(0));
  complex_part_.resize(at(n_));
  complex_solution_.resize(at(n_));
  for (std::size_t k = 0; k < pairs; ++k) {
    const linalg::Index real = index(2 * k + 1), imaginary = real + 1;
    if (pattern_ == nullptr) {
      pairs_[k].dense.solve(right.col(real), right.col(imaginary), solution.col(real), solution.col(imaginary));
      continue;
    }
    for (linalg::Index i = 0; i < n_; ++i) complex_part_[at(i)] = {right(i, real), right(i, imaginary)};
    pairs_[k].sparse.solve(complex_part_, complex_solution_);
    for (linalg::Index i = 0; i < n_; ++i) {
      solution(i, real) = complex_solution_[at(i)].real();
      solution(i, imaginary) = complex_solution_[at(i)].imag();
    }
  }
  for (linalg::Index i = 0; i < n_; ++i) {
    if (still_[at(i)] && right.row(i).is_zero()) solution.row(i).set_zero();
  }
}

template class RadauSystems<1>;
template class RadauSystems<2>;
template class RadauSystems<3>;

}  // namespace saltus::ode
