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

void NormalRows::copy(std::size_t row, const SparseRow& entries, double size) {
  components_known_ = components_known_ && rows_[row] == &own_[row] && own_[row].column == entries.column;
  own_[row] = entries;
  rows_[row] = &own_[row];
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
      auto& component = together_.emplace_back(Component{std::move(rows)});
      if (component.rows.size() >= sparse_from) find_pattern(component);
    }
  }
  components_known_ = true;
}

/// Rows that share a column have a product.
void NormalRows::find_pattern(Component& component) const {
  std::vector<std::vector<int>> of_column(columns_);
  const auto n = component.rows.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (const std::size_t column : rows_[component.rows[i]]->column) of_column[column].push_back(static_cast<int>(i));
  }
  std::vector<int> beside;
  component.start.assign(1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    beside.clear();
    for (const std::size_t column : rows_[component.rows[i]]->column) {
      beside.insert(beside.end(), of_column[column].begin(), of_column[column].end());
    }
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    component.inner.insert(component.inner.end(), beside.begin(), beside.end());
    component.start.push_back(static_cast<int>(component.inner.size()));
  }
  component.values.resize(component.inner.size());
  component.size.resize(n);
  component.factors.analyse(component.start, component.inner);
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
                     [&](auto& component) { return solve_component(component, residual); });
}

bool NormalRows::solve_component(Component& component, linalg::Vector& residual) {
  const auto n = component.rows.size();
  part_.resize(static_cast<linalg::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    part_[static_cast<linalg::Index>(i)] = residual[static_cast<linalg::Index>(component.rows[i])];
  }
  if (!(component.start.empty() ? solve_dense(component.rows) : solve_sparse(component))) return false;
  for (std::size_t i = 0; i < n; ++i) {
    residual[static_cast<linalg::Index>(component.rows[i])] = part_[static_cast<linalg::Index>(i)];
  }
  return true;
}

bool NormalRows::solve_dense(const std::vector<std::size_t>& rows) {
  const auto n = static_cast<linalg::Index>(rows.size());
  matrix_.resize(n, n);
  for (linalg::Index i = 0; i < n; ++i) {
    for (linalg::Index j = 0; j <= i; ++j) {
      matrix_(i, j) = product(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
    }
  }
  cholesky_.compute(matrix_);
  if (!cholesky_.is_positive()) return false;
  cholesky_.solve_in_place(part_);
  return true;
}

bool NormalRows::solve_sparse(Component& component) {
  constexpr double rounding = 1e-14;  // of a pivot that is none
  for (std::size_t j = 0; j < component.rows.size(); ++j) {
    for (int k = component.start[j]; k < component.start[j + 1]; ++k) {
      const auto place = static_cast<std::size_t>(k);
      component.values[place] =
          product(component.rows[static_cast<std::size_t>(component.inner[place])], component.rows[j]);
    }
    component.size[j] = size_[component.rows[j]] * size_[component.rows[j]];
  }
  if (!component.factors.factorise(component.values)) return false;
  if (component.factors.has_small_pivot(component.size, rounding)) return false;
  right_.assign(part_.data(), part_.data() + part_.size());
  component.factors.solve(right_, {part_.data(), right_.size()});
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
    for (const std::size_t row : component.rows) add(row);
    // A column of several rows is taken with the first of them: nothing is left for the others.
    for (const std::size_t row : component.rows) {
      for (const std::size_t column : rows_[row]->column) take(column);
    }
  }
  return changed;
}

bool NormalRows::correct(linalg::Vector& residual, double* x) {
  return solve(residual) && residual.all_finite() && subtract_transposed(residual, x);
}

}  // namespace saltus::event_integrator
