// Rows of one width in few lists, however many rows there are.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "saltus/base/contracts.hpp"

namespace saltus::result {

/// A row handed out as a list of its own: small integers become int.
template <class Number>
using RowVector = std::vector<std::conditional_t<std::is_integral_v<Number>, int, Number>>;

/// Goes through anything with [] by number.
template <class List>
class NumberedIterator {
 public:
  using difference_type = std::ptrdiff_t;
  using value_type = std::decay_t<decltype(std::declval<const List&>()[0])>;
  using reference = decltype(std::declval<const List&>()[0]);
  /// Holds, where [] hands out values, one that lives as long as it is looked at.
  struct pointer {
    value_type value;
    const value_type* operator->() const { return &value; }
  };
  using iterator_category = std::input_iterator_tag;

  NumberedIterator() = default;
  NumberedIterator(const List& list, std::size_t place) : list_(&list), place_(place) {}
  reference operator*() const { return (*list_)[place_]; }
  pointer operator->() const { return {**this}; }
  friend NumberedIterator operator+(NumberedIterator from, std::ptrdiff_t steps) {
    from.place_ += static_cast<std::size_t>(steps);
    return from;
  }
  friend difference_type operator-(const NumberedIterator& a, const NumberedIterator& b) {
    return static_cast<difference_type>(a.place_) - static_cast<difference_type>(b.place_);
  }
  NumberedIterator& operator++() {
    ++place_;
    return *this;
  }
  NumberedIterator operator++(int) { return {*list_, place_++}; }
  bool operator==(const NumberedIterator& other) const { return place_ == other.place_; }

 private:
  const List* list_ = nullptr;
  std::size_t place_ = 0;
};

/// Holds rows of numbers, one after the other in one list.
template <class Number>
class Table {
 public:
  /// Is valid until the table changes.
  class Row : public std::span<const Number> {
   public:
    using std::span<const Number>::span;
    // NOLINTNEXTLINE(google-explicit-constructor): a row is used as the list that it is
    operator RowVector<Number>() const { return {this->begin(), this->end()}; }
    friend bool operator==(const Row& a, const Row& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }
    friend bool operator==(const Row& a, const RowVector<Number>& b) {
      return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }
  };

  Table() = default;
  Table(std::initializer_list<RowVector<Number>> rows) {
    for (const auto& row : rows) push_back(row);
  }
  explicit Table(const std::vector<RowVector<Number>>& rows) {
    for (const auto& row : rows) push_back(row);
  }
  /// @param numbers  rows * width of them, row after row
  Table(std::size_t rows, std::size_t width, std::vector<Number> numbers)
      : rows_(rows), width_(width), numbers_(std::move(numbers)) {
    SALTUS_ASSERT(numbers_.size() == rows * width);
  }

  [[nodiscard]] std::size_t size() const { return rows_; }
  [[nodiscard]] bool empty() const { return rows_ == 0; }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] const Number* data() const { return numbers_.data(); }
  [[nodiscard]] Row operator[](std::size_t row) const { return Row(data() + row * width_, width_); }
  [[nodiscard]] Row front() const { return (*this)[0]; }
  [[nodiscard]] Row back() const { return (*this)[rows_ - 1]; }
  [[nodiscard]] auto begin() const { return NumberedIterator<Table>(*this, 0); }
  [[nodiscard]] auto end() const { return NumberedIterator<Table>(*this, rows_); }
  bool operator==(const Table& other) const {
    return rows_ == other.rows_ && width_ == other.width_ && numbers_ == other.numbers_;
  }
  /// Returns a row to be written.
  [[nodiscard]] std::span<Number> change(std::size_t row) { return {numbers_.data() + row * width_, width_}; }

