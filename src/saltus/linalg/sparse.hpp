// Matrices of which few entries are other than 0.
#pragma once

#include <span>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

struct Triplet {
  Index row, column;
  double value;
};

enum class Major { columns, rows };

/// One entry: its place along the major direction is the caller's.
struct Entry {
  int inner;
  double value;
};

/// Goes through the entries of one column (row).
class EntryRange {
 public:
  class Iterator {
   public:
    Iterator(const int* inner, const double* value) : inner_(inner), value_(value) {}
    [[nodiscard]] Entry operator*() const { return {*inner_, *value_}; }
    Iterator& operator++() {
      ++inner_;
      ++value_;
      return *this;
    }
    [[nodiscard]] bool operator!=(const Iterator& other) const { return inner_ != other.inner_; }

   private:
    const int* inner_;
    const double* value_;
  };
  EntryRange(std::span<const int> inner, const double* values) : inner_(inner), values_(values) {}
  [[nodiscard]] Iterator begin() const { return {inner_.data(), values_}; }
  [[nodiscard]] Iterator end() const { return {inner_.data() + inner_.size(), values_ + inner_.size()}; }
  [[nodiscard]] std::size_t size() const { return inner_.size(); }

 private:
  std::span<const int> inner_;
  const double* values_;
};

/// Holds entries of somebody else, compressed as those of Sparse.
template <Major major>
class SparseView {
 public:
  SparseView(Index rows, Index columns, std::span<const int> start, std::span<const int> inner,
             std::span<const double> values)
      : rows_(rows), columns_(columns), start_(start), inner_(inner), values_(values) {}

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return columns_; }
  [[nodiscard]] Index outer_size() const { return major == Major::columns ? columns_ : rows_; }
  [[nodiscard]] Index entries() const { return std::ssize(inner_); }
  [[nodiscard]] EntryRange along(Index outer) const {
    const auto first = static_cast<std::size_t>(start_[static_cast<std::size_t>(outer)]);
    const auto last = static_cast<std::size_t>(start_[static_cast<std::size_t>(outer) + 1]);
    return {inner_.subspan(first, last - first), values_.data() + first};
  }

 private:
  Index rows_, columns_;
  std::span<const int> start_, inner_;
  std::span<const double> values_;
};

/// Compressed by columns or by rows: the entries start[o] to start[o + 1] are those of column (row) o, by increasing
/// row (column) inner[k].
template <Major major>
class Sparse {
 public:
  Sparse() : Sparse(0, 0) {}
  Sparse(Index rows, Index columns);
  /// Entries at one place are added.
  Sparse(Index rows, Index columns, std::span<const Triplet> entries);
  /// Takes entries that are compressed already.
  Sparse(Index rows, Index columns, std::vector<int> start, std::vector<int> inner, std::vector<double> values);

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return columns_; }
  [[nodiscard]] Index outer_size() const { return major == Major::columns ? columns_ : rows_; }
  [[nodiscard]] Index entries() const { return static_cast<Index>(values_.size()); }
  [[nodiscard]] std::span<const int> start() const { return start_; }
  [[nodiscard]] std::span<const int> inner() const { return inner_; }
  [[nodiscard]] std::span<const double> values() const { return values_; }
  [[nodiscard]] std::span<double> values() { return values_; }
  operator SparseView<major>() const { return {rows_, columns_, start_, inner_, values_}; }

  [[nodiscard]] EntryRange along(Index outer) const { return SparseView<major>(*this).along(outer); }

  [[nodiscard]] double operator()(Index row, Index column) const;  ///< 0 where there is no entry
  [[nodiscard]] Vector diagonal() const;
  [[nodiscard]] Matrix dense() const;
  [[nodiscard]] double norm() const;
  [[nodiscard]] bool all_finite() const;
  /// A x and A' x, of one column or several.
  [[nodiscard]] Matrix times(ConstView x) const;
  [[nodiscard]] Matrix transposed_times(ConstView x) const;
  [[nodiscard]] Sparse transposed() const;
  void scale_rows(ConstView factors);
  [[nodiscard]] std::vector<Triplet> triplets() const;

 private:
  Index rows_, columns_;
  std::vector<int> start_, inner_;
  std::vector<double> values_;
};

using SparseColumns = Sparse<Major::columns>;
using SparseRows = Sparse<Major::rows>;

extern template class Sparse<Major::columns>;
extern template class Sparse<Major::rows>;

[[nodiscard]] inline Matrix operator*(const SparseColumns& a, ConstView x) { return a.times(x); }
[[nodiscard]] inline Matrix operator*(const SparseRows& a, ConstView x) { return a.times(x); }
/// Sums and products of matrices compressed alike.
[[nodiscard]] SparseColumns operator+(const SparseColumns& a, const SparseColumns& b);
[[nodiscard]] SparseColumns operator*(const SparseColumns& a, const SparseColumns& b);
[[nodiscard]] SparseRows operator*(const SparseRows& a, const SparseRows& b);
/// Returns the same matrix, compressed by rows.
[[nodiscard]] SparseRows by_rows(SparseView<Major::columns> a);

}  // namespace saltus::linalg
