#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/solver/certificate/second_order.hpp"
#include "saltus/solver/certificate/strongest_type.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {
namespace {

using certificate::At;

constexpr std::size_t most_names = 5;
/// Active constraints that may depend on each other: which do of more of them takes longer than the solution.
constexpr std::size_t most_dependent = 1000;
/// A multiplier of so many tolerances, relative to the gradient of the objective, is zero: as where signs are judged.
constexpr double zero_multiplier = 10.0;

/// Whether no multiplier of an active inequality of the branch is zero.
bool is_strict(const certificate::ActiveConstraints& active, const NlpPoint& point, double zero) {
  const auto strong = active.strongly(point, zero);
  return strong.bounds == active.bounds && strong.rows.size() == active.rows.size();
}

/// Whether no multiplier of a side of a biactive pair is zero.
bool is_strict_at_pairs(mpcc::Problem& problem, const Run& run, double zero) {
  const auto states = certificate::pair_states(problem, run.branch->w, run.branch->sides, run.options.tolerance);
  const auto& of = run.solution.multipliers;
  for (int pair = 0; pair < problem.pairs(); ++pair) {
    if (!states.biactive[at(pair)] || problem.pair_group(pair) < 0) continue;
    if (std::abs(of.G[pair]) <= zero || std::abs(of.H[pair]) <= zero) return false;
  }
  return true;
}

/// Another multiplier of the same point may be zero nowhere.
std::optional<bool> known_if_unique(bool holds, bool is_unique) {
  return holds || is_unique ? std::optional(holds) : std::nullopt;
}

}  // namespace

void appraise(Run& run) {
  auto& of = run.solution.certificate;
  const double tolerance = run.options.tolerance;
  auto& branch = *run.branch;
  if (!branch.is_feasible(tolerance) || !(of.stationarity <= tolerance)) return;
  auto active = certificate::find_active(run.problem, branch, tolerance);
  if (active.rows.size() > most_dependent) {
    const auto jacobian = jacobian_matrix(run.problem, branch.problem->full(branch.point.w));
    if (!are_independent(certificate::gradients_of(active, branch.problem->reduction(), jacobian))) return;
  }
  const auto& set = run.solution.multiplier_set.emplace(run.problem, branch, std::move(active));
  of.licq = set.dependent_rows() == 0;
  of.dependent_rows = set.dependent_rows();
  for (const int row : set.rows_that_depend()) {
    if (of.dependent.size() < most_names) of.dependent.push_back(run.problem.row_name(row));
  }
  of.unique_multipliers = set.is_unique();
  if (set.dependent_rows() > 0 && of.stationarity_type && of.biactive > 0) {
    const auto states = certificate::pair_states(run.problem, branch.w, branch.sides, tolerance);
    of.stationarity_type = certificate::strongest_type(run.problem, set, states.biactive, *of.stationarity_type,
                                                       zero_multiplier * tolerance, run.lpcc);
  }
  linalg::Vector gradient(run.problem.variables());
  run.problem.objective_gradient(branch.w, gradient);
  const double zero = zero_multiplier * tolerance * std::max(1.0, gradient.max_abs());
  of.strict_complementarity = known_if_unique(is_strict(set.active(), branch.point, zero), set.is_unique());
  of.ulsc = known_if_unique(is_strict_at_pairs(run.problem, run, zero), set.is_unique());
  of.sosc = certificate::is_second_order_sufficient(run.problem, branch, set.active(), zero);
}

}  // namespace saltus::solver
