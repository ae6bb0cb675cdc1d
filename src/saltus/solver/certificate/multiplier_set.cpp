#include "saltus/solver/certificate/multiplier_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"

namespace saltus::solver::certificate {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();
/// Of one linear program; as few dimensions as gradients depend on each other.
constexpr double linear_seconds = 10.0;
/// A width that is rounding, relative to the value.
constexpr double small_width = 1e-7;

/// V without what rounding leaves, for gradients of their own length.
linalg::SparseRows vectors_of(const ActiveGradients& gradients) {
  if (are_independent(gradients)) return {std::ssize(gradients.size), 0, {}};
  const auto null = linalg::null_space(gradients.matrix, dependence);
  std::vector<linalg::Triplet> entries;
  for (linalg::Index k = 0; k < null.vectors.cols(); ++k) {
    double largest = 0.0;
    for (const linalg::Entry entry : null.vectors.along(k)) largest = std::max(largest, std::abs(entry.value));
    for (const linalg::Entry entry : null.vectors.along(k)) {
      if (std::abs(entry.value) <= dependence * largest) continue;
      entries.push_back({entry.inner, k, entry.value / gradients.size[at(entry.inner)]});
    }
  }
  return {std::ssize(gradients.size), null.vectors.cols(), entries};
}

std::vector<double> dense(const linalg::SparseRows& matrix, int row, double factor = 1.0) {
  std::vector<double> values(at(matrix.cols()), 0.0);
  for (const linalg::Entry entry : matrix.along(row)) values[at(entry.inner)] = factor * entry.value;
  return values;
}

bool is_zero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
}

/// Rows lower <= change't <= upper of a linear program.
class ProgramRows {
 public:
  void add(const std::vector<double>& change, double lower, double upper) {
    for (std::size_t k = 0; k < change.size(); ++k) {
      if (change[k] == 0.0) continue;
      pattern_.add(static_cast<int>(lower_.size()), static_cast<int>(k));
      entries_.push_back(change[k]);
    }
    lower_.push_back(lower);
    upper_.push_back(upper);
  }
  /// Any t is as good.
  [[nodiscard]] LpccProblem program(linalg::Index dimensions) const {
    LpccProblem problem;
    problem.cost = linalg::Vector::zero(dimensions);
    problem.variables = {linalg::Vector::constant(dimensions, -no_limit),
                         linalg::Vector::constant(dimensions, no_limit)};
    problem.pattern = pattern_;
    problem.entries = linalg::ConstView(entries_);
    problem.rows = {linalg::ConstView(lower_), linalg::ConstView(upper_)};
    return problem;
  }

 private:
  decltype(LpccProblem::pattern) pattern_;
  std::vector<double> entries_, lower_, upper_;
};

}  // namespace

bool MultiplierRange::is_unique() const {
  const bool is_limited = std::isfinite(lower) && std::isfinite(upper);
  return is_limited && upper - lower <= small_width * std::max({1.0, std::abs(lower), std::abs(upper)});
}

MultiplierSet::MultiplierSet(mpcc::Problem& problem, crossover::Branch& branch, ActiveConstraints active)
    : active_(std::move(active)) {
  const auto& reduction = branch.problem->reduction();
  jacobian_ = jacobian_matrix(problem, branch.problem->full(branch.point.w));
  vectors_ = vectors_of(gradients_of(active_, reduction, jacobian_));
  find_slopes(problem, branch, jacobian_);
  add_signs(reduction);
}

void MultiplierSet::find_slopes(mpcc::Problem& problem, const crossover::Branch& branch, const RowMatrix& jacobian) {
  const auto& reduction = branch.problem->reduction();
  const int n = problem.variables();
  linalg::Vector gradient(n);
  problem.objective_gradient(branch.problem->full(branch.point.w), gradient);
  slope_ = linalg::Vector::zero(n);
  for (int i = 0; i < n; ++i) {
    const int place = reduction.place[at(i)];
    leader_.push_back(place < 0 ? i : reduction.leader[at(place)]);
    slope_[leader_.back()] += gradient[i];
  }
  const auto is_free = [&](int i) {
    const int place = reduction.place[at(i)];
    return place >= 0 && active_.bounds[at(place)] == At::none;
  };
  std::vector<linalg::Triplet> entries;
  for (std::size_t j = 0; j < active_.rows.size(); ++j) {
    for (const linalg::Entry entry : jacobian.along(active_.rows[j].row)) {
      slope_[leader_[at(entry.inner)]] += active_.rows[j].multiplier * entry.value;
      if (is_free(entry.inner)) continue;
      for (const linalg::Entry part : vectors_.along(index(j))) {
        entries.push_back({leader_[at(entry.inner)], part.inner, entry.value * part.value});
      }
    }
  }
  // Terms that cancel leave rounding.
  std::vector<linalg::Triplet> sizes = entries;
  for (auto& entry : sizes) entry.value = std::abs(entry.value);
  const linalg::SparseRows sums(n, vectors_.cols(), entries), size(n, vectors_.cols(), sizes);
  std::vector<linalg::Triplet> kept;
  for (const auto& entry : sums.triplets()) {
    if (std::abs(entry.value) > dependence * size(entry.row, entry.column)) kept.push_back(entry);
  }
  slope_change_ = linalg::SparseRows(n, vectors_.cols(), kept);
}

