#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "saltus/fesd_integrator/element/sliding_matrices_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

using Eigen::Index;
using EntryList = std::vector<std::pair<std::size_t, double>>;

/// Appends the sum of all entries at each place as vector k of a matrix.
template <class Matrix>
void append(std::size_t k, EntryList& entries, Matrix& matrix) {
  const auto is_before = [](const auto& a, const auto& b) { return a.first < b.first; };
  if (!std::is_sorted(entries.begin(), entries.end(), is_before)) {  // of two regions
    std::stable_sort(entries.begin(), entries.end(), is_before);
  }
  const auto outer = static_cast<Index>(k);
  matrix.startVec(outer);
  std::size_t last = static_cast<std::size_t>(-1);
  for (const auto& [place, value] : entries) {
    if (place == last) {
      matrix.data().value(matrix.data().size() - 1) += value;
    } else {
      matrix.insertBackByOuterInner(outer, static_cast<Index>(place)) = value;
    }
    last = place;
  }
  entries.clear();
}

}  // namespace

SparseColumns sliding_directions(const ActiveSet& set, const discretization::StageValues& at) {
  const auto& sliding = set.sliding();
  SparseColumns directions(static_cast<Index>(at.f.size()), static_cast<Index>(sliding.size()));
  EntryList entries;
  const auto collect = [&](int selection, double factor) {
    if (selection < 0) return;
    discretization::visit_column(at.pattern->f_selection, at.f_selection, static_cast<std::size_t>(selection),
                                 [&](std::size_t i, double value) { entries.emplace_back(i, factor * value); });
  };
  for (std::size_t k = 0; k < sliding.size(); ++k) {
    collect(sliding[k].selection, 1.0);
    collect(sliding[k].reference, -1.0);
    append(k, entries, directions);
  }
  directions.finalize();
  return directions;
}

SparseRows sliding_surfaces(const ActiveSet& set, const discretization::StageValues& at) {
  const auto& sliding = set.sliding();
  SparseRows surfaces(static_cast<Index>(sliding.size()), static_cast<Index>(at.f.size()));
  EntryList entries;
  const auto collect = [&](int selection, double factor) {
    if (selection < 0) return;
    discretization::visit_row(at.pattern->indicator_x, at.indicator_x, static_cast<std::size_t>(selection),
                              [&](std::size_t i, double value) { entries.emplace_back(i, factor * value); });
  };
  for (std::size_t k = 0; k < sliding.size(); ++k) {
    const Surface& surface = sliding[k].surface;
    collect(surface.indicator, surface.reference < 0 ? 1.0 : -1.0);
    collect(surface.reference, 1.0);
    append(k, entries, surfaces);
  }
  surfaces.finalize();
  return surfaces;
}

Eigen::Map<const SparseColumns> field_by_state(const discretization::StageValues& at) {
  const auto& pattern = at.pattern->f_x;
  return {pattern.rows,         pattern.columns,    static_cast<Index>(pattern.size()),
          pattern.start.data(), pattern.row.data(), at.f_x.data()};
}

}  // namespace saltus::fesd_integrator
