// Matrices of doubles that belong to somebody else: what is read, and what is written.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

namespace saltus::linalg {

using Index = std::ptrdiff_t;

class Matrix;
class Vector;

/// What is read: rows x columns numbers in memory of somebody else, the entry (i, j) at data[i * row_step + j *
/// column_step]. One of a single row or column is a vector, too. Cost: views cost nothing; what returns a Matrix or
/// Vector copies.
class ConstView {
 public:
  ConstView() = default;
  ConstView(const double* data, Index rows, Index columns, Index row_step, Index column_step)
      : data_(const_cast<double*>(data)),
        rows_(rows),
        columns_(columns),
        row_step_(row_step),
        column_step_(column_step) {}
  /// Columns one behind the other.
  ConstView(const double* data, Index rows, Index columns) : ConstView(data, rows, columns, 1, rows) {}
  ConstView(const double* data, Index size) : ConstView(data, size, 1) {}
  ConstView(std::span<const double> values) : ConstView(values.data(), std::ssize(values)) {}
  ConstView(const std::vector<double>& values) : ConstView(values.data(), std::ssize(values)) {}

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return columns_; }
  [[nodiscard]] Index size() const { return rows_ * columns_; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] const double* data() const { return data_; }
  [[nodiscard]] Index row_step() const { return row_step_; }
  [[nodiscard]] Index column_step() const { return column_step_; }
  /// Whether its entries lie one behind the other, column by column.
  [[nodiscard]] bool is_contiguous() const {
    return (row_step_ == 1 || rows_ <= 1) && (column_step_ == rows_ || columns_ <= 1);
  }

  [[nodiscard]] double operator()(Index i, Index j) const { return data_[i * row_step_ + j * column_step_]; }
  /// Of a vector.
  [[nodiscard]] double operator[](Index i) const { return data_[i * step()]; }
  [[nodiscard]] double operator()(Index i) const { return data_[i * step()]; }

  [[nodiscard]] ConstView block(Index i, Index j, Index rows, Index columns) const {
    return {data_ + i * row_step_ + j * column_step_, rows, columns, row_step_, column_step_};
  }
  [[nodiscard]] ConstView row(Index i) const { return block(i, 0, 1, columns_); }
  [[nodiscard]] ConstView col(Index j) const { return block(0, j, rows_, 1); }
  [[nodiscard]] ConstView middle_rows(Index i, Index count) const { return block(i, 0, count, columns_); }
  [[nodiscard]] ConstView middle_cols(Index j, Index count) const { return block(0, j, rows_, count); }
  [[nodiscard]] ConstView top_rows(Index count) const { return middle_rows(0, count); }
  [[nodiscard]] ConstView bottom_rows(Index count) const { return middle_rows(rows_ - count, count); }
  [[nodiscard]] ConstView left_cols(Index count) const { return middle_cols(0, count); }
  [[nodiscard]] ConstView right_cols(Index count) const { return middle_cols(columns_ - count, count); }
  /// Of a vector: a column where it is one, a row where it is one.
  [[nodiscard]] ConstView segment(Index first, Index count) const {
    return columns_ == 1 ? middle_rows(first, count) : middle_cols(first, count);
  }
  [[nodiscard]] ConstView head(Index count) const { return segment(0, count); }
  [[nodiscard]] ConstView tail(Index count) const { return segment(size() - count, count); }
  [[nodiscard]] ConstView transpose() const { return {data_, columns_, rows_, column_step_, row_step_}; }
  /// A column: the entries (i, i).
  [[nodiscard]] ConstView diagonal() const {
    return {data_, rows_ < columns_ ? rows_ : columns_, 1, row_step_ + column_step_, 0};
  }
  /// The rows and columns of these numbers, in their order.
  [[nodiscard]] Matrix selected(std::span<const Index> rows, std::span<const Index> columns) const;
  [[nodiscard]] Matrix selected_rows(std::span<const Index> rows) const;
  [[nodiscard]] Matrix selected_cols(std::span<const Index> columns) const;
  [[nodiscard]] Matrix selected(std::span<const int> rows, std::span<const int> columns) const;
  [[nodiscard]] Matrix selected_rows(std::span<const int> rows) const;
  [[nodiscard]] Matrix selected_cols(std::span<const int> columns) const;

