#include "saltus/reformulation/well_posedness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/linalg/sparse.hpp"
#include "saltus/linalg/spectra.hpp"
#include "saltus/model/system.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "saltus/reformulation/expressions_internal.hpp"

namespace saltus::reformulation {
namespace {

using casadi::DM;

/// The entries are cosines; states on a surface are known to about 1e-10.
constexpr double rank_tolerance = 1e-8;
/// A surface is met by a solution that slides where its psi is 0 to the accuracy of the states.
constexpr double zero_tolerance = 1e-6;

using Sparse = linalg::SparseColumns;

/// Cost: grows with the entries that are not structurally 0.
Sparse matrix(const DM& values) {
  std::vector<linalg::Triplet> entries;
  for (casadi_int j = 0; j < values.size2(); ++j) {
    for (casadi_int k = values.colind()[j]; k < values.colind()[j + 1]; ++k) {
      entries.push_back({values.row()[k], j, values.ptr()[k]});
    }
  }
  return {values.size1(), values.size2(), entries};
}

double norm_of_column(const Sparse& matrix, linalg::Index column) {
  const auto first = at(matrix.start()[at(column)]), last = at(matrix.start()[at(column) + 1]);
  return linalg::ConstView(matrix.values().subspan(first, last - first)).norm();
}

/// f with the lifted variables put in.
SX unlifted(const Dcs& dcs) {
  Replacement replacement;
  const auto beta = entries(dcs.lifted), equations = entries(dcs.lifting);
  for (std::size_t k = 0; k < beta.size(); ++k) {
    Replacement own = replacement;
    own.set(beta[k], 0.0);
    replacement.set(beta[k], -own.of(equations[k]));
  }
  return replacement.of(dcs.f);
}

}  // namespace

namespace {

/// Of each surface: alpha, and whether it is 0 and the solution slides on it.
struct SurfaceStates {
  std::vector<double> alpha;
  std::vector<bool> slides;
};

}  // namespace

struct WellPosedness::Parts {
  Dcs dcs;
  std::vector<double> parameters;
  std::vector<std::shared_ptr<const model::CellTable>> tables;  // shared: they belong to the System
  std::vector<int> first_regions;                               ///< of each group of modes
  casadi::Function held_arguments, surfaces, gradients;

  [[nodiscard]] std::vector<double> held_at(const SolutionPoint& point) const;
  [[nodiscard]] SurfaceStates sides_at(const SolutionPoint& point, const std::vector<double>& held) const;
  [[nodiscard]] std::vector<int> undetermined(const DcsPart& part, const SolutionPoint& point,
                                              const SurfaceStates& sides, std::vector<double>& selection) const;
};

WellPosedness::WellPosedness(const Dcs& dcs, const model::System& system)
    : parts_(new Parts{dcs, system.parameter_values, {}, {}, {}, {}, {}}) {
  for (const auto& cell : system.cells) parts_->tables.push_back(cell.table);
  for (const auto& group : system.mode_groups) parts_->first_regions.push_back(group.first);
  std::vector<SXElem> arguments, psi;
  for (const auto& held : dcs.held_symbols) arguments.push_back(entry(held.argument));
  for (const auto& surface : dcs.surfaces) psi.push_back(entry(surface.psi));
  const std::vector<SX> place{dcs.t, dcs.x, dcs.u, dcs.p, dcs.held};
  const SX values = column(psi);
  parts_->held_arguments = casadi::Function("held_arguments", place, {column(arguments)});
  parts_->surfaces = casadi::Function("surfaces", place, {values, SX::jacobian(values, dcs.x)});
  auto with_selection = place;
  with_selection.push_back(dcs.selection);
  parts_->gradients = casadi::Function(
      "gradients", with_selection, {SX::jacobian(dcs.indicator, dcs.x), SX::jacobian(unlifted(dcs), dcs.selection)});
}

WellPosedness::WellPosedness(WellPosedness&&) noexcept = default;
WellPosedness::~WellPosedness() = default;

std::vector<double> WellPosedness::Parts::held_at(const SolutionPoint& point) const {
  std::vector<double> held(dcs.held_symbols.size(), 0.0);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const std::vector<DM> place{point.t, point.x, point.u, parameters, held};
    const double argument = std::vector<double>(DM::densify(held_arguments(place).front()))[k];
    const HeldSymbol& symbol = dcs.held_symbols[k];
    if (symbol.kind == HeldSymbol::Kind::selection) {
      held[k] = argument > 0.0 ? 1.0 : argument < 0.0 ? 0.0 : symbol.at_zero;
    } else {
      const auto& table = *tables[at(symbol.index)];
      held[k] = table.constant(table.cell(argument), symbol.column);
    }
  }
  return held;
}

