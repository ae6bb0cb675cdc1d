// Sliding on several surfaces: selections group by group, as far as they influence each other.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/switching/plane/bilinear_root.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::event_integrator {
namespace {

/// Which of both roots a mode slides on, from the fields where it begins: the one whose selections it has; where these
/// say nothing (a forced mode) the one with det G > 0 if it is in the square, else the other one if that is.
switching::RootKind kind_of_mode(const switching::PairCorners& g, double alpha_1, double alpha_2) {
  using switching::RootKind;
  const auto rising = switching::bilinear_root(g, RootKind::rising);
  const auto falling = switching::bilinear_root(g, RootKind::falling);
  const auto has = [&](const switching::BilinearRoot& root) {
    return std::abs(root.alpha[0] - alpha_1) < same_selection && std::abs(root.alpha[1] - alpha_2) < same_selection;
  };
  const auto inside = [](const switching::BilinearRoot& root) {
    return std::min(root.alpha[0], root.alpha[1]) >= 0.0 && std::max(root.from_one[0], root.from_one[1]) <= 0.0;
  };
  if (has(rising) || (inside(rising) && !has(falling))) return RootKind::rising;
  return inside(falling) || has(falling) ? RootKind::falling : RootKind::rising;
}

}  // namespace

/// Groups of sliding surfaces that influence each other, and from them the way to solve.
void ModeField::find_groups() {
  const auto m = sliding_.size();
  groups_.lists.clear();
  groups_.alone.clear();
  groups_.size.assign(m, 0);
  groups_.condition.assign(m, 1.0);
  groups_.placed.assign(m, false);
  for (std::size_t row = 0; row < m; ++row) groups_.row_of[at(sliding_[row])] = static_cast<int>(row);
  for (std::size_t first = 0; first < m; ++first) {
    if (groups_.placed[first]) continue;
    if (is_alone(first)) {
      groups_.size[first] = 1;
      groups_.alone.push_back(first);
    } else {
      groups_.lists.push_back(group_around(first));
      groups_.size[first] = groups_.lists.back().size();
    }
  }
  find_large_groups();
  for (const int j : sliding_) groups_.row_of[at(j)] = -1;
  solve_ = !affine_in_alpha_       ? SlidingSolve::nonaffine
           : groups_.lists.empty() ? SlidingSolve::decoupled
                                   : SlidingSolve::coupled;
  find_moved();
  if (groups_.lists.empty()) return;
  groups_.speed.assign(m, not_a_number);
  groups_.kind.assign(m, std::nullopt);
  groups_.newton.assign(m, std::nullopt);
  groups_.selections.resize(m);
  for (const auto& group : groups_.lists) {
    if (!is_in_large(group[0]) && (group.size() > 2 || several_regions(group[0])))
      groups_.newton[group[0]].emplace(static_cast<int>(group.size()));
  }
}

/// Whether no other sliding surface is connected with that of a row.
bool ModeField::is_alone(std::size_t row) const {
  const int i = sliding_[row];
  const auto& neighbours = kernel_.neighbours(i);
  const auto slides = [&](int j) { return groups_.row_of[at(j)] >= 0; };
  if (std::any_of(neighbours.begin(), neighbours.end(), slides)) return false;
  return kernel_.region_groups().empty() ||
         std::none_of(sliding_.begin(), sliding_.end(), [&](int j) { return j != i && same_group(kernel_, i, j); });
}

/// The rows that a row is connected with, ascending.
std::vector<std::size_t> ModeField::group_around(std::size_t row) {
  std::vector<std::size_t> group{row};
  groups_.placed[row] = true;
  const auto place = [&](std::size_t other) {
    if (groups_.placed[other]) return;
    group.push_back(other);
    groups_.placed[other] = true;
  };
  for (std::size_t k = 0; k < group.size(); ++k) {
    const int i = sliding_[group[k]];
    for (const int j : kernel_.neighbours(i)) {
      if (groups_.row_of[at(j)] >= 0) place(at(groups_.row_of[at(j)]));
    }
    for (std::size_t other = 0; !kernel_.region_groups().empty() && other < sliding_.size(); ++other) {
      if (same_group(kernel_, i, sliding_[other])) place(other);
    }
  }
  std::sort(group.begin(), group.end());
  return group;
}

