#include "saltus/event_integrator/sliding/normal_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/components.hpp"

namespace saltus::event_integrator {
namespace {

constexpr std::size_t no_row = std::numeric_limits<std::size_t>::max();

}  // namespace

void NormalRows::resize(std::size_t rows, std::size_t columns) {
  columns_ = columns;
  if (own_.size() < rows) own_.resize(rows);
  rows_.resize(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    own_[row].column.clear();
    own_[row].value.clear();
    rows_[row] = &own_[row];
  }
  size_.assign(rows, 0.0);
  sum_.resize(columns, 0.0);
  components_known_ = false;
}

void NormalRows::set(std::size_t row, const SparseRow& entries, double size) {
  components_known_ = components_known_ && rows_[row]->column == entries.column;
  rows_[row] = &entries;
  size_[row] = size;
}

void NormalRows::set(std::size_t row, const std::vector<double>& dense) {
  auto& [column, value] = own_[row];
  // Where the columns are those of before, which they mostly are, so are the components.
  bool same = true;
  std::size_t count = 0;
  value.clear();
  for (std::size_t i = 0; i < dense.size(); ++i) {
    if (dense[i] == 0.0) continue;
    value.push_back(dense[i]);
    if (count < column.size()) {
      same = same && column[count] == i;
      column[count] = i;
    } else {
      same = false;
      column.push_back(i);
    }
    ++count;
  }
  same = same && count == column.size();
  column.resize(count);
  components_known_ = components_known_ && same && rows_[row] == &own_[row];
  rows_[row] = &own_[row];
  double square = 0.0;
  for (const double entry : value) square += entry * entry;
  size_[row] = std::sqrt(square);
}

void NormalRows::find_components() {
  Components components(rows_.size());
  first_of_column_.assign(columns_, no_row);
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (const std::size_t column : rows_[row]->column) {
      auto& first = first_of_column_[column];
      if (first == no_row) first = row;
      components.join(first, row);
    }
  }
  alone_.clear();
  together_.clear();
  for (auto& rows : components.lists()) {
    if (rows.size() == 1) {
      alone_.push_back(rows.front());
    } else {
      together_.push_back(std::move(rows));
    }
  }
  components_known_ = true;
}

bool NormalRows::solve(linalg::Vector& residual) {
  if (!components_known_) find_components();
  for (const std::size_t row : alone_) {
    // As a Cholesky factorisation does it.
    const double size = size_[row];
    if (!(size > 0.0)) return false;
    auto& r = residual[static_cast<linalg::Index>(row)];
    r = r / size / size;
  }
  return std::all_of(together_.begin(), together_.end(),
                     [&](const auto& rows) { return solve_component(rows, residual); });
}

bool NormalRows::solve_component(const std::vector<std::size_t>& rows, linalg::Vector& residual) {
  const auto n = static_cast<linalg::Index>(rows.size());
  matrix_.resize(n, n);
  part_.resize(n);
  for (linalg::Index i = 0; i < n; ++i) {
    part_[i] = residual[static_cast<linalg::Index>(rows[static_cast<std::size_t>(i)])];
    for (linalg::Index j = 0; j <= i; ++j) {
      matrix_(i, j) = product(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
    }
  }
  cholesky_.compute(matrix_);
  if (!cholesky_.is_positive()) return false;
  cholesky_.solve_in_place(part_);
  for (linalg::Index i = 0; i < n; ++i) {
    residual[static_cast<linalg::Index>(rows[static_cast<std::size_t>(i)])] = part_[i];
  }
  return true;
}

double NormalRows::product(std::size_t a, std::size_t b) const {
  const auto& left = *rows_[a];
  const auto& right = *rows_[b];
  double sum = 0.0;
  for (std::size_t i = 0, k = 0; i < left.column.size() && k < right.column.size();) {
    if (left.column[i] == right.column[k]) {
      sum += left.value[i++] * right.value[k++];
    } else if (left.column[i] < right.column[k]) {
      ++i;
    } else {
      ++k;
    }
  }
  return sum;
}

bool NormalRows::subtract_transposed(const linalg::Vector& z, double* x) {
  if (!components_known_) find_components();
  bool changed = false;
  const auto take = [&](std::size_t column) {
    const double before = x[column];
    x[column] -= std::exchange(sum_[column], 0.0);
    changed = changed || x[column] != before;
  };
  const auto add = [&](std::size_t row) {
    const double factor = z[static_cast<linalg::Index>(row)];
    const auto& [column, value] = *rows_[row];
    for (std::size_t k = 0; k < column.size(); ++k) sum_[column[k]] += value[k] * factor;
  };
  for (const std::size_t row : alone_) {
    add(row);
    for (const std::size_t column : rows_[row]->column) take(column);
  }
  for (const auto& component : together_) {
    for (const std::size_t row : component) add(row);
    // A column of several rows is taken with the first of them: nothing is left for the others.
    for (const std::size_t row : component) {
      for (const std::size_t column : rows_[row]->column) take(column);
    }
  }
  return changed;
}

}  // namespace saltus::event_integrator
