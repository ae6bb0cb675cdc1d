#include "saltus/switching/point/pivoting.hpp"

#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// The table y - W z - d z_0 = w, of which n unknowns are basic. Unknowns: y, z, z_0.
class Table {
 public:
  Table(const Matrix& effects, const Vector& constant)
      : n_(constant.size()), table_(Matrix::zero(n_, 2 * n_ + 2)), basis_(at(n_)) {
    for (Index i = 0; i < n_; ++i) {
      table_(i, i) = 1.0;
      for (Index k = 0; k < n_; ++k) table_(i, n_ + k) = -effects(i, k);
      table_(i, artificial()) = -1.0;
      table_(i, right()) = constant[i];
      basis_[at(i)] = i;
    }
    size_ = constant.max_abs();
  }

  [[nodiscard]] Index artificial() const { return 2 * n_; }
  [[nodiscard]] Index right() const { return 2 * n_ + 1; }
  [[nodiscard]] Index basic(Index row) const { return basis_[at(row)]; }
  [[nodiscard]] double value(Index row) const { return table_(row, right()); }
  [[nodiscard]] Index complement(Index unknown) const { return unknown < n_ ? unknown + n_ : unknown - n_; }

  /// Brings z_0 in, in the place of what is most negative; false where nothing is.
  [[nodiscard]] bool start(Index& left) {
    Index row = -1;
    constexpr double rounding = 1e-14;
    double least = -rounding * size_;
    for (Index i = 0; i < n_; ++i) {
      if (value(i) < least) least = value(row = i);
    }
    if (row < 0) return false;
    left = basic(row);
    exchange(row, artificial());
    return true;
  }

  /// The row that leaves as an unknown comes in; -1 on a ray. z_0 leaves where it can.
  [[nodiscard]] Index leaving(Index entering) const {
    constexpr double none = 1e-11;
    double largest = 0.0;
    for (Index i = 0; i < n_; ++i) largest = std::max(largest, std::abs(table_(i, entering)));
    Index best = -1;
    for (Index i = 0; i < n_; ++i) {
      if (!(table_(i, entering) > none * largest)) continue;
      if (best < 0 || comes_before(i, best, entering)) best = i;
    }
    return best;
  }

  void exchange(Index row, Index entering) {
    auto own = table_.row(row);
    own /= double{table_(row, entering)};
    for (Index i = 0; i < n_; ++i) {
      const double factor = table_(i, entering);
      if (i == row || factor == 0.0) continue;
      table_.row(i).add_scaled(-factor, own);
      table_(i, entering) = 0.0;
    }
    basis_[at(row)] = entering;
  }

 private:
  /// By the ratios of values, those of equal ones by the columns of y: no basis comes twice.
  [[nodiscard]] bool comes_before(Index i, Index k, Index entering) const {
    constexpr double same = 1e-12;
    const double own = table_(i, entering), other = table_(k, entering);
    const double difference = value(i) / own - value(k) / other;
    const double unit = size_ * std::max(1.0 / own, 1.0 / other);
    if (std::abs(difference) > same * unit) return difference < 0.0;
    if (basic(i) == artificial() || basic(k) == artificial()) return basic(i) == artificial();
    for (Index c = 0; c < n_; ++c) {
      const double a = table_(i, c) / own, b = table_(k, c) / other;
      if (std::abs(a - b) > same * (std::abs(a) + std::abs(b))) return a < b;
    }
    return own > other;
  }

  Index n_;
  Matrix table_;
  std::vector<Index> basis_;
  double size_ = 0.0;
};

}  // namespace

std::optional<Vector> complementary_pivots(const Matrix& effects, const Vector& constant, std::vector<bool>* basic) {
  const Index n = constant.size();
  Table table(effects, constant);
  Index left = -1;
  if (table.start(left)) {
    const Index most_pivots = 50 * (n + 10);
    for (Index pivot = 0; left != table.artificial(); ++pivot) {
      const Index entering = table.complement(left);
      const Index row = table.leaving(entering);
      if (row < 0 || pivot == most_pivots) return std::nullopt;
      left = table.basic(row);
      table.exchange(row, entering);
    }
  }
  Vector z = Vector::zero(n);
  if (basic != nullptr) basic->assign(at(n), false);
  for (Index row = 0; row < n; ++row) {
    const Index unknown = table.basic(row) - n;
    if (unknown < 0 || unknown >= n) continue;
    z[unknown] = std::max(0.0, table.value(row));
    if (basic != nullptr) (*basic)[at(unknown)] = true;
  }
  return z.all_finite() ? std::optional(std::move(z)) : std::nullopt;
}

}  // namespace saltus::switching