SurfaceStates WellPosedness::Parts::sides_at(const SolutionPoint& point, const std::vector<double>& held) const {
  const auto values = surfaces(std::vector<DM>{point.t, point.x, point.u, parameters, held});
  const auto psi = std::vector<double>(DM::densify(values[0]));
  const Sparse transposed = matrix(values[1]).transposed();
  const double size = linalg::ConstView(point.x).norm();
  SurfaceStates sides;
  for (std::size_t j = 0; j < psi.size(); ++j) {
    const Surface& surface = dcs.surfaces[j];
    const double steepness = norm_of_column(transposed, index(j));
    const bool is_zero = std::abs(psi[j]) <= zero_tolerance * steepness * (1.0 + size);
    const bool slides = surface.function >= 0 && point.mode[at(surface.function)] == 0 && is_zero;
    sides.alpha.push_back(slides ? point.alpha[at(surface.function)] : psi[j] > 0.0 ? 1.0 : 0.0);
    sides.slides.push_back(slides);
  }
  return sides;
}

namespace {

/// What is unknown on an active set.
struct Unknowns {
  std::vector<int> selections;  ///< alpha of sliding surfaces, theta of active regions
  std::vector<int> simplex_of;  ///< of each: number of its simplex, -1 for alpha
  int simplexes = 0;
};

/// 1 / length of each column, by the longest of its block; 1 where all of a block is 0.
linalg::Vector scales(const Sparse& columns, const std::vector<linalg::Index>& block_of, linalg::Index blocks) {
  linalg::Vector longest = linalg::Vector::zero(blocks), scale = linalg::Vector::ones(columns.cols());
  for (linalg::Index i = 0; i < columns.cols(); ++i) {
    longest(block_of[at(i)]) = std::max(longest(block_of[at(i)]), norm_of_column(columns, i));
  }
  for (linalg::Index i = 0; i < columns.cols(); ++i) {
    if (longest(block_of[at(i)]) > 0.0) scale(i) = 1.0 / longest(block_of[at(i)]);
  }
  return scale;
}

/// Gradients and fields divided by their lengths (those of a simplex by the longest), so that the entries are cosines;
/// what is 0 stays 0.
Sparse system_of(const Unknowns& unknowns, const Sparse& indicator_x, const Sparse& f_selection) {
  const auto n = static_cast<linalg::Index>(unknowns.selections.size());
  const linalg::Index size = n + unknowns.simplexes;
  std::vector<linalg::Index> block_of;
  std::vector<linalg::Triplet> entries, chosen_entries;
  for (linalg::Index i = 0; i < n; ++i) {
    const int simplex = unknowns.simplex_of[at(i)];
    block_of.push_back(simplex < 0 ? i : n + simplex);
    chosen_entries.push_back({unknowns.selections[at(i)], i, 1.0});
    if (simplex < 0) continue;
    entries.push_back({i, n + simplex, 1.0});
    entries.push_back({n + simplex, i, 1.0});
  }
  const Sparse chosen(f_selection.cols(), n, chosen_entries);
  const Sparse gradients = indicator_x.transposed() * chosen, fields = f_selection * chosen;
  const linalg::Vector rows = scales(gradients, block_of, size), columns = scales(fields, block_of, size);
  const Sparse product = gradients.transposed() * fields;
  for (linalg::Index j = 0; j < n; ++j) {
    for (const auto [row, value] : product.along(j)) {
      entries.push_back({row, j, value * rows(row) * columns(j)});
    }
  }
  return {size, size, entries};
}

/// The singular values of a square matrix, by its blocks: a block has the unknowns that some equation joins.
std::vector<double> singular_values(const Sparse& system) {
  Components components(static_cast<std::size_t>(system.cols()));
  for (linalg::Index j = 0; j < system.cols(); ++j) {
    for (const auto [row, value] : system.along(j)) {
      if (value != 0.0) components.join(at(row), at(j));
    }
  }
  const auto blocks = components.lists();
  std::vector<linalg::Index> place(static_cast<std::size_t>(system.cols()));
  for (const auto& block : blocks) {
    for (std::size_t k = 0; k < block.size(); ++k) place[block[k]] = static_cast<linalg::Index>(k);
  }
  std::vector<double> found;
  for (const auto& block : blocks) {
    const auto n = static_cast<linalg::Index>(block.size());
    linalg::Matrix dense = linalg::Matrix::zero(n, n);
    for (const std::size_t j : block) {
      for (const auto [row, value] : system.along(index(j))) {
        if (value != 0.0) dense(place[at(row)], place[j]) = value;
      }
    }
    const linalg::Vector values = linalg::singular_values(dense).values;
    found.insert(found.end(), values.begin(), values.end());
  }
  return found;
}

}  // namespace