  // Numbers of all entries. Of nothing: 0. A NaN among them gives a NaN.
  [[nodiscard]] double dot(ConstView other) const;
  [[nodiscard]] double sum() const;
  [[nodiscard]] double mean() const { return sum() / static_cast<double>(size()); }
  [[nodiscard]] double squared_norm() const;
  [[nodiscard]] double norm() const;     ///< Euclid's, Frobenius'
  [[nodiscard]] double sum_abs() const;  ///< sum of |a|
  [[nodiscard]] double max_abs() const;  ///< largest |a|
  [[nodiscard]] double max() const;
  [[nodiscard]] double min() const;
  [[nodiscard]] Index index_of_max() const;  ///< of a vector; the first; -1 of nothing
  [[nodiscard]] Index index_of_min() const;
  [[nodiscard]] bool all_finite() const;
  [[nodiscard]] bool is_zero() const;  ///< exactly
  [[nodiscard]] Index nonzeros() const;

  // Entry by entry.
  [[nodiscard]] Matrix abs() const;
  [[nodiscard]] Matrix inverses() const;
  [[nodiscard]] Matrix square_roots() const;
  [[nodiscard]] Matrix times_each(ConstView other) const;
  [[nodiscard]] Matrix over_each(ConstView other) const;
  [[nodiscard]] Matrix at_least(double bound) const;
  [[nodiscard]] Matrix at_most(double bound) const;
  [[nodiscard]] Matrix at_least(ConstView bounds) const;
  [[nodiscard]] Matrix at_most(ConstView bounds) const;
  [[nodiscard]] Matrix normalized() const;  ///< over norm(); 0 stays 0

  // Row by row, column by column: a Vector of rows() or cols().
  [[nodiscard]] Vector row_sums() const;
  [[nodiscard]] Vector col_sums() const;
  [[nodiscard]] Vector row_norms() const;
  [[nodiscard]] Vector col_norms() const;
  [[nodiscard]] Vector row_max_abs() const;

 protected:
  [[nodiscard]] Index step() const { return columns_ == 1 ? row_step_ : column_step_; }

  double* data_ = nullptr;
  Index rows_ = 0, columns_ = 0, row_step_ = 1, column_step_ = 0;
};

class View;

/// What View and Matrix share: entries and parts that can be written.
template <class Self>
class Writable : public ConstView {
 public:
  using ConstView::ConstView;
  using ConstView::operator();
  using ConstView::operator[];

  [[nodiscard]] const double* data() const { return data_; }
  [[nodiscard]] double* data() { return data_; }
  [[nodiscard]] double& operator()(Index i, Index j) { return data_[i * row_step_ + j * column_step_]; }
  [[nodiscard]] double& operator[](Index i) { return data_[i * step()]; }
  [[nodiscard]] double& operator()(Index i) { return data_[i * step()]; }

  using ConstView::block, ConstView::row, ConstView::col, ConstView::middle_rows, ConstView::middle_cols,
      ConstView::top_rows, ConstView::bottom_rows, ConstView::left_cols, ConstView::right_cols, ConstView::segment,
      ConstView::head, ConstView::tail, ConstView::transpose, ConstView::diagonal;
  [[nodiscard]] View block(Index i, Index j, Index rows, Index columns);
  [[nodiscard]] View row(Index i);
  [[nodiscard]] View col(Index j);
  [[nodiscard]] View middle_rows(Index i, Index count);
  [[nodiscard]] View middle_cols(Index j, Index count);
  [[nodiscard]] View top_rows(Index count);
  [[nodiscard]] View bottom_rows(Index count);
  [[nodiscard]] View left_cols(Index count);
  [[nodiscard]] View right_cols(Index count);
  [[nodiscard]] View segment(Index first, Index count);
  [[nodiscard]] View head(Index count);
  [[nodiscard]] View tail(Index count);
  [[nodiscard]] View transpose();
  [[nodiscard]] View diagonal();

