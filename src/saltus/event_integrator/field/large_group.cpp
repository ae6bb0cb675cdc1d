#include "saltus/event_integrator/field/large_group.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/switching/sparse/attraction.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::event_integrator {
namespace {

using EffectMatrix = linalg::SparseColumns;

/// Rows and columns of `part`, each row in its size.
EffectMatrix part_of(const EffectMatrix& effects, const std::vector<int>& part) {
  std::vector<int> place(at(effects.rows()), -1);
  for (std::size_t k = 0; k < part.size(); ++k) place[at(part[k])] = static_cast<int>(k);
  std::vector<linalg::Triplet> entries;
  linalg::Vector square = linalg::Vector::zero(index(part.size()));
  for (const int column : part) {
    for (const auto [effect_row, value] : effects.along(column)) {
      const int row = place[at(effect_row)];
      if (row < 0) continue;
      entries.push_back({row, place[at(column)], value});
      square[row] += value * value;
    }
  }
  EffectMatrix result(square.size(), square.size(), entries);
  result.scale_rows(square.square_roots().inverses());
  return result;
}

}  // namespace

std::pair<double, double> loss_and_stability(const EffectMatrix& effects, const std::vector<int>& part) {
  const EffectMatrix own = part_of(effects, part);
  const auto m = static_cast<int>(part.size());
  double stability = switching::attraction_margin(switching::comparison_of(own));
  const linalg::SparseLu lu(own);
  if (!lu.is_factorised()) return {0.0, stability};
  // Stable matrices of m rows have det G of the sign (-1)^m.
  const double sign = (m % 2 == 0 ? 1.0 : -1.0) * lu.sign_of_determinant();
  const double loss = sign * std::exp(lu.log_abs_determinant() / m);
  // Beyond these the other conditions cost more than they are worth.
  constexpr int most = 24;
  if (stability <= 0.0 && m <= most) {
    const linalg::Matrix transposed = own.dense().transpose();  // entries row by row
    const std::span<const double> entries(transposed.data(), at(transposed.size()));
    stability = std::max(switching::fisher_fuller_margin(entries, m), switching::hurwitz_margin(entries, m));
  }
  return {loss, stability};
}

/// Groups that Newton's method solves are taken together where one of them is large, or where they are many: each
/// evaluation of the field is for all of them.
void ModeField::find_large_groups() {
  groups_.large.reset();
  if (!affine_in_alpha_ || !kernel_.region_groups().empty()) return;
  constexpr std::size_t many = 4;
  std::vector<std::size_t> rows;
  std::size_t count = 0;
  bool any_large = false;
  for (const auto& group : groups_.lists) {
    if (group.size() < 3) continue;
    rows.insert(rows.end(), group.begin(), group.end());
    any_large = any_large || is_large(group.size());
    ++count;
  }
  if (!any_large && count < many) return;
  std::sort(rows.begin(), rows.end());
  find_parts(rows);
}

/// A group whose surfaces are decided by parts: events of surfaces that depend on nobody later are those of single
/// ones.
void ModeField::find_parts(const std::vector<std::size_t>& group) {
  switching::Influence influence(group.size());
  std::vector<int> place(sliding_.size(), -1);
  for (std::size_t k = 0; k < group.size(); ++k) place[group[k]] = static_cast<int>(k);
  for (std::size_t k = 0; k < group.size(); ++k) {
    const int i = sliding_[group[k]];
    for (const int j : kernel_.neighbours(i)) {
      const int row = groups_.row_of[at(j)];
      if (row >= 0 && kernel_.depends(i, j)) influence[k].push_back(place[at(row)]);
    }
    std::sort(influence[k].begin(), influence[k].end());
  }
  LargeGroup large{group, switching::ordered_parts(influence), std::make_unique<switching::SparseNewton>(influence)};
  for (const auto& part : large.parts) {
    for (const int k : part) groups_.size[group[at(k)]] = 0;
    groups_.size[group[at(part.front())]] = part.size();
  }
  groups_.large = std::move(large);
}

}  // namespace saltus::event_integrator