  void reserve(std::size_t rows) { numbers_.reserve(rows * width_); }
  /// Appends a row of zeros, to be written; all rows have the width of the first one.
  std::span<Number> emplace_back(std::size_t width) {
    if (rows_ == 0) width_ = width;
    SALTUS_ASSERT(width == width_);
    numbers_.resize(numbers_.size() + width_);
    return change(rows_++);
  }
  void push_back(Row row) {
    if (rows_ == 0) width_ = row.size();
    SALTUS_ASSERT(row.size() == width_);
    const bool own = !numbers_.empty() && numbers_.data() <= row.data() && row.data() <= &numbers_.back();
    if (own) return push_back(RowVector<Number>(row));
    numbers_.insert(numbers_.end(), row.begin(), row.end());
    ++rows_;
  }
  void push_back(const RowVector<Number>& row) { push_back(Row(row.data(), row.size())); }
  void push_back(std::initializer_list<Number> row) { push_back(Row(std::data(row), row.size())); }
  void pop_back() {
    numbers_.resize(numbers_.size() - width_);
    --rows_;
  }
  /// Leaves these rows, ascending.
  void keep(const std::vector<std::size_t>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i] != i) std::copy_n(data() + rows[i] * width_, width_, numbers_.data() + i * width_);
    }
    rows_ = rows.size();
    numbers_.resize(rows_ * width_);
  }
  /// Leaves these columns, ascending.
  void keep_columns(const std::vector<std::size_t>& columns) {
    std::size_t end = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      for (const std::size_t column : columns) numbers_[end++] = numbers_[row * width_ + column];
    }
    width_ = rows_ > 0 ? columns.size() : 0;
    numbers_.resize(end);
  }
  /// Leaves the first columns of all rows.
  void narrow(std::size_t width) {
    if (width >= width_) return;
    for (std::size_t i = 0; i < rows_; ++i) std::copy_n(data() + i * width_, width, numbers_.data() + i * width);
    width_ = width;
    numbers_.resize(rows_ * width_);
  }

 private:
  std::size_t rows_ = 0, width_ = 0;
  std::vector<Number> numbers_;
};

/// Holds a value for every row, kept where it changes.
template <class Value>
class SteadyColumn {
 public:
  /// Sets the value from this row on, which is behind all that were set.
  void set(std::size_t row, Value value) {
    if (!values_.empty() && same(values_.back(), value)) return;
    from_.push_back(static_cast<std::uint32_t>(row));
    values_.push_back(std::move(value));
  }
  [[nodiscard]] const Value& at(std::size_t row) const {
    if (from_.back() <= row) return values_.back();
    if (row < from_.size() && from_[row] == row) return values_[row];  // it changes in every row up to there
    return values_[static_cast<std::size_t>(std::upper_bound(from_.begin(), from_.end(), row) - from_.begin()) - 1];
  }
  [[nodiscard]] const Value& back() const { return values_.back(); }
  [[nodiscard]] bool empty() const { return values_.empty(); }
  /// Forgets what was set from this row on.
  void drop_from(std::size_t row) {
    while (!from_.empty() && from_.back() >= row) from_.pop_back(), values_.pop_back();
  }
  /// Calls visit(first row, value) for each change.
  template <class Visit>
  void for_each_change(Visit visit) const {
    for (std::size_t k = 0; k < from_.size(); ++k) visit(std::size_t{from_[k]}, values_[k]);
  }
  /// Compares bits, not values: NaN is NaN, and -0 is not 0.
  [[nodiscard]] static bool same(const Value& a, const Value& b) {
    if constexpr (std::is_same_v<Value, double>) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    } else {
      return a == b;
    }
  }

 private:
  std::vector<std::uint32_t> from_;
  std::vector<Value> values_;
};

/// Holds rows of numbers that seldom change from one row to the next: what a row takes are its changes.
template <class Number>
class SteadyTable {
 public:
  /// Is valid until the table changes.
  class Row {
   public:
    Row(const SteadyTable& table, std::size_t row) : table_(&table), row_(row) {}
    [[nodiscard]] std::size_t size() const { return table_->width(); }
    [[nodiscard]] bool empty() const { return size() == 0; }
    [[nodiscard]] Number operator[](std::size_t column) const { return table_->columns_[column].at(row_); }
    [[nodiscard]] auto begin() const { return NumberedIterator<Row>(*this, 0); }
    [[nodiscard]] auto end() const { return NumberedIterator<Row>(*this, size()); }
    // NOLINTNEXTLINE(google-explicit-constructor): a row is used as the list that it is
    operator RowVector<Number>() const {
      RowVector<Number> list(size());
      for (std::size_t k = 0; k < size(); ++k) list[k] = (*this)[k];
      return list;
    }
    friend bool operator==(const Row& a, const Row& b) { return equal(a, b); }
    friend bool operator==(const Row& a, const RowVector<Number>& b) { return equal(a, b); }

   private:
    template <class List>
    static bool equal(const Row& a, const List& b) {
      bool same = a.size() == b.size();
      for (std::size_t k = 0; same && k < b.size(); ++k) same = a[k] == b[k];
      return same;
    }
    const SteadyTable* table_;
    std::size_t row_;
  };

  SteadyTable() = default;
  SteadyTable(std::initializer_list<RowVector<Number>> rows) {
    for (const auto& row : rows) push_back(row);
  }