/// Whether a row is in a group with several regions of one group by `indicator`: their weights follow from linear
/// equations, and their exits are the zeros of these.
bool ModeField::several_regions(std::size_t row) const {
  if (ties_.regions.empty() || groups_.size[row] == 1) return false;
  const auto group = std::find_if(groups_.lists.begin(), groups_.lists.end(),
                                  [&](const auto& rows) { return std::binary_search(rows.begin(), rows.end(), row); });
  return std::any_of(ties_.regions.begin(), ties_.regions.end(), [&](const SlidingRegions& regions) {
    return regions.rows.size() > 1 && std::binary_search(group->begin(), group->end(), regions.rows.front());
  });
}

void ModeField::find_regions(const ModeState& state) {
  ties_.regions.clear();
  rows_.independent.rows.clear();
  for (const auto& group : kernel_.region_groups()) {
    SlidingRegions regions;
    regions.reference = reference_of(state, group);
    for (std::size_t row = 0; row < sliding_.size(); ++row) {
      if (group.holds(sliding_[row])) regions.rows.push_back(row);
    }
    if (!regions.rows.empty()) ties_.regions.push_back(std::move(regions));
  }
  ties_.known =
      std::none_of(ties_.regions.begin(), ties_.regions.end(), [](const auto& r) { return r.rows.size() > 1; });
}

/// Behind gradients(): which rows of regions depend on others, once in a mode, and how they do.
void ModeField::find_ties() {
  if (ties_.known && rows_.independent.rows.empty()) return;
  for (auto& regions : ties_.regions) {
    if (regions.rows.size() < 2 || (ties_.known && (!regions.tie || regions.constant))) continue;
    take_rows(rows_.dense, regions.rows, ties_.rows);
    if (ties_.known && ties_.rows == regions.gradients) continue;
    regions.gradients = ties_.rows;
    if (ties_.known) {
      regions.tie->polytope().move(coordinates_in(regions.basis, ties_.rows));
      continue;
    }
    regions.basis = basis_of(ties_.rows);
    if (regions.basis.spans_all(ties_.rows.rows())) continue;
    auto polytope = switching::RegionPolytope::make(coordinates_in(regions.basis, ties_.rows));
    // Two exits for each row are what there is for the facets.
    if (!polytope || polytope->facets().size() > 2 * regions.rows.size()) continue;
    regions.tie.emplace(std::move(*polytope));
    regions.constant =
        std::all_of(regions.rows.begin(), regions.rows.end(), [&](auto r) { return rows_.is_constant[r]; });
  }
  if (!ties_.known) find_independent_rows();
  ties_.known = true;
}

void ModeField::find_independent_rows() {
  const auto is_dependent = [&](std::size_t row) {
    const auto* regions = tie_of(row);
    if (regions == nullptr) return false;
    const auto& base = regions->basis.base;
    return std::none_of(base.begin(), base.end(), [&](auto k) { return regions->rows[at(k)] == row; });
  };
  for (std::size_t row = 0; row < sliding_.size(); ++row) {
    if (!is_dependent(row)) rows_.independent.rows.push_back(static_cast<linalg::Index>(row));
  }
  if (rows_.independent.rows.size() == sliding_.size()) rows_.independent.rows.clear();
}

std::vector<int> ModeField::independent() const {
  if (rows_.independent.rows.empty()) return sliding_;
  std::vector<int> surfaces;
  for (const auto row : rows_.independent.rows) surfaces.push_back(sliding_[at(row)]);
  return surfaces;
}

/// The regions of a row, if they depend on each other.
const SlidingRegions* ModeField::tie_of(std::size_t row) const {
  for (const auto& regions : ties_.regions) {
    if (regions.tie && std::binary_search(regions.rows.begin(), regions.rows.end(), row)) return &regions;
  }
  return nullptr;
}