  // In place; the shapes must agree.
  Self& operator+=(ConstView other) { return add_scaled(1.0, other); }
  Self& operator-=(ConstView other) { return add_scaled(-1.0, other); }
  Self& operator*=(double factor);
  Self& operator/=(double divisor);
  Self& add_scaled(double factor, ConstView other);  ///< a += factor b
  Self& add_to_all(double summand);
  Self& times_each_in_place(ConstView other);
  Self& set_constant(double value);
  Self& set_zero() { return set_constant(0.0); }
  Self& set_identity();
  Self& scale_rows(ConstView factors);  ///< row i by factors[i]
  Self& scale_cols(ConstView factors);

 private:
  [[nodiscard]] Self& self() { return static_cast<Self&>(*this); }
  [[nodiscard]] View all();
};

/// What is written: assignment copies entries into the memory that it shows, whose shape stays.
class View : public Writable<View> {
 public:
  View() = default;
  View(double* data, Index rows, Index columns, Index row_step, Index column_step)
      : Writable(data, rows, columns, row_step, column_step) {}
  View(double* data, Index rows, Index columns) : Writable(data, rows, columns) {}
  View(double* data, Index size) : Writable(data, size) {}
  View(std::span<double> values) : Writable(values.data(), std::ssize(values)) {}
  View(std::vector<double>& values) : Writable(values.data(), std::ssize(values)) {}
  View(Matrix& matrix);
  View(const View& other) = default;
  ~View() = default;
  /// Copies entries of the same shape; a row into a column and a column into a row, too.
  View& operator=(ConstView other);
  View& operator=(const View& other) { return *this = static_cast<const ConstView&>(other); }
  /// Of a vector: as many as it has.
  View& operator=(std::initializer_list<double> values);
};

template <class Self>
View Writable<Self>::all() {
  return {data_, rows_, columns_, row_step_, column_step_};
}
template <class Self>
View Writable<Self>::block(Index i, Index j, Index rows, Index columns) {
  return {data_ + i * row_step_ + j * column_step_, rows, columns, row_step_, column_step_};
}
template <class Self>
View Writable<Self>::row(Index i) {
  return block(i, 0, 1, columns_);
}
template <class Self>
View Writable<Self>::col(Index j) {
  return block(0, j, rows_, 1);
}
template <class Self>
View Writable<Self>::middle_rows(Index i, Index count) {
  return block(i, 0, count, columns_);
}
template <class Self>
View Writable<Self>::middle_cols(Index j, Index count) {
  return block(0, j, rows_, count);
}
template <class Self>
View Writable<Self>::top_rows(Index count) {
  return middle_rows(0, count);
}
template <class Self>
View Writable<Self>::bottom_rows(Index count) {
  return middle_rows(rows_ - count, count);
}
template <class Self>
View Writable<Self>::left_cols(Index count) {
  return middle_cols(0, count);
}
template <class Self>
View Writable<Self>::right_cols(Index count) {
  return middle_cols(columns_ - count, count);
}
template <class Self>
View Writable<Self>::segment(Index first, Index count) {
  return columns_ == 1 ? middle_rows(first, count) : middle_cols(first, count);
}
template <class Self>
View Writable<Self>::head(Index count) {
  return segment(0, count);
}
template <class Self>
View Writable<Self>::tail(Index count) {
  return segment(size() - count, count);
}
template <class Self>
View Writable<Self>::transpose() {
  return {data_, columns_, rows_, column_step_, row_step_};
}
template <class Self>
View Writable<Self>::diagonal() {
  return {data_, rows_ < columns_ ? rows_ : columns_, 1, row_step_ + column_step_, 0};
}

extern template class Writable<View>;
extern template class Writable<Matrix>;

}  // namespace saltus::linalg