  [[nodiscard]] std::size_t size() const { return rows_; }
  [[nodiscard]] bool empty() const { return rows_ == 0; }
  [[nodiscard]] std::size_t width() const { return columns_.size(); }
  [[nodiscard]] const SteadyColumn<Number>& column(std::size_t number) const { return columns_[number]; }
  [[nodiscard]] Row operator[](std::size_t row) const { return Row(*this, row); }
  [[nodiscard]] Row front() const { return (*this)[0]; }
  [[nodiscard]] Row back() const { return (*this)[rows_ - 1]; }
  [[nodiscard]] auto begin() const { return NumberedIterator<SteadyTable>(*this, 0); }
  [[nodiscard]] auto end() const { return NumberedIterator<SteadyTable>(*this, rows_); }

  bool operator==(const SteadyTable& other) const {
    bool same = rows_ == other.rows_;
    for (std::size_t row = 0; same && row < rows_; ++row) same = (*this)[row] == other[row];
    return same;
  }
  /// Appends a row; all have the width of the first one.
  template <class List>
  void push_back(const List& row) {
    const bool first = columns_.empty();
    if (first) columns_.resize(row.size());
    SALTUS_ASSERT(row.size() == columns_.size());
    last_.resize(row.size());
    constexpr std::size_t block = 64;  // few differ: blocks are compared without branches
    for (std::size_t begin = 0; begin < row.size(); begin += block) {
      const std::size_t end = std::min(begin + block, row.size());
      bool differs = first;
      for (std::size_t k = begin; k < end; ++k) {
        differs |= !SteadyColumn<Number>::same(last_[k], static_cast<Number>(row[k]));
      }
      if (!differs) continue;
      for (std::size_t k = begin; k < end; ++k) columns_[k].set(rows_, last_[k] = static_cast<Number>(row[k]));
    }
    ++rows_;
  }
  void push_back(std::initializer_list<typename RowVector<Number>::value_type> row) {
    push_back(RowVector<Number>(row));
  }
  /// Appends a row that differs from the last one in these columns at most; the first one in all of them. Cost: that of
  /// these columns.
  template <class List>
  void push_changes(const List& row, const std::vector<std::size_t>& columns) {
    if (columns_.empty()) return push_back(row);
    for (const std::size_t k : columns) columns_[k].set(rows_, last_[k] = static_cast<Number>(row[k]));
    ++rows_;
  }
  /// Appends the last row once more; without one a row that may not be read.
  void repeat() { ++rows_; }
  void pop_back() {
    --rows_;
    for (auto& column : columns_) column.drop_from(rows_);
    const bool none_was_set = !columns_.empty() && columns_.front().empty();  // in any: a row sets all of them
    if (none_was_set) columns_.clear();
    find_last();
  }
  /// Leaves these columns, ascending.
  void keep_columns(const std::vector<std::size_t>& columns) {
    std::vector<SteadyColumn<Number>> kept;
    for (const std::size_t column : columns) {
      if (column < columns_.size()) kept.push_back(std::move(columns_[column]));
    }
    columns_ = std::move(kept);
    find_last();
  }
  /// Leaves these rows, ascending.
  void keep(const std::vector<std::size_t>& rows) {
    SteadyTable kept;
    for (const std::size_t row : rows) kept.push_back((*this)[row]);
    *this = std::move(kept);
  }

 private:
  void find_last() {
    last_.resize(columns_.size());
    for (std::size_t k = 0; k < columns_.size(); ++k) last_[k] = columns_[k].back();
  }

  std::size_t rows_ = 0;
  std::vector<SteadyColumn<Number>> columns_;
  std::vector<Number> last_;  ///< what the columns have in the last row
};

/// Holds values that seldom change from one row to the next.
template <class Value>
class SteadyList {
 public:
  SteadyList() = default;
  SteadyList(std::initializer_list<Value> rows) {
    for (const auto& row : rows) push_back(row);
  }
  [[nodiscard]] std::size_t size() const { return rows_; }
  [[nodiscard]] bool empty() const { return rows_ == 0; }
  [[nodiscard]] const Value& operator[](std::size_t row) const { return column_.at(row); }
  [[nodiscard]] const Value& front() const { return column_.at(0); }
  [[nodiscard]] const Value& back() const { return column_.back(); }
  [[nodiscard]] auto begin() const { return NumberedIterator<SteadyList>(*this, 0); }
  [[nodiscard]] auto end() const { return NumberedIterator<SteadyList>(*this, rows_); }
  void push_back(Value value) { column_.set(rows_++, std::move(value)); }
  /// Appends the last value once more; there must be one.
  void repeat() { ++rows_; }
  void pop_back() { column_.drop_from(--rows_); }
  /// Leaves these rows, ascending.
  void keep(const std::vector<std::size_t>& rows) {
    SteadyList kept;
    for (const std::size_t row : rows) kept.push_back((*this)[row]);
    *this = std::move(kept);
  }

 private:
  std::size_t rows_ = 0;
  SteadyColumn<Value> column_;
};

}  // namespace saltus::result
