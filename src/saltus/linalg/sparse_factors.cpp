#include "saltus/linalg/sparse_factors.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseLU>
#include <Eigen/SparseQR>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/linalg/eigen_internal.hpp"
#include "saltus/linalg/hidden_internal.hpp"

namespace saltus::linalg {
namespace {

template <class Scalar>
using EigenSparse = Eigen::SparseMatrix<Scalar>;

template <class Scalar>
Eigen::Map<const EigenSparse<Scalar>> eigen_sparse(Index rows, std::span<const int> start, std::span<const int> inner,
                                                   const Scalar* values) {
  return {rows, std::ssize(start) - 1, std::ssize(inner), start.data(), inner.data(), values};
}

Eigen::Map<const EigenSparse<double>> eigen(const SparseColumns& a) {
  return eigen_sparse(a.rows(), a.start(), a.inner(), a.values().data());
}

}  // namespace

/// Eigen's factors, whose pivots are not public.
template <class Scalar>
class Factors : public Eigen::SparseLU<EigenSparse<Scalar>> {
 public:
  [[nodiscard]] Scalar pivot(Index column) const {
    const Index j = this->m_perm_c.indices()(column);
    for (typename Factors::SCMatrix::InnerIterator entry(this->m_Lstore, j); entry; ++entry) {
      if (entry.index() == j) return entry.value();
    }
    return Scalar(0.0);
  }
};

/// Eigen's factors cannot be copied: a copy begins without.
template <class Scalar>
struct SparseLuOf<Scalar>::Parts {
  Parts() = default;
  Parts(const Parts& other) : start(other.start), rows(other.rows) {
    if (!start.empty()) analyse();
  }
  void analyse() {
    const std::vector<Scalar> ones(rows.size(), Scalar(1.0));
    matrix = eigen_sparse(std::ssize(start) - 1, start, rows, ones.data());
    factors.analyzePattern(matrix);
    is_factorised = false;
  }
  std::vector<int> start, rows;
  EigenSparse<Scalar> matrix;
  mutable Factors<Scalar> factors;  // Eigen's signDeterminant is not const
  bool is_factorised = false;
};

template <class Scalar>
void SparseLuOf<Scalar>::analyse(std::span<const int> start, std::span<const int> rows) {
  parts_->start.assign(start.begin(), start.end());
  parts_->rows.assign(rows.begin(), rows.end());
  parts_->analyse();
}

template <class Scalar>
bool SparseLuOf<Scalar>::factorise(std::span<const Scalar> values) {
  SALTUS_ASSERT(values.size() == parts_->rows.size());
  std::copy(values.begin(), values.end(), parts_->matrix.valuePtr());
  parts_->factors.factorize(parts_->matrix);
  return parts_->is_factorised = parts_->factors.info() == Eigen::Success;
}

template <class Scalar>
bool SparseLuOf<Scalar>::is_factorised() const {
  return parts_->is_factorised;
}

template <class Scalar>
void SparseLuOf<Scalar>::solve(std::span<const Scalar> right, std::span<Scalar> solution) const {
  using Column = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  Eigen::Map<Column>(solution.data(), std::ssize(solution)) =
      parts_->factors.solve(Eigen::Map<const Column>(right.data(), std::ssize(right)));
}

template <class Scalar>
bool SparseLuOf<Scalar>::has_small_pivot(std::span<const double> column_sizes, double part) const {
  for (std::size_t column = 0; column < column_sizes.size(); ++column) {
    if (!(std::abs(parts_->factors.pivot(static_cast<Index>(column))) > part * column_sizes[column])) return true;
  }
  return false;
}

template <class Scalar>
double SparseLuOf<Scalar>::sign_of_determinant() const {
  if constexpr (std::is_same_v<Scalar, double>) return parts_->factors.signDeterminant();
  return 0.0;
}

template <class Scalar>
double SparseLuOf<Scalar>::log_abs_determinant() const {
  return std::real(parts_->factors.logAbsDeterminant());
}

template class Hidden<SparseLuOf<double>::Parts>;
template class Hidden<SparseLuOf<std::complex<double>>::Parts>;
template class SparseLuOf<double>;
template class SparseLuOf<std::complex<double>>;

bool SparseLu::compute(const SparseColumns& a) {
  analyse(a);
  return factorise(a);
}

Matrix SparseLu::solve(ConstView right) const {
  Matrix solution(right.rows(), right.cols());
  for (Index j = 0; j < right.cols(); ++j) {
    const Vector column = right.col(j);
    SparseLuOf::solve({column.data(), at(column.size())}, {solution.data() + j * right.rows(), at(right.rows())});
  }
  return solution;
}

namespace {

using SparseQr = Eigen::SparseQR<EigenSparse<double>, Eigen::COLAMDOrdering<int>>;

void factorise(const SparseColumns& a, double threshold, SparseQr& factors) {
  factors.setPivotThreshold(threshold);
  factors.compute(EigenSparse<double>(eigen(a)));
}

std::vector<Index> columns_behind_rank(const SparseQr& factors) {
  std::vector<Index> dependent;
  for (Index i = factors.rank(); i < factors.cols(); ++i) dependent.push_back(factors.colsPermutation().indices()[i]);
  return dependent;
}

}  // namespace

std::vector<Index> dependent_columns(const SparseColumns& a, double threshold) {
  SparseQr factors;
  factorise(a, threshold, factors);
  return columns_behind_rank(factors);
}

NullSpace null_space(const SparseColumns& a, double threshold) {
  SparseQr factors;
  factorise(a, threshold, factors);
  NullSpace result{.dependent = columns_behind_rank(factors), .vectors = {}};
  const Index rank = factors.rank();
  const auto& order = factors.colsPermutation().indices();
  const EigenSparse<double> upper = factors.matrixR();
  std::vector<Triplet> entries;
  for (std::size_t k = 0; k < result.dependent.size(); ++k) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(rank);
    for (EigenSparse<double>::InnerIterator entry(upper, rank + index(k)); entry; ++entry) {
      if (entry.row() < rank) x[entry.row()] -= entry.value();
    }
    if (rank > 0) upper.topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solveInPlace(x);
    for (Index i = 0; i < rank; ++i) {
      if (x[i] != 0.0) entries.push_back({order[i], index(k), x[i]});
    }
    entries.push_back({result.dependent[k], index(k), 1.0});
  }
  result.vectors = SparseColumns(a.cols(), index(result.dependent.size()), entries);
  return result;
}

