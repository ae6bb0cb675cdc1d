#include "saltus/event_integrator/sliding/normal_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace saltus::event_integrator {
namespace {

constexpr std::size_t no_row = std::numeric_limits<std::size_t>::max();

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t row) {
  while (parent[row] != row) {
    parent[row] = parent[parent[row]];
    row = parent[row];
  }
  return row;
}

}  // namespace

void NormalRows::resize(std::size_t rows, std::size_t columns) {
  columns_ = columns;
  rows_.resize(rows);
  for (auto& row : rows_) {
    row.column.clear();
    row.value.clear();
  }
  components_known_ = false;
}

void NormalRows::set(std::size_t row, const SparseRow& entries) {
  components_known_ = components_known_ && rows_[row].column == entries.column;
  rows_[row] = entries;
}

void NormalRows::set(std::size_t row, const std::vector<double>& dense) {
  auto& [column, value] = rows_[row];
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
  components_known_ = components_known_ && same;
}

void NormalRows::find_components() {
  parent_.resize(rows_.size());
  std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  first_of_column_.assign(columns_, no_row);
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (const std::size_t column : rows_[row].column) {
      auto& first = first_of_column_[column];
      if (first == no_row) {
        first = row;
        continue;
      }
      const std::size_t a = root_of(parent_, first), b = root_of(parent_, row);
      parent_[std::max(a, b)] = std::min(a, b);
    }
  }
  // The root of a component is its first row.
  std::vector<std::vector<std::size_t>> components(rows_.size());
  for (std::size_t row = 0; row < rows_.size(); ++row) components[root_of(parent_, row)].push_back(row);
  alone_.clear();
  together_.clear();
  for (auto& component : components) {
    if (component.size() == 1) alone_.push_back(component.front());
    if (component.size() > 1) together_.push_back(std::move(component));
  }
  components_known_ = true;
}

bool NormalRows::solve(Eigen::VectorXd& residual) {
  if (!components_known_) find_components();
  for (const std::size_t row : alone_) {
    // As a Cholesky factorisation does it.
    const double size = std::sqrt(product(row, row));
    if (!(size > 0.0)) return false;
    auto& r = residual[static_cast<Eigen::Index>(row)];
    r = r / size / size;
  }
  return std::all_of(together_.begin(), together_.end(),
                     [&](const auto& rows) { return solve_component(rows, residual); });
}

bool NormalRows::solve_component(const std::vector<std::size_t>& rows, Eigen::VectorXd& residual) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  matrix_.resize(n, n);
  part_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    part_[i] = residual[static_cast<Eigen::Index>(rows[static_cast<std::size_t>(i)])];
    for (Eigen::Index j = 0; j <= i; ++j) {
      matrix_(i, j) = product(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
    }
  }
  cholesky_.compute(matrix_);
  if (cholesky_.info() != Eigen::Success) return false;
  cholesky_.solveInPlace(part_);
  for (Eigen::Index i = 0; i < n; ++i) {
    residual[static_cast<Eigen::Index>(rows[static_cast<std::size_t>(i)])] = part_[i];
  }
  return true;
}

double NormalRows::product(std::size_t a, std::size_t b) const {
  const auto& left = rows_[a];
  const auto& right = rows_[b];
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

void NormalRows::transposed_times(const Eigen::VectorXd& z, std::vector<double>& sum) const {
  sum.assign(columns_, 0.0);
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const double factor = z[static_cast<Eigen::Index>(row)];
    for (std::size_t k = 0; k < rows_[row].column.size(); ++k)
      sum[rows_[row].column[k]] += rows_[row].value[k] * factor;
  }
}

}  // namespace saltus::event_integrator
