#include "saltus/solver/certificate/classify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/mpcc/residuals.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/sparse.hpp"

namespace saltus::solver::certificate {
namespace {

using result::StationarityType;

struct Violation {
  enum Kind { bound, row, pair };
  Kind kind;
  double amount;
  std::string name;
  bool is_worst_of_kind = false;
};

/// Calls back with every bound that is violated: the amount relative to the bound, and which variable or row it is.
template <class OnViolation>
void for_violations(ConstVectorView values, const mpcc::Bounds& bounds, OnViolation&& on_violation) {
  for (linalg::Index i = 0; i < values.size(); ++i) {
    const double below = (bounds.lower[i] - values[i]) / std::max(1.0, std::abs(bounds.lower[i]));
    const double above = (values[i] - bounds.upper[i]) / std::max(1.0, std::abs(bounds.upper[i]));
    // An infinite bound gives NaN or -inf: never violated.
    if (below > 0.0 && std::isfinite(bounds.lower[i])) on_violation(below, static_cast<int>(i));
    if (above > 0.0 && std::isfinite(bounds.upper[i])) on_violation(above, static_cast<int>(i));
  }
}

/// Says of each row of (G, H) whether a closure holds all variables of that side, which is implied.
std::vector<bool> held_sides(mpcc::Problem& problem, ConstVectorView w, const std::vector<mpcc::ActiveSide>& sides) {
  const mpcc::BranchClosure closure = problem.close_branch(sides);
  std::vector<bool> is_held(at(problem.variables()), false);
  for (const int i : closure.at_lower) is_held[at(i)] = true;
  for (const int i : closure.at_upper) is_held[at(i)] = true;
  const RowMatrix jacobian = jacobian_matrix(problem, w);
  std::vector<bool> held(problem.signs().size(), false);
  for (std::size_t side = 0; side < held.size(); ++side) {
    held[side] = problem.signs()[side] == mpcc::Sign::implied;
    for (const linalg::Entry entry : jacobian.along(problem.constraints() + index(side))) {
      if (entry.value != 0.0 && !is_held[at(entry.inner)]) held[side] = false;
    }
  }
  return held;
}

}  // namespace

PairStates pair_states(mpcc::Problem& problem, ConstVectorView w, const std::vector<mpcc::ActiveSide>& sides,
                       double tolerance) {
  PairStates states{.sides = sides, .biactive = {}, .is_open = {}};
  for (const auto side : mpcc::active_sides(problem, w, 10.0 * tolerance)) {
    states.biactive.push_back(side == mpcc::ActiveSide::biactive);
  }
  states.is_open.assign(states.biactive.size(), false);
  const std::vector<bool> held = held_sides(problem, w, sides);
  const auto is_held = [&](int pair) { return held[at(pair)] || held[at(problem.pairs() + pair)]; };
  for (const auto& group : crossover::groups_of(problem)) {
    const bool is_open = std::all_of(group.begin(), group.end(), [&](int pair) { return states.biactive[at(pair)]; }) &&
                         !std::all_of(group.begin(), group.end(), is_held);
    for (const int pair : group) states.is_open[at(pair)] = is_open;
  }
  return states;
}

StationarityType stationarity_type(const MpccMultipliers& multipliers, const std::vector<bool>& biactive,
                                   double tolerance) {
  double largest = 1.0;
  for (std::size_t pair = 0; pair < biactive.size(); ++pair) {
    if (!biactive[pair]) continue;
    largest = std::max({largest, std::abs(multipliers.G[index(pair)]), std::abs(multipliers.H[index(pair)])});
  }
  const double zero = 10.0 * tolerance * largest;
  bool S = true;
  bool M = true;
  bool C = true;
  bool A = true;
  for (std::size_t pair = 0; pair < biactive.size(); ++pair) {
    if (!biactive[pair]) continue;
    const double G = multipliers.G[index(pair)];
    const double H = multipliers.H[index(pair)];
    const bool has_zero = std::abs(G) <= zero || std::abs(H) <= zero;
    const bool are_positive = G >= -zero && H >= -zero;
    S = S && are_positive;
    M = M && (are_positive || has_zero);
    C = C && (has_zero || (G > 0.0) == (H > 0.0));
    A = A && (G >= -zero || H >= -zero);
  }
  if (S) return StationarityType::S;
  if (M) return StationarityType::M;
  if (C) return StationarityType::C;
  return A ? StationarityType::A : StationarityType::W;
}

double scaled_infeasibility(mpcc::Problem& problem, ConstVectorView w) {
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  if (!c.all_finite() || !w.all_finite()) return std::numeric_limits<double>::quiet_NaN();
  double largest = 0.0;
  const auto raise = [&largest](double amount, int) { largest = std::max(largest, amount); };
  for_violations(w, problem.variable_bounds(), raise);
  for_violations(c.head(problem.constraints()), problem.constraint_bounds(), raise);
  return std::max(largest, -c.tail(2 * problem.pairs()).min());
}

double complementarity(mpcc::Problem& problem, ConstVectorView w) {
  return mpcc::residuals(problem, w).complementarity_residual;
}

std::string worst_rows(mpcc::Problem& problem, ConstVectorView w, double tolerance) {
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  std::vector<Violation> violations;
  for_violations(w, problem.variable_bounds(), [&](double amount, int i) {
    if (amount > tolerance)
      violations.push_back({Violation::bound, amount, fmt::format("a bound of {}", problem.name(i))});
  });
  for_violations(c.head(n_g), problem.constraint_bounds(), [&](double amount, int i) {
    if (amount > tolerance) violations.push_back({Violation::row, amount, problem.row_name(i)});
  });
  for (int side = 0; side < 2 * pairs; ++side) {
    if (-c[n_g + side] > tolerance)
      violations.push_back({Violation::pair, -c[n_g + side], problem.row_name(n_g + side)});
  }
  for (int pair = 0; pair < pairs; ++pair) {
    const double residual = std::min(std::abs(c[n_g + pair]), std::abs(c[n_g + pairs + pair]));
    if (!(residual > tolerance)) continue;
    const std::string G = problem.row_name(n_g + pair), H = problem.row_name(n_g + pairs + pair);
    violations.push_back(
        {Violation::pair, residual, G == H ? "complementarity of " + G : fmt::format("{} _|_ {}", G, H)});
  }
  std::stable_sort(violations.begin(), violations.end(),
                   [](const auto& a, const auto& b) { return a.amount > b.amount; });
  // Amounts of different kinds cannot be compared: what no selection can meet is a row, however far the pairs are off.
  std::array<bool, 3> seen{};
  for (auto& one : violations) one.is_worst_of_kind = !std::exchange(seen[one.kind], true);
  std::stable_partition(violations.begin(), violations.end(), [](const auto& one) { return one.is_worst_of_kind; });
  // Rows of a discretisation may share a name.
  std::set<std::string_view> named;
  std::string text;
  for (const auto& one : violations) {
    if (named.size() == 3 || !named.insert(one.name).second) continue;
    text += fmt::format("{}{} (by {:.3g})", text.empty() ? "" : ", ", one.name, one.amount);
  }
  return text;
}

}  // namespace saltus::solver::certificate
