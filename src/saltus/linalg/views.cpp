#include "saltus/linalg/views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/linalg/loops_internal.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {
namespace {

/// Sum of term(entry of a, entry of b).
template <class Term>
double sum_over(ConstView a, ConstView b, const Term& term) {
  const bool flat = a.is_contiguous() && b.is_contiguous();
  const Index rows = flat ? a.size() : a.rows(), columns = flat ? 1 : a.cols();
  const Index own = flat ? 1 : a.row_step(), other = flat ? 1 : b.row_step();
  double total = 0.0;
  for (Index j = 0; j < columns; ++j) {
    const double* const p = a.data() + j * a.column_step();
    const double* const q = b.data() + j * b.column_step();
    total += own == 1 && other == 1 ? sum_of(rows, [&](Index i) { return term(p[i], q[i]); })
                                    : sum_of(rows, [&](Index i) { return term(p[i * own], q[i * other]); });
  }
  return total;
}

/// One row is gone through as one column.
[[nodiscard]] ConstView upright(ConstView a) { return a.rows() == 1 ? a.transpose() : a; }

/// NaN where an entry is.
template <class Value>
double largest_of(ConstView a, const Value& value) {
  if (a.empty()) return 0.0;
  const bool flat = a.is_contiguous();
  const Index rows = flat ? a.size() : a.rows(), columns = flat ? 1 : a.cols(), step = flat ? 1 : a.row_step();
  double largest = value(*a.data());
  for (Index j = 0; j < columns; ++j) {
    const double* const p = a.data() + j * a.column_step();
    for (Index i = 0; i < rows; ++i) {
      const double own = value(p[i * step]);
      if (own <= largest) continue;
      largest = own;
      if (own != own) return own;
    }
  }
  return largest;
}

template <class Change>
Matrix changed(ConstView a, const Change& change) {
  Matrix result(a.rows(), a.cols());
  for_each_pair(result, a, [&](double& entry, double old) { entry = change(old); });
  return result;
}

template <class Change>
Matrix combined(ConstView a, ConstView b, const Change& change) {
  SALTUS_ASSERT(a.rows() == b.rows() && a.cols() == b.cols());
  Matrix result(a);
  for_each_pair(result, b, [&](double& entry, double other) { entry = change(entry, other); });
  return result;
}

template <class Number>
Vector by_rows(ConstView a, const Number& number) {
  Vector result(a.rows());
  for (Index i = 0; i < a.rows(); ++i) result[i] = number(a.row(i));
  return result;
}

template <class Number>
Matrix taken(ConstView a, std::span<const Number> rows, std::span<const Number> columns) {
  Matrix result(std::ssize(rows), std::ssize(columns));
  for (Index j = 0; j < result.cols(); ++j) {
    for (Index i = 0; i < result.rows(); ++i) result(i, j) = a(rows[at(i)], columns[at(j)]);
  }
  return result;
}

template <class Number>
Matrix taken_rows(ConstView a, std::span<const Number> rows) {
  Matrix result(std::ssize(rows), a.cols());
  for (Index i = 0; i < result.rows(); ++i) result.row(i) = a.row(rows[at(i)]);
  return result;
}

template <class Number>
Matrix taken_cols(ConstView a, std::span<const Number> columns) {
  Matrix result(a.rows(), std::ssize(columns));
  for (Index j = 0; j < result.cols(); ++j) result.col(j) = a.col(columns[at(j)]);
  return result;
}

}  // namespace

Matrix ConstView::selected(std::span<const Index> rows, std::span<const Index> columns) const {
  return taken(*this, rows, columns);
}
Matrix ConstView::selected(std::span<const int> rows, std::span<const int> columns) const {
  return taken(*this, rows, columns);
}

Matrix ConstView::selected_rows(std::span<const Index> rows) const { return taken_rows(*this, rows); }
Matrix ConstView::selected_rows(std::span<const int> rows) const { return taken_rows(*this, rows); }

Matrix ConstView::selected_cols(std::span<const Index> columns) const { return taken_cols(*this, columns); }
Matrix ConstView::selected_cols(std::span<const int> columns) const { return taken_cols(*this, columns); }

double ConstView::dot(ConstView other) const {
  SALTUS_ASSERT(size() == other.size());
  const bool are_vectors = (rows_ == 1 || columns_ == 1) && (other.rows_ == 1 || other.columns_ == 1);
  if (!are_vectors) return sum_over(*this, other, [](double own, double factor) { return own * factor; });
  return dot_of(size(), data_, step(), other.data_, other.step());
}

double ConstView::sum() const {
  const ConstView a = upright(*this);
  return sum_over(a, a, [](double entry, double) { return entry; });
}

double ConstView::squared_norm() const { return dot(*this); }

double ConstView::norm() const { return std::sqrt(squared_norm()); }

double ConstView::sum_abs() const {
  const ConstView a = upright(*this);
  return sum_over(a, a, [](double entry, double) { return std::abs(entry); });
}

double ConstView::max_abs() const {
  return largest_of(*this, [](double value) { return std::abs(value); });
}

double ConstView::max() const {
  return largest_of(*this, [](double value) { return value; });
}

double ConstView::min() const {
  return -largest_of(*this, [](double value) { return -value; });
}

Index ConstView::index_of_max() const {
  Index best = empty() ? -1 : 0;
  for (Index i = 1; i < size(); ++i) {
    if ((*this)[i] > (*this)[best]) best = i;
  }
  return best;
}