/// The reference of a group has the weight that the others leave; where there are several others, that weight ends the
/// mode at 0, and none of theirs at 1.
void ModeField::weigh_references() {
  for (const auto& regions : ties_.regions) {
    const auto& rows = regions.rows;
    double weight = 1.0;
    for (const std::size_t row : rows) weight -= alpha_[at(sliding_[row])];
    alpha_[at(regions.reference)] = weight;
    if (rows.size() == 1 || regions.tie) continue;
    for (const std::size_t row : rows) exits_[row].above = row == rows.front() ? -weight : -1.0;
  }
}

bool ModeField::has_loss(std::size_t row) const {
  if (const auto* regions = tie_of(row)) return regions->rows.front() == row;
  if (several_regions(row)) return on_other_surface(row);
  return solve_ == SlidingSolve::nonaffine || (solve_ == SlidingSolve::coupled && groups_.size[row] > 1);
}

/// Of the first row of a group with several regions: whether a surface is in it. The equations are not linear then.
bool ModeField::on_other_surface(std::size_t row) const {
  return groups_.size[row] > 1 && std::any_of(groups_.lists.begin(), groups_.lists.end(), [&](const auto& group) {
           return group.front() == row && std::any_of(group.begin(), group.end(), [&](std::size_t other) {
                    return std::none_of(ties_.regions.begin(), ties_.regions.end(), [&](const auto& regions) {
                      return std::binary_search(regions.rows.begin(), regions.rows.end(), other);
                    });
                  });
         });
}

bool ModeField::has_stability(std::size_t row) const {
  if (const auto* regions = tie_of(row)) return regions->rows.front() == row;
  return solve_ == SlidingSolve::coupled && groups_.size[row] > 1 && !several_regions(row);
}

/// Surfaces that no other sliding one influences: all at once.
void ModeField::evaluate_alone(double t, const double* x) {
  if (groups_.alone.empty()) return;
  kernel_.prepared_field(t, x, constants_[1], f_[1].data());
  for (const std::size_t row : groups_.alone) {
    exits_[row].above = rows_.velocity(row, f_[1]);
    alpha_[at(sliding_[row])] = switching::sliding_alpha(exits_[row].below, exits_[row].above);
  }
}

void ModeField::evaluate_groups(double t, const double* x) {
  kernel_.prepared_field(t, x, constants_[0], f_[0].data());
  for (std::size_t row = 0; row < sliding_.size(); ++row) exits_[row] = {rows_.velocity(row, f_[0]), 0.0, 0.0, 0.0};
  evaluate_alone(t, x);
  if (!groups_.lists.empty()) trial_ = corner_[0];
  groups_.pairs.clear();
  for (const auto& rows : groups_.lists) {
    const auto tie = std::find_if(ties_.regions.begin(), ties_.regions.end(), [&](const auto& regions) {
      return regions.tie && regions.rows.front() == rows.front();
    });
    if (tie != ties_.regions.end()) {
      evaluate_tie(t, x, *tie);
    } else if (rows.size() == 2 && !several_regions(rows.front())) {
      groups_.pairs.push_back({rows[0], rows[1]});
    } else if (!is_in_large(rows[0])) {
      evaluate_many(t, x, rows, *groups_.newton[rows[0]]);
    }
  }
  evaluate_pairs(t, x);
  if (groups_.large) evaluate_many(t, x, groups_.large->rows, *groups_.large->newton);
  if (!groups_.moved.empty() && constants_[0].motion == kernel_.motion()) {
    for (const auto& [state, row] : groups_.moved)
      f_[0][state] += alpha_[at(sliding_[row])] * (f_[1][state] - f_[0][state]);
    return;
  }
  weigh_references();
  kernel_.field(t, x, alpha_.data(), f_[0].data());
}

/// Corners of all pairs at once: none feels the selections of another one. Behind evaluate_groups()'s first corner.
void ModeField::evaluate_pairs(double t, const double* x) {
  const auto& pairs = groups_.pairs;
  if (pairs.empty()) return;
  groups_.corners.resize(pairs.size());
  for (std::size_t corner = 0; corner < 4; ++corner) {
    for (const auto& rows : pairs) {
      for (std::size_t k = 0; k < 2; ++k) trial_[at(sliding_[rows[k]])] = (corner >> k & 1U) != 0 ? 1.0 : 0.0;
    }
    if (corner > 0) kernel_.field(t, x, trial_.data(), f_[1].data());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t row = pairs[i][k];
        groups_.corners[i][corner][k] = corner > 0 ? rows_.velocity(row, f_[1]) : exits_[row].below;
      }
    }
  }
  for (const auto& rows : pairs) {
    for (const std::size_t row : rows) trial_[at(sliding_[row])] = 0.0;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) solve_pair(pairs[i], groups_.corners[i]);
}

