#include "saltus/switching/point/nonnegative_solution.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;

/// Columns that are independent of each other but for this are not taken together.
constexpr double dependent = 1e-10;

/// The unknowns that are free, and their values.
class FreeUnknowns {
 public:
  FreeUnknowns(const linalg::Matrix& A, const linalg::Vector& b) : A_(A), b_(b), x_(linalg::Vector::zero(A.cols())) {}

  [[nodiscard]] const linalg::Vector& x() const { return x_; }
  [[nodiscard]] bool is_free(int j) const { return contains(free_, j); }

  /// Frees one, and binds those that come to 0 on the way to the least residual; false if that is no way.
  [[nodiscard]] bool add(int j) {
    free_.push_back(j);
    while (!free_.empty()) {
      const linalg::Matrix columns = A_.selected_cols(free_);
      linalg::PivotedQr factors(columns);
      factors.set_threshold(dependent);
      if (factors.rank() < columns.cols()) return leave(j);
      const linalg::Vector wanted = factors.solve(b_);
      if (x_[j] == 0.0 && free_.back() == j && !(wanted[wanted.size() - 1] > 0.0)) return leave(j);
      if (go_towards(wanted)) return true;
    }
    return true;
  }

 private:
  bool leave(int j) {
    std::erase(free_, j);
    return false;
  }
  /// @return true if it got there
  bool go_towards(const linalg::Vector& wanted) {
    double part = 1.0;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const double from = x_[free_[k]], to = wanted[index(k)];
      if (to <= 0.0) part = std::min(part, from / (from - to));
    }
    std::vector<int> still_free;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      double& value = x_[free_[k]];
      const double from = value, to = wanted[index(k)];
      const bool ends = to <= 0.0 && from / (from - to) <= part;
      value = ends ? 0.0 : from + part * (to - from);
      if (!ends) still_free.push_back(free_[k]);
    }
    const bool arrived = still_free.size() == free_.size();
    free_ = std::move(still_free);
    return arrived;
  }

  const linalg::Matrix& A_;
  const linalg::Vector& b_;
  linalg::Vector x_;
  std::vector<int> free_;
};

}  // namespace

linalg::Vector nonnegative_solution(const linalg::Matrix& A, const linalg::Vector& b) {
  std::vector<int> order(at(A.cols()));
  std::iota(order.begin(), order.end(), 0);
  const linalg::Vector lengths = A.col_norms();
  // Equal but for roundings: in the order of their numbers.
  constexpr double equal = 1e-9;
  const double unit = equal * lengths.max();
  std::stable_sort(order.begin(), order.end(),
                   [&](int i, int j) { return std::round(lengths[i] / unit) < std::round(lengths[j] / unit); });
  FreeUnknowns unknowns(A, b);
  const Index most_steps = 3 * A.cols();
  for (Index step = 0; step < most_steps; ++step) {
    const linalg::Vector residual = b - A * unknowns.x();
    const bool found = std::any_of(order.begin(), order.end(), [&](int j) {
      const bool decreases = A.col(j).dot(residual) > dependent * lengths[j] * b.norm();
      return decreases && !unknowns.is_free(j) && unknowns.add(j);
    });
    if (!found) break;
  }
  return unknowns.x();
}

}  // namespace saltus::switching