std::vector<std::size_t> order_of_least_degree(Index size, std::span<const int> start, std::span<const int> rows) {
  const std::vector<double> ones(rows.size(), 1.0);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(EigenSparse<double>(eigen_sparse(size, start, rows, ones.data())), permutation);
  return {permutation.indices().begin(), permutation.indices().end()};
}

struct ComplexLu::Parts {
  Eigen::MatrixXcd matrix;
  Eigen::PartialPivLU<Eigen::MatrixXcd> factors;
  Eigen::VectorXcd right, solution;
};

void ComplexLu::compute_shifted(ConstView a, std::complex<double> shift) {
  parts_->matrix = -linalg::eigen(a).cast<std::complex<double>>();
  parts_->matrix.diagonal().array() += shift;
  parts_->factors.compute(parts_->matrix);
}

void ComplexLu::solve(ConstView right_real, ConstView right_imaginary, View real, View imaginary) {
  auto& [matrix, factors, right, solution] = *parts_.operator->();
  right.resize(right_real.size());
  for (Index i = 0; i < right.size(); ++i) right[i] = {right_real[i], right_imaginary[i]};
  solution = factors.solve(right);
  for (Index i = 0; i < right.size(); ++i) {
    real[i] = solution[i].real();
    imaginary[i] = solution[i].imag();
  }
}

template class Hidden<ComplexLu::Parts>;

}  // namespace saltus::linalg
