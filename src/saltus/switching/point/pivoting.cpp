#include "saltus/switching/point/pivoting.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "saltus/base/at.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// The table y - W z - d z_0 = w, solved for n basic unknowns: in each row what the others and w make of one. Its rows
/// are columns in memory. Unknowns: y, z, z_0.
///
/// Where w has zeros, or bodies are alike, ratios are equal. A shift of w tells them apart, another one in each row:
/// above the rounding of the table, so that no basis comes twice, and no part of the values. What is found holds to its
/// size.
class Table {
 public:
  /// @param shift_size  relative to w
  Table(const Matrix& effects, const Vector& constant, double shift_size)
      : n_(constant.size()), table_(n_ + 3, n_), places_(at(2 * n_ + 1)), basis_(at(n_)) {
    for (Index i = 0; i < n_; ++i) {
      for (Index k = 0; k < n_; ++k) entry(i, k) = -effects(i, k);
      entry(i, n_) = -1.0;
      entry(i, right()) = constant[i];
      entry(i, shift()) = 1.0 + std::fmod(golden * static_cast<double>(i), 1.0);
    }
    for (Index unknown = 0; unknown <= artificial(); ++unknown) {
      places_[at(unknown)] = unknown < n_ ? unknown : unknown - n_;
    }
    std::iota(basis_.begin(), basis_.end(), Index{0});
    size_ = constant.max_abs();
    shift_ = shift_size * size_;
  }

  [[nodiscard]] Index artificial() const { return 2 * n_; }
  [[nodiscard]] Index basic(Index row) const { return basis_[at(row)]; }
  [[nodiscard]] double value(Index row) const { return entry(row, right()); }
  [[nodiscard]] Index complement(Index unknown) const { return unknown < n_ ? unknown + n_ : unknown - n_; }

  /// Brings z_0 in, in the place of what is most negative; false where nothing is.
  [[nodiscard]] bool start(Index& left) {
    Index row = -1;
    constexpr double rounding = 1e-14;
    for (Index i = 0; i < n_; ++i) {
      if (value(i) < -rounding * size_ && (row < 0 || shifted(i) < shifted(row))) row = i;
    }
    if (row < 0) return false;
    left = basic(row);
    exchange(row, artificial());
    return true;
  }

  /// The row that leaves as an unknown comes in; -1 on a ray.
  [[nodiscard]] Index leaving(Index entering) const {
    constexpr double none = 1e-11;
    const Index column = places_[at(entering)];
    double largest = 0.0;
    for (Index i = 0; i < n_; ++i) largest = std::max(largest, std::abs(entry(i, column)));
    Index best = -1;
    for (Index i = 0; i < n_; ++i) {
      if (!(entry(i, column) > none * largest)) continue;
      if (best < 0 || shifted(i) * entry(best, column) < shifted(best) * entry(i, column)) best = i;
    }
    return best;
  }

  void exchange(Index row, Index entering) {
    const Index column = places_[at(entering)];
    auto own = table_.col(row);
    const double pivot = entry(row, column);
    entry(row, column) = 1.0;
    own /= pivot;
    for (Index i = 0; i < n_; ++i) {
      const double factor = entry(i, column);
      if (i == row || factor == 0.0) continue;
      entry(i, column) = 0.0;
      table_.col(i).add_scaled(-factor, own);
    }
    std::swap(places_[at(basic(row))], places_[at(entering)]);
    basis_[at(row)] = entering;
  }

 private:
  static constexpr double golden = 0.6180339887498949;

  [[nodiscard]] Index right() const { return n_ + 1; }
  [[nodiscard]] Index shift() const { return n_ + 2; }
  [[nodiscard]] double& entry(Index row, Index column) { return table_(column, row); }
  [[nodiscard]] double entry(Index row, Index column) const { return table_(column, row); }
  [[nodiscard]] double shifted(Index row) const { return value(row) + shift_ * entry(row, shift()); }

  Index n_;
  Matrix table_;
  std::vector<Index> places_;  ///< of every unknown: its row if it is basic, its column if it is not
  std::vector<Index> basis_;   ///< by row
  double size_ = 0.0, shift_ = 0.0;
};

std::optional<Vector> pivots_of(Table table, std::vector<bool>* basic) {
  const Index n = table.artificial() / 2;
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

}  // namespace

std::optional<Vector> complementary_pivots(const Matrix& effects, const Vector& constant, std::vector<bool>* basic) {
  // The larger one where the smaller one does not tell apart what the rounding of this table mixes.
  constexpr double small = 1e-12, large = 1e-9;
  auto z = pivots_of(Table(effects, constant, small), basic);
  return z ? z : pivots_of(Table(effects, constant, large), basic);
}

}  // namespace saltus::switching
