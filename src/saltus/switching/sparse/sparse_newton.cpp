#include "saltus/switching/sparse/sparse_newton.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/multi_affine.hpp"
#include "saltus/switching/table/newton_steps_internal.hpp"

namespace saltus::switching {

SparseEffects::SparseEffects(const Influence& influence)
    : colour_(selection_colours(influence)), shifted_(influence.size()), here_(influence.size()) {
  for (const int c : colour_) colours_ = std::max(colours_, c + 1);
  const auto m = index(influence.size());
  std::vector<linalg::Triplet> entries;
  for (std::size_t i = 0; i < influence.size(); ++i) {
    entries.push_back({index(i), index(i), 1.0});
    for (const int j : influence[i]) entries.push_back({index(i), j, 1.0});
  }
  matrix_ = linalg::SparseColumns(m, m, entries);
}

void SparseEffects::find(ProjectedField field, double* alpha, const double* g) {
  const auto start = matrix_.start(), rows = matrix_.inner();
  const auto values = matrix_.values();
  std::copy(alpha, alpha + here_.size(), here_.begin());
  for (int c = 0; c < colours_; ++c) {
    for (std::size_t j = 0; j < here_.size(); ++j) {
      if (colour_[j] == c) alpha[j] = difference_end(here_[j], Interpolation::multi_affine);
    }
    field(alpha, shifted_.data());
    for (std::size_t j = 0; j < here_.size(); ++j) {
      if (colour_[j] != c) continue;
      const double width = alpha[j] - here_[j];
      alpha[j] = here_[j];
      for (std::size_t k = at(start[j]); k < at(start[j + 1]); ++k)
        values[k] = (shifted_[at(rows[k])] - g[rows[k]]) / width;
    }
  }
}

SparseNewton::SparseNewton(const Influence& influence)
    : effects_(influence), g_(index(influence.size())), step_(index(influence.size())) {}

bool SparseNewton::solve(ProjectedField g, double* alpha) {
  return follow_root(alpha, {step_.data(), at(step_.size())}, [&] {
    g(alpha, g_.data());
    effects_.find(g, alpha, g_.data());
    if (!g_.all_finite()) return false;
    if (!analysed_) lu_.analyse(effects_.matrix());
    analysed_ = true;
    if (!lu_.factorise(effects_.matrix())) return false;
    std::copy_n(lu_.solve(g_).data(), step_.size(), step_.data());
    return step_.all_finite();
  });
}

}  // namespace saltus::switching