/// Two surfaces: the root with det G > 0 in closed form; its exits are the zeros of that form, which are exact.
void ModeField::solve_pair(const std::array<std::size_t, 2>& rows, const switching::PairCorners& g) {
  auto& kind = groups_.kind[rows[0]];
  if (!kind) kind = kind_of_mode(g, start_alpha_[at(sliding_[rows[0]])], start_alpha_[at(sliding_[rows[1]])]);
  const auto root = switching::bilinear_root(g, *kind);
  const auto selections = switching::balanced_selections(g, root);
  for (std::size_t k = 0; k < 2; ++k) {
    alpha_[at(sliding_[rows[k]])] = selections[k];
    exits_[rows[k]] = {root.alpha[k], root.from_one[k], 0.0, 0.0};
    groups_.condition[rows[k]] = root.condition[k];
  }
  exits_[rows[0]].loss = root.discriminant;
  exits_[rows[0]].stability = root.stability;
}

/// Regions that depend on each other: their weights from those of the mode. Behind evaluate_groups()'s first corner.
void ModeField::evaluate_tie(double t, const double* x, SlidingRegions& regions) {
  const auto& rows = regions.rows;
  const auto& base = regions.basis.base;
  const auto velocities = [&](const std::vector<double>& f, linalg::Index column) {
    for (std::size_t k = 0; k < base.size(); ++k) {
      ties_.rates(static_cast<linalg::Index>(k), column) = rows_.velocity(rows[at(base[k])], f);
    }
  };
  ties_.rates.resize(static_cast<linalg::Index>(base.size()), static_cast<linalg::Index>(rows.size()) + 1);
  ties_.theta.assign(1, start_alpha_[at(regions.reference)]);
  velocities(f_[0], 0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto j = at(sliding_[rows[k]]);
    trial_[j] = 1.0;
    kernel_.field(t, x, trial_.data(), f_[1].data());
    trial_[j] = 0.0;
    velocities(f_[1], static_cast<linalg::Index>(k) + 1);
    ties_.theta.push_back(start_alpha_[j]);
  }
  const bool found = regions.tie->solve(ties_.rates, ties_.theta.data());
  const auto facets = regions.tie->polytope().facets().size();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    alpha_[at(sliding_[rows[k]])] = found ? ties_.theta[k + 1] : not_a_number;
    const auto excess = [&](std::size_t facet) { return facet < facets ? regions.tie->excess(facet) : 1.0; };
    exits_[rows[k]] = {found ? excess(2 * k) : not_a_number, found ? -excess(2 * k + 1) : not_a_number, 0.0, 0.0};
    // Weights are as good as the equations are regular.
    constexpr double singular = 1e-6;
    groups_.condition[rows[k]] = 1.0 / std::max(std::abs(regions.tie->determinant()), singular);
  }
  exits_[rows[0]].loss = regions.tie->determinant();
}

/// Largest normal components over all corners where the mode begins: the default speeds of its hidden dynamics.
void ModeField::find_speeds(switching::ProjectedField velocities, const std::vector<std::size_t>& rows) {
  std::vector<double> alpha(rows.size());
  std::vector<double> g(rows.size());
  for (const std::size_t row : rows) groups_.speed[row] = 0.0;
  for (std::size_t corner = 0; corner < std::size_t{1} << rows.size(); ++corner) {
    for (std::size_t k = 0; k < rows.size(); ++k) alpha[k] = (corner >> k & 1U) != 0 ? 1.0 : 0.0;
    velocities(alpha.data(), g.data());
    for (std::size_t k = 0; k < rows.size(); ++k)
      groups_.speed[rows[k]] = std::max(groups_.speed[rows[k]], std::abs(g[k]));
  }
}

