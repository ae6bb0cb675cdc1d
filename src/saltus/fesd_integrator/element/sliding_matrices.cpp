#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "saltus/fesd_integrator/element/sliding_matrices_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Index;
using EntryList = std::vector<std::pair<std::size_t, double>>;

/// Vectors of entries, one after the other.
struct Compressed {
  std::vector<int> start{0}, inner;
  std::vector<double> values;

  /// Appends the sum of all entries at each place as one more vector.
  void append(EntryList& entries) {
    const auto is_before = [](const auto& a, const auto& b) { return a.first < b.first; };
    if (!std::is_sorted(entries.begin(), entries.end(), is_before)) {  // of two regions
      std::stable_sort(entries.begin(), entries.end(), is_before);
    }
    std::size_t last = static_cast<std::size_t>(-1);
    for (const auto& [place, value] : entries) {
      if (place == last) {
        values.back() += value;
      } else {
        inner.push_back(static_cast<int>(place));
        values.push_back(value);
      }
      last = place;
    }
    start.push_back(static_cast<int>(inner.size()));
    entries.clear();
  }
};

}  // namespace

SparseColumns sliding_directions(const ActiveSet& set, const discretization::StageValues& at) {
  const auto& sliding = set.sliding();
  Compressed columns;
  EntryList entries;
  const auto collect = [&](int selection, double factor) {
    if (selection < 0) return;
    discretization::visit_column(at.pattern->f_selection, at.f_selection, static_cast<std::size_t>(selection),
                                 [&](std::size_t i, double value) { entries.emplace_back(i, factor * value); });
  };
  for (std::size_t k = 0; k < sliding.size(); ++k) {
    collect(sliding[k].selection, 1.0);
    collect(sliding[k].reference, -1.0);
    columns.append(entries);
  }
  return {static_cast<Index>(at.f.size()), static_cast<Index>(sliding.size()), std::move(columns.start),
          std::move(columns.inner), std::move(columns.values)};
}

SparseRows sliding_surfaces(const ActiveSet& set, const discretization::StageValues& at) {
  const auto& sliding = set.sliding();
  Compressed rows;
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
    rows.append(entries);
  }
  return {static_cast<Index>(sliding.size()), static_cast<Index>(at.f.size()), std::move(rows.start),
          std::move(rows.inner), std::move(rows.values)};
}

linalg::SparseView<linalg::Major::columns> field_by_state(const discretization::StageValues& at) {
  const auto& pattern = at.pattern->f_x;
  return {pattern.rows, pattern.columns, pattern.start, pattern.row, at.f_x};
}

}  // namespace saltus::fesd_integrator
