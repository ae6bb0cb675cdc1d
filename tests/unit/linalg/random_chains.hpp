// Matrices of optimality conditions of problems in a chain, at random.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "saltus/linalg/block_ldl.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

/// Entries of the lower triangle, in no order, and the block of each row.
struct ChainMatrix {
  int size = 0;
  std::vector<int> rows, columns, block;
  std::vector<double> values;

  void add(int i, int j, double value) {
    rows.push_back(std::max(i, j));
    columns.push_back(std::min(i, j));
    values.push_back(value);
  }
  [[nodiscard]] Matrix dense() const {
    Matrix a = Matrix::zero(size, size);
    for (std::size_t e = 0; e < values.size(); ++e) {
      a(rows[e], columns[e]) += values[e];
      if (rows[e] != columns[e]) a(columns[e], rows[e]) += values[e];
    }
    return a;
  }
  /// right - A x.
  [[nodiscard]] std::vector<double> residual(const std::vector<double>& right, const std::vector<double>& x) const {
    auto left = right;
    for (std::size_t e = 0; e < values.size(); ++e) {
      const auto i = static_cast<std::size_t>(rows[e]), j = static_cast<std::size_t>(columns[e]);
      left[i] -= values[e] * x[j];
      if (i != j) left[j] -= values[e] * x[i];
    }
    return left;
  }
};

struct ChainShape {
  int elements = 6;
  int variables = 5, equations = 3, inequalities = 1;  ///< of each element
  int border = 2;                                      ///< variables that all elements share
  int terminal = 2;                                    ///< equations of variables of the last element alone
  double delta_c = 0.0;
  double decades = 8.0;  ///< of barrier terms, above 1 and below
};

/// Writes the matrix of a shape: barrier terms of many sizes on the diagonal, equations that link each element with
/// the one before, inequalities with slacks. Elements are eliminated from the last to the first, the border at last.
class ChainWriter {
 public:
  ChainWriter(std::mt19937& random, ChainShape shape) : random_(random), shape_(shape) {}

  [[nodiscard]] ChainMatrix run() {
    for (int i = 0; i < shape_.border; ++i) border_.push_back(variable(shape_.elements));
    for (int k = 0; k < shape_.elements; ++k) {
      before_ = std::move(own_);
      own_.clear();
      for (int i = 0; i < shape_.variables; ++i) own_.push_back(variable(block_of(k)));
      for (std::size_t i = 1; i < own_.size(); ++i) matrix_.add(own_[i], own_[i - 1], 0.3 * unit_(random_));
      for (const int j : border_) matrix_.add(own_[0], j, 0.3 * unit_(random_));
      for (int i = 0; i < shape_.equations; ++i) static_cast<void>(equation(k, true));
      for (int i = 0; i < shape_.inequalities; ++i) {
        const int slack = variable(block_of(k));
        matrix_.add(equation(k, false), slack, -1.0);
      }
    }
    for (int i = 0; i < shape_.terminal; ++i) static_cast<void>(equation(shape_.elements - 1, false));
    return std::move(matrix_);
  }

 private:
  [[nodiscard]] int block_of(int element) const { return shape_.elements - 1 - element; }
  int row(int block) {
    matrix_.block.push_back(block);
    return matrix_.size++;
  }
  int variable(int block) {
    const int i = row(block);
    matrix_.add(i, i, 0.01 * unit_(random_));
    // Some have a barrier term of any size.
    if (unit_(random_) > 0.0) matrix_.add(i, i, std::pow(10.0, shape_.decades * unit_(random_)));
    return i;
  }
  int equation(int element, bool links) {
    const int i = row(block_of(element));
    for (const int j : own_) matrix_.add(i, j, unit_(random_));
    for (const int j : border_) matrix_.add(i, j, 0.5 * unit_(random_));
    for (std::size_t j = 0; links && j < before_.size(); j += 2) matrix_.add(i, before_[j], unit_(random_));
    if (shape_.delta_c > 0.0) matrix_.add(i, i, -shape_.delta_c);
    return i;
  }

  std::mt19937& random_;
  ChainShape shape_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  ChainMatrix matrix_;
  std::vector<int> own_, before_, border_;
};

}  // namespace saltus::linalg
