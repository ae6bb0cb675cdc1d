#include "saltus/linalg/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/contracts.hpp"
#include "saltus/linalg/eigen_internal.hpp"
#include "saltus/linalg/loops_internal.hpp"

namespace saltus::linalg {

Matrix::Matrix(Index rows, Index columns) {
  data_ = own_.data();
  resize(rows, columns);
}

Matrix::Matrix(ConstView other) : Matrix(other.rows(), other.cols()) { View(*this) = other; }

Matrix::Matrix(std::initializer_list<std::initializer_list<double>> rows)
    : Matrix(std::ssize(rows), rows.size() == 0 ? 0 : std::ssize(*rows.begin())) {
  Index i = 0;
  for (const auto& values : rows) row(i++) = values;
}

Matrix::Matrix(Matrix&& other) noexcept {
  data_ = own_.data();
  take(other);
}

/// The other's entries; what is in the object is copied, the rest changes hands.
void Matrix::take(Matrix& other) noexcept {
  rows_ = other.rows_;
  columns_ = other.columns_;
  column_step_ = other.column_step_;
  if (other.memory_ != nullptr) {
    memory_ = std::move(other.memory_);
    data_ = memory_.get();
    capacity_ = std::exchange(other.capacity_, inside);
  } else {
    std::copy_n(other.data_, size(), data_);
  }
  other.data_ = other.own_.data();
  other.rows_ = 0;
  other.columns_ = std::min<Index>(other.columns_, 1);
  other.column_step_ = 0;
}

Matrix& Matrix::operator=(ConstView other) {
  // A part of itself, or its transpose, may lie where entries go, or in the memory that a new shape takes.
  if (other.data() >= data_ && other.data() < data_ + size()) return *this = Matrix(other);
  resize(other.rows(), other.cols());
  View(*this) = other;
  return *this;
}

Matrix& Matrix::operator=(Matrix&& other) noexcept {
  if (this != &other) take(other);
  return *this;
}

void Matrix::swap(Matrix& other) noexcept { std::swap(*this, other); }

Matrix Matrix::constant(Index rows, Index columns, double value) {
  Matrix result(rows, columns);
  std::fill_n(result.data_, result.size(), value);
  return result;
}

Matrix Matrix::identity(Index rows, Index columns) {
  Matrix result(rows, columns);
  result.set_identity();
  return result;
}

Matrix Matrix::diagonal_of(ConstView entries) {
  Matrix result = zero(entries.size(), entries.size());
  result.diagonal() = entries;
  return result;
}

void Matrix::set_zero(Index rows, Index columns) { set_constant(rows, columns, 0.0); }

void Matrix::set_constant(Index rows, Index columns, double value) {
  resize(rows, columns);
  std::fill_n(data_, size(), value);
}

void Matrix::resize(Index rows, Index columns) {
  if (rows * columns > capacity_) {
    // First the memory: where there is none, the matrix stays as it is.
    memory_.reset(new double[static_cast<std::size_t>(rows * columns)]);
    data_ = memory_.get();
    capacity_ = rows * columns;
  }
  rows_ = rows;
  columns_ = columns;
  column_step_ = rows;
}

void Matrix::resize_and_keep(Index rows, Index columns) {
  if (rows == rows_ && columns == columns_) return;
  Matrix result(rows, columns);
  const Index kept_rows = std::min(rows, rows_), kept_columns = std::min(columns, columns_);
  result.block(0, 0, kept_rows, kept_columns) = std::as_const(*this).block(0, 0, kept_rows, kept_columns);
  *this = std::move(result);
}

Vector::Vector(ConstView other) : Matrix(other.size(), 1) {
  SALTUS_ASSERT(other.cols() == 1 || other.rows() == 1 || other.empty());
  if (!other.empty()) View(*this) = other;
}

Vector::Vector(Matrix&& other) noexcept : Matrix(std::move(other)) {
  if (columns_ != 1) Matrix::resize(size(), 1);
}

Vector::Vector(std::initializer_list<double> values) : Vector(std::ssize(values)) { View(*this) = values; }

Vector& Vector::operator=(ConstView other) {
  if (other.cols() != 1) other = other.transpose();
  SALTUS_ASSERT(other.cols() == 1 || other.empty());
  if (other.empty()) {
    resize(0);
  } else {
    Matrix::operator=(other);
  }
  return *this;
}

Vector& Vector::operator=(Matrix&& other) noexcept {
  Matrix::operator=(std::move(other));
  if (columns_ != 1) Matrix::resize(size(), 1);
  return *this;
}

Vector& Vector::operator=(Vector&& other) noexcept {
  Matrix::operator=(std::move(other));
  return *this;
}

Vector Vector::constant(Index size, double value) { return Vector(Matrix::constant(size, 1, value)); }

Vector Vector::unit(Index size, Index place) {
  Vector result = zero(size);
  result[place] = 1.0;
  return result;
}

void Vector::set_constant(Index size, double value) { Matrix::set_constant(size, 1, value); }

Matrix operator+(ConstView a, ConstView b) {
  Matrix result(a);
  result += b;
  return result;
}

Matrix operator-(ConstView a, ConstView b) {
  Matrix result(a);
  result -= b;
  return result;
}

Matrix operator-(ConstView a) { return -1.0 * a; }

Matrix operator*(double factor, ConstView a) {
  Matrix result(a);
  result *= factor;
  return result;
}

Matrix operator/(ConstView a, double divisor) {
  Matrix result(a);
  result /= divisor;
  return result;
}

Matrix operator*(ConstView a, ConstView b) {
  Matrix result(a.rows(), b.cols());
  multiply(a, b, result);
  return result;
}

bool operator==(ConstView a, ConstView b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  for (Index j = 0; j < a.cols(); ++j) {
    for (Index i = 0; i < a.rows(); ++i) {
      if (a(i, j) != b(i, j)) return false;
    }
  }
  return true;
}

void multiply(ConstView a, ConstView b, View out) {
  SALTUS_ASSERT(a.cols() == b.rows() && out.rows() == a.rows() && out.cols() == b.cols());
  // Where a row of a is contiguous and its columns are not, sums along it; else columns of a are added up.
  const bool by_rows = a.column_step() == 1 && a.row_step() != 1;
  constexpr Index many = 16;  // blocked products pay from here on
  if (a.rows() >= many && a.cols() >= many && b.cols() >= many) {
    eigen(out).noalias() = eigen(a) * eigen(b);
    return;
  }
  for (Index j = 0; j < b.cols(); ++j) {
    double* const column = out.data() + j * out.column_step();
    if (by_rows) {
      const double* const own = b.data() + j * b.column_step();
      for (Index i = 0; i < a.rows(); ++i) {
        column[i * out.row_step()] = dot_of(a.cols(), a.data() + i * a.row_step(), 1, own, b.row_step());
      }
      continue;
    }
    for (Index i = 0; i < a.rows(); ++i) column[i * out.row_step()] = 0.0;
    for (Index k = 0; k < a.cols(); ++k) {
      const double factor = b(k, j);
      const double* const own = a.data() + k * a.column_step();
      for (Index i = 0; i < a.rows(); ++i) column[i * out.row_step()] += own[i * a.row_step()] * factor;
    }
  }
}

bool any_beyond(ConstView a, ConstView bounds) {
  SALTUS_ASSERT(a.rows() == bounds.rows() && a.cols() == bounds.cols());
  for (Index j = 0; j < a.cols(); ++j) {
    for (Index i = 0; i < a.rows(); ++i) {
      if (std::abs(a(i, j)) > bounds(i, j)) return true;
    }
  }
  return false;
}

Matrix scaled_rows(ConstView factors, ConstView a) {
  Matrix result(a);
  result.scale_rows(factors);
  return result;
}

Matrix scaled_cols(ConstView a, ConstView factors) {
  Matrix result(a);
  result.scale_cols(factors);
  return result;
}

Matrix plus_column(ConstView a, ConstView summand) {
  Matrix result(a);
  for (Index j = 0; j < a.cols(); ++j) result.col(j) += summand;
  return result;
}

Matrix plus_row(ConstView a, ConstView summand) {
  Matrix result(a);
  for (Index i = 0; i < a.rows(); ++i) result.row(i) += summand;
  return result;
}

Vector joined(std::initializer_list<ConstView> parts) {
  Index size = 0;
  for (const ConstView& part : parts) size += part.size();
  Vector result(size);
  Index first = 0;
  for (const ConstView& part : parts) {
    result.segment(first, part.size()) = part;
    first += part.size();
  }
  return result;
}

}  // namespace saltus::linalg
