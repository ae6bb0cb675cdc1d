#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/ode/sparse/radau_systems_internal.hpp"

namespace saltus::ode {

bool RadauSystems::use(const JacobianPattern* pattern) {
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
  sparse_real_.use(*pattern, elimination_);
  for (Pair& pair : pairs_) pair.sparse.use(*pattern, elimination_);
  return true;
}

bool RadauSystems::set_column(Eigen::Index column, const Vector& difference, double increment) {
  if (pattern_ == nullptr) {
    jacobian_.col(column) = difference / increment;
    return jacobian_.col(column).allFinite();
  }
  const auto j = static_cast<std::size_t>(column);
  bool finite = true;
  for (std::size_t k = pattern_->start[j]; k < pattern_->start[j + 1]; ++k) {
    entries_[k] = difference[static_cast<Eigen::Index>(pattern_->row[k])] / increment;
    finite = finite && std::isfinite(entries_[k]);
  }
  return finite;
}

bool RadauSystems::factorize(const Shifts& shifts) {
  if (pattern_ != nullptr) {
    if (!sparse_real_.factorize(entries_, shifts.real)) return false;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      if (!pairs_[k].sparse.factorize(entries_, shifts.pairs[k])) return false;
    }
    return true;
  }
  real_matrix_ = -jacobian_;
  real_matrix_.diagonal().array() += shifts.real;
  real_.compute(real_matrix_);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    complex_matrix_ = -jacobian_.cast<std::complex<double>>();
    complex_matrix_.diagonal().array() += shifts.pairs[k];
    pairs_[k].dense.compute(complex_matrix_);
  }
  return true;
}

void RadauSystems::solve(const Vector& right, Vector& solution) {
  if (pattern_ != nullptr) {
    sparse_real_.solve(right, solution);
  } else {
    solution = real_.solve(right);
  }
}

void RadauSystems::solve(std::size_t pair, const ComplexVector& right, ComplexVector& solution) {
  if (pattern_ != nullptr) {
    pairs_[pair].sparse.solve(right, solution);
  } else {
    solution = pairs_[pair].dense.solve(right);
  }
}

}  // namespace saltus::ode