/// More than two surfaces: Newton from the selections of the mode, of large groups from all of them together.
template <class Newton>
void ModeField::evaluate_many(double t, const double* x, const std::vector<std::size_t>& rows, Newton& newton) {
  for (std::size_t k = 0; k < rows.size(); ++k) groups_.selections[k] = start_alpha_[at(sliding_[rows[k]])];
  const auto velocities = [&](const double* alpha, double* g) {
    for (std::size_t k = 0; k < rows.size(); ++k) trial_[at(sliding_[rows[k]])] = alpha[k];
    kernel_.field(t, x, trial_.data(), f_[1].data());
    for (std::size_t k = 0; k < rows.size(); ++k) g[k] = rows_.velocity(rows[k], f_[1]);
  };
  if (!is_in_large(rows[0]) && std::isnan(groups_.speed[rows[0]])) find_speeds(velocities, rows);
  const bool found = newton.solve(velocities, groups_.selections.data());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto j = at(sliding_[rows[k]]);
    alpha_[j] = found ? groups_.selections[k] : not_a_number;
    exits_[rows[k]] = {alpha_[j], alpha_[j] - 1.0, 0.0, 0.0};
    trial_[j] = 0.0;
  }
}

/// Behind evaluate_groups(): what only the event functions need of groups of more than two.
void ModeField::find_stability() {
  for (std::size_t k = 0; groups_.large && k < groups_.large->parts.size(); ++k) {
    const auto& part = groups_.large->parts[k];
    if (part.size() < 2) continue;
    auto& exit = exits_[groups_.large->rows[at(part.front())]];
    std::tie(exit.loss, exit.stability) = loss_and_stability(groups_.large->newton->jacobian(), part);
  }
  for (const auto& rows : groups_.lists) {
    if (const auto* regions = tie_of(rows[0])) {
      auto& exit = exits_[regions->rows.front()];
      exit.stability = std::isfinite(exit.below) ? regions->tie->stability() : not_a_number;
      continue;
    }
    if (rows.size() <= 2 || !groups_.newton[rows[0]]) continue;
    const auto& newton = *groups_.newton[rows[0]];
    const auto jacobian = newton.jacobian();
    double size = 1.0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      double square = 0.0;
      for (const double entry : jacobian.subspan(r * rows.size(), rows.size())) square += entry * entry;
      size *= std::sqrt(square);
    }
    exits_[rows[0]].loss = newton.determinant() / size;
    // Some scaling makes the root stable: one that Fisher and Fuller know of, or that of the hidden dynamics where the
    // mode began, which may have settled there beyond their condition.
    groups_.scaled.assign(jacobian.begin(), jacobian.end());
    for (std::size_t k = 0; k < groups_.scaled.size(); ++k) groups_.scaled[k] /= groups_.speed[rows[k / rows.size()]];
    exits_[rows[0]].stability =
        std::max(newton.margin(), switching::hurwitz_margin(groups_.scaled, static_cast<int>(rows.size())));
  }
}

double ModeField::root_distance(double t, const double* x) {
  if (solve_ != SlidingSolve::coupled) return 1.0;
  select(t, x);
  find_stability();
  double smallest = 1.0;
  for (std::size_t row = 0; row < sliding_.size() && groups_.large; ++row) {
    if (is_in_large(row) && groups_.size[row] > 1) smallest = std::min(smallest, std::abs(exits_[row].loss));
  }
  for (const auto& rows : groups_.lists) {
    if (rows.size() < 2 || (rows.size() > 2 && !groups_.newton[rows[0]]) || !has_loss(rows[0]) ||
        tie_of(rows[0]) != nullptr)
      continue;
    const double loss = exits_[rows[0]].loss;
    smallest = std::min(smallest, rows.size() == 2 ? std::sqrt(std::max(0.0, loss)) : std::abs(loss));
  }
  return smallest;
}

void ModeField::follow(double t, const double* x) {
  const auto is_large = [&](const auto& rows) { return rows.size() > 2 || tie_of(rows.front()) != nullptr; };
  if (solve_ != SlidingSolve::coupled || std::none_of(groups_.lists.begin(), groups_.lists.end(), is_large)) return;
  select(t, x);
  if (!is_finite(alpha_)) return;
  start_alpha_ = alpha_;
  prepare_corners();
}

}  // namespace saltus::event_integrator