void MultiplierSet::add_signs(const crossover::Reduction& reduction) {
  const auto add = [this](At at_bound, double value, const linalg::SparseRows& changes, int row, int owner) {
    if (at_bound != At::lower && at_bound != At::upper) return;
    const double sign = at_bound == At::upper ? 1.0 : -1.0;
    auto change = dense(changes, row, sign);
    if (is_zero(change)) return;
    signs_.push_back(std::move(change));
    // The point itself has the signs, but for rounding.
    least_.push_back(std::min(-sign * value, 0.0));
    owners_.push_back(owner);
  };
  for (std::size_t j = 0; j < active_.rows.size(); ++j) {
    add(active_.rows[j].at, active_.rows[j].multiplier, vectors_, static_cast<int>(j), active_.rows[j].row);
  }
  // A positive slope is that of a lower bound.
  const linalg::SparseRows& changes = slope_change_;
  for (std::size_t place = 0; place < active_.bounds.size(); ++place) {
    const int leader = reduction.leader[place];
    const At at_bound = active_.bounds[place];
    const At as_row = at_bound == At::lower ? At::upper : at_bound == At::upper ? At::lower : at_bound;
    add(as_row, slope_[leader], changes, leader, ~leader);
  }
}

std::vector<int> MultiplierSet::rows_that_depend() const {
  std::vector<int> rows;
  for (std::size_t j = 0; j < active_.rows.size(); ++j) {
    if (vectors_.along(index(j)).size() > 0) rows.push_back(active_.rows[j].row);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

MultiplierRange MultiplierSet::range(double value, const std::vector<double>& change, LpccSolver& linear) const {
  MultiplierRange found{value, value};
  if (is_zero(change)) return found;
  ProgramRows signs;
  for (std::size_t i = 0; i < signs_.size(); ++i) signs.add(signs_[i], least_[i], no_limit);
  LpccProblem problem = signs.program(std::ssize(change));
  const auto least = [&](double sign) {
    problem.cost = sign * linalg::ConstView(change);
    const LpccSolution solution = linear.solve(problem, linear_seconds);
    return solution.termination == result::Termination::completed ? solution.objective : -no_limit;
  };
  found.lower = value + least(1.0);
  found.upper = value - least(-1.0);
  return found;
}

std::optional<SideMultiplier> MultiplierSet::of_side(mpcc::Problem& problem, int row) const {
  const auto side = at(row - problem.constraints());
  if (problem.signs()[side] != mpcc::Sign::implied) {
    for (std::size_t j = 0; j < active_.rows.size(); ++j) {
      if (active_.rows[j].row != row) continue;
      return SideMultiplier{-active_.rows[j].multiplier, dense(vectors_, static_cast<int>(j), -1.0), row};
    }
    return std::nullopt;
  }
  std::optional<linalg::Entry> own;
  for (const linalg::Entry entry : jacobian_.along(row)) {
    if (entry.value == 0.0) continue;
    if (own) return std::nullopt;
    own = entry;
  }
  if (!own) return std::nullopt;
  const int leader = leader_[at(own->inner)];
  int sides_with_it = 0;
  for (int other = problem.constraints(); other < problem.rows(); ++other) {
    for (const linalg::Entry entry : jacobian_.along(other)) {
      sides_with_it += entry.value != 0.0 && leader_[at(entry.inner)] == leader ? 1 : 0;
    }
  }
  if (sides_with_it != 1) return std::nullopt;
  return SideMultiplier{slope_[leader] / own->value, dense(slope_change_, leader, 1.0 / own->value), ~leader};
}

bool MultiplierSet::can_have(const std::vector<MultiplierCondition>& conditions, const std::vector<int>& freed,
                             LpccSolver& linear) const {
  ProgramRows all;
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    if (!contains(freed, owners_[i])) all.add(signs_[i], least_[i], no_limit);
  }
  for (const auto& [multiplier, from, to] : conditions) {
    all.add(multiplier->change, from - multiplier->value, to - multiplier->value);
  }
  const LpccProblem problem = all.program(vectors_.cols());
  return linear.solve(problem, linear_seconds).termination == result::Termination::completed;
}

MultiplierRange MultiplierSet::of_row(int row, LpccSolver& linear) const {
  for (const ActiveRow& held : active_.held) {
    if (held.row != row) continue;
    return {held.at == At::upper ? 0.0 : -no_limit, held.at == At::lower ? 0.0 : no_limit};
  }
  for (std::size_t j = 0; j < active_.rows.size(); ++j) {
    if (active_.rows[j].row != row) continue;
    return range(active_.rows[j].multiplier, dense(vectors_, static_cast<int>(j)), linear);
  }
  return {};
}

MultiplierRange MultiplierSet::of_bounds(int variable, LpccSolver& linear) const {
  const int leader = leader_[at(variable)];
  return range(-slope_[leader], dense(slope_change_, leader, -1.0), linear);
}

}  // namespace saltus::solver::certificate