/// The selections of a part that are not determined by the signs of psi, and the values of all.
std::vector<int> WellPosedness::Parts::undetermined(const DcsPart& part, const SolutionPoint& point,
                                                    const SurfaceStates& sides, std::vector<double>& selection) const {
  std::vector<int> active;
  for (int i = 0; i < part.count; ++i) {
    bool is_active = true;
    double& value = selection[at(part.first + i)];
    if (part.form == Form::step) {
      value = sides.alpha[at(part.surfaces[at(i)])];
      is_active = sides.slides[at(part.surfaces[at(i)])];
    } else if (part.mode_group >= 0) {
      const int region = first_regions[at(part.mode_group)] + i;
      value = point.alpha[at(region)];
      is_active = point.mode[at(region)] == 0;
    } else {
      value = 1.0;
      for (std::size_t j = 0; j < part.surfaces.size(); ++j) {
        const int surface = part.surfaces[j];
        const double alpha = sides.alpha[at(surface)];
        const double factor = part.signs(i, static_cast<linalg::Index>(j)) > 0 ? alpha : 1.0 - alpha;
        value *= factor;
        is_active = is_active && (sides.slides[at(surface)] || factor == 1.0);
      }
    }
    if (is_active) active.push_back(part.first + i);
  }
  // One active region of a simplex has theta = 1.
  if (part.form == Form::stewart && active.size() < 2) active.clear();
  return active;
}

ActiveSetRank WellPosedness::rank_at(const SolutionPoint& point) const {
  const Parts& p = *parts_;
  const auto held = p.held_at(point);
  const SurfaceStates sides = p.sides_at(point, held);
  ActiveSetRank result;
  for (std::size_t j = 0; j < sides.slides.size(); ++j) {
    if (sides.slides[j]) result.surfaces.push_back(static_cast<int>(j));
  }
  std::vector<double> selection(static_cast<std::size_t>(p.dcs.selection.numel()), 0.0);
  Unknowns unknowns;
  for (const DcsPart& part : p.dcs.parts) {
    const auto active = p.undetermined(part, point, sides, selection);
    const bool simplex = part.form == Form::stewart && !active.empty();
    if (simplex) result.regions += static_cast<int>(active.size());
    unknowns.selections.insert(unknowns.selections.end(), active.begin(), active.end());
    unknowns.simplex_of.resize(unknowns.selections.size(), simplex ? unknowns.simplexes : -1);
    unknowns.simplexes += simplex ? 1 : 0;
  }
  result.unknowns = static_cast<int>(unknowns.selections.size()) + unknowns.simplexes;
  result.smallest_singular_value = std::numeric_limits<double>::infinity();
  if (result.unknowns == 0) return result;
  const auto gradients = p.gradients(std::vector<DM>{point.t, point.x, point.u, p.parameters, held, selection});
  const Sparse system = system_of(unknowns, matrix(gradients[0]), matrix(gradients[1]));
  if (!system.all_finite()) {
    result.smallest_singular_value = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  for (const double value : singular_values(system)) {
    result.smallest_singular_value = std::min(result.smallest_singular_value, value);
    result.rank += value > rank_tolerance ? 1 : 0;
  }
  return result;
}

}  // namespace saltus::reformulation