Index ConstView::index_of_min() const {
  Index best = empty() ? -1 : 0;
  for (Index i = 1; i < size(); ++i) {
    if ((*this)[i] < (*this)[best]) best = i;
  }
  return best;
}

bool ConstView::all_finite() const {
  double zero = 0.0;  // 0 times what is not finite is NaN
  for_each_entry(*this, [&](double entry) { zero += 0.0 * entry; });
  return zero == 0.0;
}

Index ConstView::nonzeros() const {
  Index count = 0;
  for (Index j = 0; j < columns_; ++j) {
    for (Index i = 0; i < rows_; ++i) count += (*this)(i, j) != 0.0 ? 1 : 0;
  }
  return count;
}

bool ConstView::is_zero() const {
  for (Index j = 0; j < columns_; ++j) {
    for (Index i = 0; i < rows_; ++i) {
      if ((*this)(i, j) != 0.0) return false;
    }
  }
  return true;
}

Matrix ConstView::abs() const {
  return changed(*this, [](double value) { return std::abs(value); });
}
Matrix ConstView::inverses() const {
  return changed(*this, [](double value) { return 1.0 / value; });
}
Matrix ConstView::square_roots() const {
  return changed(*this, [](double value) { return std::sqrt(value); });
}
Matrix ConstView::times_each(ConstView other) const {
  return combined(*this, other, [](double a, double b) { return a * b; });
}
Matrix ConstView::over_each(ConstView other) const {
  return combined(*this, other, [](double a, double b) { return a / b; });
}
Matrix ConstView::at_least(double bound) const {
  return changed(*this, [bound](double value) { return std::max(value, bound); });
}
Matrix ConstView::at_most(double bound) const {
  return changed(*this, [bound](double value) { return std::min(value, bound); });
}
Matrix ConstView::at_least(ConstView bounds) const {
  return combined(*this, bounds, [](double a, double b) { return std::max(a, b); });
}
Matrix ConstView::at_most(ConstView bounds) const {
  return combined(*this, bounds, [](double a, double b) { return std::min(a, b); });
}
Matrix ConstView::normalized() const {
  const double length = norm();
  return length > 0.0 ? *this / length : Matrix(*this);
}

Vector ConstView::row_sums() const {
  return by_rows(*this, [](ConstView row) { return row.sum(); });
}
Vector ConstView::col_sums() const { return transpose().row_sums(); }
Vector ConstView::row_norms() const {
  return by_rows(*this, [](ConstView row) { return row.norm(); });
}
Vector ConstView::col_norms() const { return transpose().row_norms(); }
Vector ConstView::row_max_abs() const {
  return by_rows(*this, [](ConstView row) { return row.max_abs(); });
}

template <class Self>
Self& Writable<Self>::operator*=(double factor) {
  for_each_pair(all(), *this, [factor](double& entry, double) { entry *= factor; });
  return self();
}

template <class Self>
Self& Writable<Self>::operator/=(double divisor) {
  for_each_pair(all(), *this, [divisor](double& entry, double) { entry /= divisor; });
  return self();
}

template <class Self>
Self& Writable<Self>::add_scaled(double factor, ConstView other) {
  if (rows_ != other.rows() && rows_ == other.cols()) other = other.transpose();
  SALTUS_ASSERT(rows_ == other.rows() && columns_ == other.cols());
  for_each_pair(all(), other, [factor](double& entry, double summand) { entry += factor * summand; });
  return self();
}

template <class Self>
Self& Writable<Self>::add_to_all(double summand) {
  for_each_pair(all(), *this, [summand](double& entry, double) { entry += summand; });
  return self();
}

template <class Self>
Self& Writable<Self>::times_each_in_place(ConstView other) {
  SALTUS_ASSERT(rows_ == other.rows() && columns_ == other.cols());
  for_each_pair(all(), other, [](double& entry, double factor) { entry *= factor; });
  return self();
}

template <class Self>
Self& Writable<Self>::set_constant(double value) {
  if (is_contiguous()) {
    std::fill_n(data_, size(), value);
  } else {
    for_each_pair(all(), *this, [value](double& entry, double) { entry = value; });
  }
  return self();
}

template <class Self>
Self& Writable<Self>::set_identity() {
  set_zero();
  diagonal().set_constant(1.0);
  return self();
}

template <class Self>
Self& Writable<Self>::scale_rows(ConstView factors) {
  SALTUS_ASSERT(factors.size() == rows_);
  for (Index j = 0; j < columns_; ++j) {
    for (Index i = 0; i < rows_; ++i) (*this)(i, j) *= factors[i];
  }
  return self();
}

template <class Self>
Self& Writable<Self>::scale_cols(ConstView factors) {
  transpose().scale_rows(factors);
  return self();
}

View& View::operator=(ConstView other) {
  if (rows_ != other.rows() && rows_ == other.cols()) other = other.transpose();
  SALTUS_ASSERT(rows_ == other.rows() && columns_ == other.cols());
  if (is_contiguous() && other.is_contiguous()) {
    std::copy_n(other.data(), size(), data_);
  } else {
    for_each_pair(View(*this), other, [](double& entry, double value) { entry = value; });
  }
  return *this;
}

View& View::operator=(std::initializer_list<double> values) {
  SALTUS_ASSERT(size() == std::ssize(values));
  Index i = 0;
  for (const double value : values) (*this)[i++] = value;
  return *this;
}

template class Writable<View>;
template class Writable<Matrix>;

}  // namespace saltus::linalg
