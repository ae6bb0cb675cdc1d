#include "saltus/base/at.hpp"
#include "saltus/pipeline/mpcc/presolved_internal.hpp"
#include "saltus/solver/multipliers.hpp"
#include "saltus/solver/sparse.hpp"

namespace saltus::pipeline {

Presolved::Presolved(foreign::Problem& problem)
    : whole_(problem), found_(mpcc::presolve(problem, problem.row_ranges())) {
  if (found_.changes_rows() && found_.infeasible.empty()) smaller_.emplace(problem, found_);
}

mpcc::Problem& Presolved::problem() {
  if (smaller_) return *smaller_;
  return whole_;
}

result::PresolveCounts Presolved::counts() const {
  return {found_.fixed_variables, found_.empty_rows, found_.forced_pairs, found_.fixed_pairs, found_.infeasible};
}

solver::MpccMultipliers Presolved::multipliers_of_whole(const solver::Solution& solution) {
  const auto& of = solution.multipliers;
  if (!smaller_ || of.rows.size() != smaller_->constraints()) return of;
  const int n_g = whole_.constraints(), pairs = whole_.pairs();
  solver::MpccMultipliers whole{.rows = linalg::Vector::zero(n_g),
                                .lower = {},
                                .upper = {},
                                .G = linalg::Vector::zero(pairs),
                                .H = linalg::Vector::zero(pairs)};
  const auto side = [&](int row) -> double& {
    return row < n_g + pairs ? whole.G[row - n_g] : whole.H[row - n_g - pairs];
  };
  for (int i = 0; i < smaller_->constraints(); ++i) {
    const int row = smaller_->row_of_whole(i);
    if (row < n_g) {
      whole.rows[row] = of.rows[i];
    } else {
      side(row) = -of.rows[i];
    }
  }
  for (int pair = 0; pair < smaller_->pairs(); ++pair) {
    whole.G[found_.kept_pairs[at(pair)]] = of.G[pair];
    whole.H[found_.kept_pairs[at(pair)]] = of.H[pair];
  }
  const auto jacobian = solver::jacobian_matrix(whole_, solution.w);
  linalg::Vector pressure = of.lower - of.upper;
  for (const int row : found_.zero_sides) {
    if (whole_.signs()[at(row - n_g)] != mpcc::Sign::implied) continue;
    solver::take_from_bounds(jacobian, row, pressure, side(row));
  }
  whole.lower = pressure.at_least(0.0);
  whole.upper = (-pressure).at_least(0.0);
  return whole;
}

}  // namespace saltus::pipeline
