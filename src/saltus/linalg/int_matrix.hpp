// Matrices of small whole numbers, row by row: signs of regions, patterns.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "saltus/linalg/views.hpp"

namespace saltus::linalg {

/// A matrix of whole numbers whose rows are contiguous. New ones are 0.
class IntMatrix {
 public:
  IntMatrix() = default;
  IntMatrix(Index rows, Index columns)
      : rows_(rows), columns_(columns), values_(static_cast<std::size_t>(rows * columns), 0) {}
  /// Takes entries row by row.
  IntMatrix(std::initializer_list<std::initializer_list<int>> rows)
      : rows_(std::ssize(rows)), columns_(rows.size() == 0 ? 0 : std::ssize(*rows.begin())) {
    for (const auto& row : rows) values_.insert(values_.end(), row);
  }

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return columns_; }
  [[nodiscard]] Index size() const { return rows_ * columns_; }
  [[nodiscard]] int operator()(Index i, Index j) const { return values_[static_cast<std::size_t>(i * columns_ + j)]; }
  [[nodiscard]] int& operator()(Index i, Index j) { return values_[static_cast<std::size_t>(i * columns_ + j)]; }
  [[nodiscard]] std::span<const int> row(Index i) const {
    return std::span(values_).subspan(static_cast<std::size_t>(i * columns_), static_cast<std::size_t>(columns_));
  }
  [[nodiscard]] std::span<int> row(Index i) {
    return std::span(values_).subspan(static_cast<std::size_t>(i * columns_), static_cast<std::size_t>(columns_));
  }
  [[nodiscard]] bool operator==(const IntMatrix&) const = default;

 private:
  Index rows_ = 0, columns_ = 0;
  std::vector<int> values_;
};

}  // namespace saltus::linalg
